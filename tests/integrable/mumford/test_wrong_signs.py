"""The torus of a motion of any system is rejected if one sign of its states is wrong: of time, the sheet, a lift, or an
angle about an axis.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from integrable.classical.kuzmin_kutuzov import KuzminKutuzov
from integrable.mumford.columns import Columns
from integrable.mumford.elliptic_torus import EllipticTorus
from integrable.mumford.phase_torus import PhaseTorus, in_pairs
from integrable.mumford.theta_torus import ThetaTorus
from jacobian import RR
from jacobian.inexact.long_field import LongField
from jacobian.numbers.compiler import interpreted
from jacobian.relatives.extended import Lift
from tests.integrable.classical.rows import CASES, REAL
from tests.integrable.ways import confirmed, made_torus

pytestmark = pytest.mark.skipif(interpreted(), reason="the loops of the torus are compiled")

STARS = {
    "star, flat galaxy": ((1.5, 1.0), (1.1, 0.0, 0.2), (0.1, 0.4, 0.35)),
    "star, the other way round": ((1.5, 1.0), (1.1, 0.0, 0.2), (0.1, -0.4, 0.35)),
    "star, long galaxy": ((1.0, 1.5), (1.1, 0.3, 0.2), (0.1, 0.4, -0.35)),
    "star, L = 0": ((1.5, 1.0), (1.0, 0.0, 0.25), (0.25, 0.0, 0.375)),
    "star, long galaxy, L = 0": ((1.0, 1.5), (1.0, 0.0, 0.25), (0.25, 0.0, -0.375)),
}
# bodies on the layer have the torus of the ball, see torus/test_body_torus; the closed form of tops and of the
# spherical pendulum has no pairs, see classical/test_axial_torus
PAIRED = [(name, n) for name, n in CASES if name not in ("ball", "top", "lagrange", "pendulum", "galaxy")]


def flow_of(name: str, n: int = 0) -> Any:
    if name in STARS:
        axes, *start = STARS[name]
        system = KuzminKutuzov(axes)
        return system.flow(system.state(*start))
    system, state = REAL[name](RR, n)
    return system.flow(state)


def changed(flow: Any, change: Any) -> Any:
    """A torus of the motion with ``change`` applied to its pairs."""
    torus = made_torus(flow)
    if not isinstance(torus, PhaseTorus):
        right = torus.at
        torus.at = lambda times: change(right(times))
        return torus
    with LongField(200) as N:
        separated = flow._separated(N)
        pairs, ends = flow._pairs_on(N, separated), 2 * len(separated.ovals)

    def read(points: Any, times: Any) -> Any:
        halves, turned = in_pairs(points[:ends]), in_pairs(points[ends:])
        return flow._back_at(change(pairs.at(Columns(), halves, turned)), times)

    torus._read = read
    return torus


def with_datum(D: Any, k: int, wrong: Any) -> Any:
    data = [*D.data]
    data[k] = wrong
    return D._replace(data=tuple(data))


over_all = pytest.mark.parametrize(("name", "n"), [*PAIRED, *((name, 3) for name in STARS)])


@pytest.mark.thinned(2)
@over_all
def test_time_that_runs_back_is_noticed(name: str, n: int) -> None:
    flow = flow_of(name, n)
    torus = made_torus(flow)
    assert isinstance(torus, EllipticTorus | PhaseTorus | ThetaTorus)
    assert confirmed(flow, torus)
    right = torus.at
    torus.at = lambda times: right(-times)
    assert not confirmed(flow, torus)


@pytest.mark.thinned(2)
@over_all
def test_a_lift_on_the_wrong_side_and_the_other_sheet_are_noticed(name: str, n: int) -> None:
    """Each lift (κ, σ, ν) with −σ and −ν, with −σ alone, and with −ν alone; then −V."""
    flow = flow_of(name, n)
    with LongField(200) as N:
        kinds = flow._place(N).kinds
    for k in (k for k, kind in enumerate(kinds) if isinstance(kind, Lift)):
        for one, other in ((-1, -1), (-1, 1), (1, -1)):

            def wrong(D: Any, k: int = k, one: int = one, other: int = other) -> Any:
                kappa, sigma, nu = D.data[k]
                return with_datum(D, k, (kappa, one * sigma, other * nu))

            assert not confirmed(flow, changed(flow, wrong)), (k, one, other)
    opposite = changed(flow, lambda D: D._replace(v=tuple(-x for x in D.v)))
    # q and p of these follow from the lifts and U
    assert confirmed(flow, opposite) == (name in ("neumann", "garnier", "veselova"))


@pytest.mark.thinned(2)
@pytest.mark.parametrize("name", STARS)
def test_wrong_phases_rates_and_angles_of_a_star_are_noticed(name: str) -> None:
    """Phases of both ovals and their frequencies, and the angle about the axis: its rate, its start and its sense."""
    flow = flow_of(name)
    turning = flow.system.integrals(flow.start)["L"] != 0

    def noticed(change: Any) -> bool:
        torus = made_torus(flow)
        change(torus)
        return not confirmed(flow, torus)

    for k in range(2):
        for wrong in (lambda x: -x, lambda x: x + 1e-9):
            assert noticed(lambda torus, k=k, wrong=wrong: put(torus.sums.places, k, wrong))
    for k in range(3 if turning else 2):
        for wrong in (lambda x: -x, lambda x: x * (1 + 1e-10)):
            assert noticed(lambda torus, k=k, wrong=wrong: put(torus.sums.frequencies, k, wrong))
    assert noticed(lambda torus: put(torus.sums.places, 2, lambda x: x + 1e-10))
    sense = changed(flow, lambda D: with_datum(D, -1, (D.data[-1][0], -D.data[-1][1])))
    assert confirmed(flow, sense) == (not turning)


def put(rows: np.ndarray, k: int, wrong: Any) -> None:
    """Changes the k-th double-double by a function that is linear but for a constant."""
    high, low = rows[k]
    rows[k] = wrong(high), wrong(low) - wrong(0.0)
