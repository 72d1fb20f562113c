"""Many times of motions of genus 3 and more: sums of tabled translations in double-double numbers."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from integrable.classical.garnier import Garnier
from integrable.classical.neumann import Neumann
from integrable.classical.toda import TodaLattice
from integrable.mumford import pair_sums
from integrable.mumford.flow import MumfordFlow
from integrable.mumford.motion import Placed, Start
from integrable.mumford.pair_sums import Space, TabledCurve
from integrable.mumford.pair_tables import TERMS, DiscUnits, PairTables, motion_of, row_of
from integrable.mumford.tabled import MANY, TabledStates
from jacobian import MP
from jacobian.errors import PrecisionLoss
from jacobian.inexact.long_field import LongField
from tests.integrable.ways import forced


def neumann() -> MumfordFlow:
    """A motion on S³."""
    return flow_of(Neumann((1, 2, 3, 4)), True)


@pytest.fixture(scope="module")
def tabled() -> MumfordFlow:
    """A motion on S³ that has tables for times below 50."""
    flow = neumann()
    forced(flow, "tables").at(np.linspace(0, 50, MANY))
    return flow


def flow_of(system: Any, on_sphere: bool = False, size: float = 1.0) -> MumfordFlow:
    """The motion of a random state."""
    rng = np.random.default_rng(system.size)
    q, p = (rng.uniform(-size, size, system.size) for _ in range(2))
    if on_sphere:
        q /= np.linalg.norm(q)
        p -= q * (q @ p)
    return system.flow(system.state(q, p))


FLOWS = {
    "Neumann on S³": neumann,
    "Garnier with three axes": lambda: flow_of(Garnier((1, 2, 4)), size=0.5),
    "Toda with five particles": lambda: flow_of(TodaLattice(5)),
}
SLOW = {"Neumann on S⁵": lambda: flow_of(Neumann((1, 2, 3, 4, 5, 6)), True)}


def memory(genus: int) -> Space:
    """Working memory for sums of numbers of any kind."""
    rows = [np.empty(2 * genus + 3, dtype=object) for _ in range(4)]
    matrix = np.empty((genus, genus + 1), dtype=object)
    return Space(matrix, *rows, np.empty((genus, 2 * genus + 1)), np.empty(2 * genus + 1))


@pytest.mark.parametrize("name", FLOWS)
def test_a_sum_is_that_of_the_extended_group(name: str) -> None:
    flow = FLOWS[name]()
    with LongField(500) as K:
        placed = Placed(K, DiscUnits(flow._place).start)
        group, translations, g = placed.group, placed.translations(), flow._genus
        D = placed.at(K.coerce(2.25))
        S = translations.from_reference(translations.carried(translations.reference, K.coerce(7.3)))
        true = group.add(D, S)
        row = np.array([*D.u[:-1], *D.v, *(x for _, *pair in D.data for x in pair)])
        other = np.array([*S.u[:-1], *S.v, *(x for _, *pair in S.data for x in pair)])
        ends = np.array([kind.e for kind in group.kinds], dtype=object)
        kappa = S.data[0][0] if S.data else K.one
        pair_sums.add(TabledCurve(np.array(group.f), ends, kappa, np.empty(0)), row, other, memory(g))
        expected = [*true.u[:-1], *true.v, *(x for _, *pair in true.data for x in pair)]
        assert max(abs(x - y) for x, y in zip(row, expected, strict=True)) < 1e-50 * max(map(abs, expected))


def test_a_pair_is_moved_onto_the_curve() -> None:
    flow = neumann()
    with LongField(300) as K:
        placed = Placed(K, flow._place)
        space, (u, v, _), f = memory(3), placed.start, placed.group.f
        row = np.array([*u[:-1], *v])
        row[0] += 1e-9
        problem = TabledCurve(np.array(f), np.empty(0), 1.0, np.empty(0))
        off = []
        for _ in range(3):
            space.u[:3], space.v[:3] = row[:3], row[3:]
            pair_sums.retract(problem, row, space)
            off.append(max(abs(x) for x in space.turned[:, 6]))
    assert abs(row - np.array([*u[:-1], *v])).max() < 1e-7
    # the right-hand sides of the rows that are made orthogonal
    assert off[0] > 1e-12
    assert off[1] < 1e-14
    assert off[2] < 1e-20


def test_lifts_have_power_series() -> None:
    flow = neumann()
    with LongField(300) as K:
        placed, time = Placed(K, flow._place), K.coerce(0.01)
        rows = motion_of(placed).rows(row_of(placed.start), TERMS)[-2 * len(placed.start.data) :]
        found = [sum((c * time**k for k, c in enumerate(row)), K.zero) for row in rows]
        expected = [x for _, *pair in placed.at(time).data for x in pair]
        assert max(abs(x - y) for x, y in zip(found, expected, strict=True)) < 1e-55


@pytest.mark.parametrize("name", [*FLOWS, *(pytest.param(name, marks=pytest.mark.slow) for name in SLOW)])
def test_many_times_are_those_of_additions(name: str) -> None:
    flow = (FLOWS | SLOW)[name]()
    times = np.random.default_rng(5).uniform(-1e6, 1e6, 2 * MANY)
    times[:5] = 0.0, 1e-20, -1e-3, 1e6, -1e6
    path = flow.at(times)
    tables = flow._tabled._tables  # type: ignore[union-attr]
    assert tables is not None
    assert len(flow._tabled._from_tables(tables, times)) > 0.9 * len(times)  # type: ignore[union-attr]
    # the logarithms of the lattice are those of floats
    unit = 2.0**-51 if name.startswith("Toda") else 0.0
    true = forced(flow, "additions").at(times[:8])
    for found, other in (*zip(path.q, true.q, strict=False), *zip(path.p, true.p, strict=False)):
        assert np.abs(found - other).max() <= unit * np.abs(found).max()


def test_against_forty_digits() -> None:
    flow = neumann()
    times = np.linspace(-1e6, 1e6, MANY)
    path, system = flow.at(times), Neumann((1, 2, 3, 4), MP(40))
    truth = MumfordFlow(system, system._inside(MP(40), flow.start)).at(times[[0, 77]].tolist())
    assert np.abs(path.q[[0, 77]] - truth.q.astype(float)).max() < 1e-15


def test_what_two_starts_do_not_agree_on_comes_from_additions(
    tabled: MumfordFlow, monkeypatch: pytest.MonkeyPatch
) -> None:
    states, times = tabled._tabled, np.linspace(0, 50, 7)
    assert isinstance(states, TabledStates)
    assert states._tables is not None
    assert len(states._from_tables(states._tables, times)) == 7
    near = [row * (1 + 1e-15 * k) for k, row in enumerate(states._tables._near)]
    monkeypatch.setattr(states._tables, "_near", near)
    assert not states._from_tables(states._tables, times)
    assert np.array_equal(states.at(times)[0], forced(tabled, "additions").at(times).q)


def test_tables_that_are_wrong_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    flow, in_units = neumann(), DiscUnits.start

    def other_direction(self: DiscUnits, K: Any) -> Start:
        start = in_units(self, K)
        return start._replace(direction=[c * (1 + 1e-13) for c in start.direction])

    monkeypatch.setattr(DiscUnits, "start", other_direction)
    states = flow._tabled
    assert states is not None
    assert states._made_for(np.array([29.0, 30.0])) is None


def test_few_times_and_far_ones_take_no_tables(tabled: MumfordFlow) -> None:
    flow = neumann()
    flow.at([1e4, 2e4])
    assert flow._tabled is not None
    assert flow._tabled._tables is None
    states = tabled._tabled
    assert states is not None
    assert states._tables is not None
    reach = states._tables.reach
    assert 50 < reach < 1e3
    far = tabled.at([1.0, 1e9])
    assert states._tables.reach == reach
    assert far.q[1].tolist() == forced(tabled, "additions").at([1e9]).q[0].tolist()


def test_times_too_far_for_tables_leave_those_of_near_ones(
    tabled: MumfordFlow, monkeypatch: pytest.MonkeyPatch
) -> None:
    states = tabled._tabled
    assert states is not None
    tables = states._tables
    for name, value in (("_refused", False), ("_beyond", 0), ("_by_additions", lambda t: [[0.0] * 4] * 2)):
        monkeypatch.setattr(states, name, value)
    states.at(np.full(MANY, 1e25))
    assert states._refused
    assert states._tables is tables is not None


def test_motions_without_tables() -> None:
    with pytest.raises(PrecisionLoss, match="even genus"):
        PairTables(flow_of(TodaLattice(4))._place, 1.0)
    with pytest.raises(PrecisionLoss, match="tables would be needed"):
        PairTables(neumann()._place, 1e30)
    resting = Neumann((1, 2, 3, 4))
    with pytest.raises(PrecisionLoss, match="rests"):
        PairTables(resting.flow(resting.state((1, 0, 0, 0), (0, 0, 0, 0)))._place, 1.0)
