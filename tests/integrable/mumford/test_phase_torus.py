"""Far times of motions of genus 3 and more: points found in their ovals, in double-double numbers."""

from __future__ import annotations

from typing import Any

import gmpy2
import numpy as np
import pytest

from integrable.classical.ellipsoid import Ellipsoid
from integrable.classical.garnier import Garnier
from integrable.classical.henon_heiles import HenonHeiles
from integrable.classical.neumann import Neumann
from integrable.classical.toda import TodaLattice
from integrable.mumford.columns import Columns
from integrable.mumford.flow import MumfordFlow
from integrable.mumford.motion import BITS_OF_TORUS
from integrable.mumford.phase_torus import PhaseTorus, circles, in_pairs
from integrable.portrait import oval_loops
from integrable.portrait.oval_angles import room_for
from integrable.portrait.oval_pairs import OvalPairs
from jacobian import MP
from jacobian.errors import PrecisionLoss
from jacobian.inexact.long_field import LongField
from jacobian.numbers.compiler import interpreted
from jacobian.numbers.long_reals import BareReals
from tests.integrable.ways import confirmed, forced, has_torus, inside, made_torus

pytestmark = pytest.mark.skipif(interpreted(), reason="far states in floats are those of compiled loops")
MANY = 200


def neumann() -> MumfordFlow:
    """A motion on S³."""
    return flow_of(Neumann((1, 2, 3, 4)), True)


def flow_of(system: Any, on_sphere: bool = False, size: float = 1.0) -> MumfordFlow:
    """The motion of a random state."""
    rng = np.random.default_rng(system.size)
    q, p = (rng.uniform(-size, size, system.size) for _ in range(2))
    if on_sphere:
        q /= np.linalg.norm(q)
        p -= q * (q @ p)
    return system.flow(system.state(q, p))


