"""Far times of motions of genus 3 and more: points found in their ovals, in double-double numbers."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from integrable.classical.ellipsoid import Ellipsoid
from integrable.classical.garnier import Garnier
from integrable.classical.henon_heiles import HenonHeiles
from integrable.classical.neumann import Neumann
from integrable.classical.toda import TodaLattice
from integrable.mumford.flow import TIMES_TO_TORUS, MumfordFlow
from integrable.mumford.phase_torus import PhaseTorus, circles
from integrable.portrait.separated import SeparatedTorus
from jacobian import MP
from jacobian.numbers.compiler import interpreted
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


FLOWS = {
    "Neumann on S³": neumann,
    "Garnier with three axes": lambda: flow_of(Garnier((1, 2, 4)), size=0.5),
    "Toda with four particles": lambda: flow_of(TodaLattice(4)),
    "Toda with five particles": lambda: flow_of(TodaLattice(5)),
    "geodesic of genus 3": lambda: geodesic(4),
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


@pytest.mark.thinned(4)
@pytest.mark.parametrize("name", FLOWS)
def test_wrong_phases_and_signs_are_noticed(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    flow = FLOWS[name]()
    for k in range(flow._genus):
        torus = made_torus(flow)
        assert isinstance(torus, PhaseTorus)
        torus._places[k] = torus._places[k] + 1e-9
        assert not confirmed(flow, torus)
        torus = made_torus(flow)
        torus._frequencies[k] = torus._frequencies[k] * (1 + 1e-10)
        assert not confirmed(flow, torus)
    right = SeparatedTorus.pair_at

    def other_sheet(self: SeparatedTorus, N: Any, halves: Any, ends: Any) -> Any:
        u, v, lifts = right(self, N, halves, ends)
        return u, tuple(-x for x in v), lifts

    monkeypatch.setattr(SeparatedTorus, "pair_at", other_sheet)
    # a state of lifts alone does not show the sheet
    assert name.startswith(("Neumann", "Garnier")) or not has_torus(FLOWS[name]())


@pytest.mark.thinned(2)
@pytest.mark.parametrize("name", ["Neumann on S³", "Garnier with three axes", "geodesic of genus 3"])
def test_a_wrong_sign_of_a_lift_is_noticed(name: str) -> None:
    flow = FLOWS[name]()
    for k in range(len(flow.system.constants)):
        torus = made_torus(flow)

        def changed(halves: Any, turned: Any, read: Any = torus._read, k: int = k) -> Any:
            D = read(halves, turned)
            kappa, sigma, nu = D.data[k]
            return D._replace(data=(*D.data[:k], (kappa, -sigma, -nu), *D.data[k + 1 :]))

        torus._read = changed
        assert not confirmed(flow, torus)


def test_circles_have_thirty_digits() -> None:
    import gmpy2

    angles = np.random.default_rng(3).uniform(-20, 20, 50)
    angles[:3] = 0, 1e-300, np.pi
    s, c = circles(angles)
    with gmpy2.context(precision=200):
        for k, x in enumerate(angles.tolist()):
            true = gmpy2.sin_cos(gmpy2.mpfr(x))
            for found, wanted in zip((s, c), true, strict=True):
                assert abs(gmpy2.mpfr(found.hi[k]) + float(found.lo[k]) - wanted) < 1e-30


def test_few_times_take_additions_and_complex_points_have_no_torus() -> None:
    flow = neumann()
    few = np.linspace(1e6, 2e6, TIMES_TO_TORUS - 1)
    assert flow.at(few).way == "additions"
    assert flow.at([*few, 3e6]).way == "torus"
    resting = Neumann((1, 2, 3, 4))
    there = resting.flow(resting.state((1, 0, 0, 0), (0, 0, 0, 0))).at(np.linspace(1e6, 1e7, 20))
    assert (there.q == (1, 0, 0, 0)).all()
    star = HenonHeiles((1, 2), beta="-1/4")
    assert isinstance(has_torus(star.flow(star.state((0.1, 0.05, 0.02), (0.0, 0.1, 0.05)))), bool)