def geodesic(n: int) -> MumfordFlow:
    """A geodesic on an ellipsoid of n axes."""
    system = Ellipsoid([k * k + 2 for k in range(n)])
    q = np.array([(k * k + 2) ** 0.5 for k in range(n)]) / n**0.5
    p = np.array([(-1) ** k * (k * k + 2) ** 0.5 / (1 + k // 2) for k in range(n - n % 2)] + [0.0] * (n % 2))
    return system.flow(system.state(q, p))


def near_geodesic(gap: float) -> MumfordFlow:
    """A geodesic on an ellipsoid with two axes of nearly the same length."""
    a, p = np.array([1, 2, 2 + gap, 5]), np.array([1, -0.5, 0.75, 0.25])
    system, q = Ellipsoid(a), np.sqrt(a) / 2
    return system.flow(system.state(q, p - q / a * (q / a @ p) / (q / a @ q / a)))


def near_axis(gap: float) -> MumfordFlow:
    """A motion on S³ that passes close to the unstable rest at the end of an axis."""
    system, q = Neumann((1, 2, 3, 4)), np.array([gap, gap, gap, 1.0])
    q /= np.linalg.norm(q)
    p = np.array([0.5 * gap, -gap, gap, 0.0])
    return system.flow(system.state(q, p - q * (q @ p)))


FLOWS = {
    "Neumann on S³": neumann,
    "Garnier with three axes": lambda: flow_of(Garnier((1, 2, 4)), size=0.5),
    "Toda with four particles": lambda: flow_of(TodaLattice(4)),
    "Toda with five particles": lambda: flow_of(TodaLattice(5)),
    "geodesic of genus 3": lambda: geodesic(4),
}
CLOSE = {
    "Neumann, two constants 1e-5 apart": lambda: flow_of(Neumann((1, 2, 2.00001, 4)), True),
    "geodesic, two axes 1e-4 apart": lambda: near_geodesic(1e-4),
    "Toda, small oscillations": lambda: flow_of(TodaLattice(4), size=1e-3),
    "Neumann next to a separatrix": lambda: near_axis(0.09),
}
SLOW = {"Neumann on S⁵": lambda: flow_of(Neumann((1, 2, 3, 4, 5, 6)), True), "geodesic of genus 5": lambda: geodesic(6)}


@pytest.mark.thinned(2)
@pytest.mark.parametrize("name", [*FLOWS, *(pytest.param(name, marks=pytest.mark.slow) for name in SLOW)])
def test_many_times_are_those_of_additions(name: str) -> None:
    flow = (FLOWS | SLOW)[name]()
    assert has_torus(flow)
    times = np.random.default_rng(5).uniform(-1e6, 1e6, 2 * MANY)
    times[:5] = 0.0, 1e-20, -1e-3, 1e6, -1e6
    path = forced(flow, "torus").at(times)
    assert np.array_equal(flow.at(times[3:]).q, path.q[3:])
    # the logarithms of the lattice are those of floats
    unit = 2.0**-51 if name.startswith("Toda") else 0.0
    true = forced(flow, "additions").at(times[:8])
    for found, other in (*zip(path.q, true.q, strict=False), *zip(path.p, true.p, strict=False)):
        assert np.abs(found - other).max() <= unit * np.abs(found).max()


def test_against_forty_digits() -> None:
    flow = neumann()
    times = np.linspace(-1e6, 1e6, MANY)
    path, system = flow.at(times), Neumann((1, 2, 3, 4), MP(40))
    truth = MumfordFlow(system, inside(system, flow.start, MP(40))).at(times[[0, 77]].tolist())
    assert np.abs(path.q[[0, 77]] - truth.q.astype(float)).max() < 1e-15


@pytest.mark.thinned(2)
@pytest.mark.parametrize("name", [*FLOWS, *(pytest.param(name, marks=pytest.mark.slow) for name in (SLOW | CLOSE))])
def test_points_are_those_of_sums_in_long_numbers(name: str) -> None:
    flow = (FLOWS | SLOW | CLOSE)[name]()
    torus = made_torus(flow)
    for t in (-0.125, 1e6, -1e9):
        with LongField(BITS_OF_TORUS) as N:
            found = [N.coerce(hi) + N.coerce(lo) for hi, lo in torus.points(np.array([t]))[:, 0].tolist()]
            angles, _ = flow._separated(N).angles_at(N.coerce(t))
            true = [x for phi in angles for x in gmpy2.sin_cos(phi / 2)]
            assert max(abs(x - y) for x, y in zip(found, true, strict=True)) < 1e-20


@pytest.mark.thinned(2)
@pytest.mark.parametrize("name", CLOSE)
def test_states_with_branch_points_close_together_are_those_of_additions(name: str) -> None:
    flow = CLOSE[name]()
    times = np.array([1e6 + 0.5, -3e6, 1e9])
    found, true = forced(flow, "torus").at(times), forced(flow, "additions").at(times)
    assert np.array_equal(found.q, true.q)
    assert np.array_equal(found.p, true.p)


def test_loops_interpreted_in_long_numbers_agree() -> None:
    flow = flow_of(TodaLattice(4))
    torus, times = made_torus(flow), [0.25, 1e3]
    with BareReals(120) as reals:

        def long(row: np.ndarray) -> list[Any]:
            return [reals.number(hi) + reals.number(lo) for hi, lo in row.reshape(-1, 2).tolist()]

        sums = torus.sums
        wide = {name: long(getattr(sums, name)) for name in ("waves", "places", "frequencies", "inverse")}
        sums = sums._replace(**wide, **{name: getattr(sums, name).tolist() for name in ("rough", "bounds", "circle")})
        sizes, out = [len(row) for row in room_for(3, 3)[:-1]], [reals.number(0)] * (2 * 3 * len(times))
        room = oval_loops.PhaseRoom(*([reals.number(0)] * n for n in sizes[:3]), *([0.0] * n for n in sizes[3:]), [0.0])
        assert oval_loops.points_at_times(sums, times, room, out)
        true = long(torus.points(np.array(times)))
        assert max(abs(x - y) for x, y in zip(out, true, strict=True)) < 1e-21


@pytest.mark.thinned(2)
@pytest.mark.parametrize("name", FLOWS)
def test_recorded_formulas_of_states_are_those_of_columns(name: str) -> None:
    flow = FLOWS[name]()
    torus, times = made_torus(flow), np.linspace(-1e4, 1e4, 20)
    with LongField(BITS_OF_TORUS) as N:
        pairs = flow._pairs_on(N, flow._separated(N))
    states = flow._back_at(pairs.at(Columns(), in_pairs(torus.points(times))), times)
    assert np.abs(torus.at(times) - states).max() <= 2.0**-52 * np.abs(states).max()


@pytest.mark.thinned(4)
@pytest.mark.parametrize("name", FLOWS)
def test_wrong_phases_and_signs_are_noticed(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    flow = FLOWS[name]()
    for k in range(flow._genus):
        torus = made_torus(flow)
        assert isinstance(torus, PhaseTorus)
        assert confirmed(flow, torus)
        torus.sums.places[k, 0] += 1e-9
        assert not confirmed(flow, torus)
        torus = made_torus(flow)
        torus.sums.frequencies[k] *= 1 + 1e-10
        assert not confirmed(flow, torus)
    right = OvalPairs.at

    def other_sheet(self: OvalPairs, N: Any, halves: Any) -> Any:
        u, v, lifts = right(self, N, halves)
        return u, tuple(-x for x in v), lifts

    monkeypatch.setattr(OvalPairs, "at", other_sheet)
    monkeypatch.setattr(flow.system._formulas, "_on_ovals", {})
    # a state of lifts alone does not show the sheet
    assert name.startswith(("Neumann", "Garnier")) or not has_torus(FLOWS[name]())


@pytest.mark.thinned(2)
@pytest.mark.parametrize("name", ["Neumann on S³", "Garnier with three axes", "geodesic of genus 3"])
def test_a_wrong_sign_of_a_lift_is_noticed(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    flow, right = FLOWS[name](), MumfordFlow._pairs_on
    for k in range(len(flow.system.constants)):

        def changed(self: MumfordFlow, N: Any, torus: Any, k: int = k) -> Any:
            pairs = right(self, N, torus)
            kappa, size, side = pairs.lifts[k] or (0, 0, 0)
            return pairs._replace(lifts=(*pairs.lifts[:k], (kappa, -size, side), *pairs.lifts[k + 1 :]))

        monkeypatch.setattr(MumfordFlow, "_pairs_on", changed)
        assert not confirmed(flow, made_torus(flow))


def test_points_that_are_not_found_are_refused_and_additions_take_over(monkeypatch: pytest.MonkeyPatch) -> None:
    flow, torus = neumann(), made_torus(neumann())
    torus.sums.frequencies[0] = np.nan
    with pytest.raises(PrecisionLoss, match="were not found"):
        torus.points(np.array([1.0]))
    true = flow.at([1e6])
    monkeypatch.setattr(oval_loops.LIBRARY, "points_at_times", lambda *given: False)
    again = flow.at([1e6])
    assert (true.way, again.way) == ("torus", "additions")
    assert np.array_equal(true.q, again.q)


def test_circles_have_thirty_digits() -> None:
    angles = np.random.default_rng(3).uniform(-20, 20, 50)
    angles[:3] = 0, 1e-300, np.pi
    s, c = circles(angles)
    with gmpy2.context(precision=200):
        for k, x in enumerate(angles.tolist()):
            true = gmpy2.sin_cos(gmpy2.mpfr(x))
            for found, wanted in zip((s, c), true, strict=True):
                assert abs(gmpy2.mpfr(found.hi[k]) + float(found.lo[k]) - wanted) < 1e-30


def test_single_times_take_the_torus_and_complex_points_have_none() -> None:
    flow = neumann()
    single = flow.at([1e6])
    assert single.way == "torus"
    assert np.array_equal(single.q, neumann().at([5e5, 1e6, 1e9]).q[1:2])
    resting = Neumann((1, 2, 3, 4))
    there = resting.flow(resting.state((1, 0, 0, 0), (0, 0, 0, 0))).at(np.linspace(1e6, 1e7, 20))
    assert (there.q == (1, 0, 0, 0)).all()
    star = HenonHeiles((1, 2), beta="-1/4")
    assert isinstance(has_torus(star.flow(star.state((0.1, 0.05, 0.02), (0.0, 0.1, 0.05)))), bool)
