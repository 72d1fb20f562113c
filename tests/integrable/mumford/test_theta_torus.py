"""Motions whose branch points are not all real, or whose points are not one in each oval, by theta functions."""

from __future__ import annotations

import numpy as np
import pytest

from integrable.classical.garnier import Garnier
from integrable.classical.henon_heiles import HenonHeiles
from integrable.mumford import theta_torus
from integrable.mumford.flow import TIMES_TO_THETA
from integrable.mumford.real_torus import OtherOvals, RealTorus
from integrable.mumford.theta_torus import ThetaTorus, theta_lifts
from jacobian import MP, HyperellipticCurve, PrecisionLoss
from jacobian.inexact.long_field import LongField
from jacobian.numbers.compiler import interpreted
from jacobian.numbers.long_reals import BareReals
from jacobian.periods import real_basis
from jacobian.periods.matrix import periods
from tests.integrable.ways import confirmed, forced, has_torus, made_torus

CUBIC = HenonHeiles((2.625,), -0.5, -0.25, 0, (0,))
MOTIONS = {
    "two complex roots": (CUBIC, (0.1, 0.05), (0.0, 0.1)),
    "two complex roots, another motion": (CUBIC, (-0.15, 0.3), (0.1, 0.2)),
    "two roots that nearly meet": (CUBIC, (0.1, 0.02), (0.0, 0.1)),
    "through an axis": (CUBIC, (0.1, 0.0), (0.0, 0.1)),
    "attracted to infinity": (Garnier((0, 1), -1, 2), (0.3, 0.5), (0.2, -0.4)),
    "repelled": (Garnier((0, 1), -1, -2), (0.3, 0.5), (0.7, 0.4)),
}
compiled = pytest.mark.skipif(interpreted(), reason="the sums are compiled")


def flow_of(name):
    system, q, p = MOTIONS[name]
    return system.flow(system.state(q, p))


@compiled
@pytest.mark.parametrize("name", MOTIONS)
def test_far_states_are_those_of_additions(name) -> None:
    flow = flow_of(name)
    with pytest.raises(OtherOvals):
        RealTorus(flow._place)
    assert has_torus(flow)
    assert isinstance(made_torus(flow), ThetaTorus)
    times = [0, 0.5, -3.25, 97, 1e3, -1e6, 1e9]
    found, true = forced(flow, "torus").at(times), forced(flow, "additions").at(times)
    for part, right in ((found.q, true.q), (found.p, true.p)):
        assert (np.abs(part - right).max(axis=1) <= 4e-16 * np.abs(right).max(axis=1)).all()


@compiled
def test_few_far_times_do_not_wait_for_theta_functions() -> None:
    """Their bits are those of the states that theta functions give."""
    times = np.linspace(1e6, 1e6 + 40, TIMES_TO_THETA)
    many, few = flow_of("two complex roots").at(times), flow_of("two complex roots").at(times[:-1])
    assert (many.way, few.way) == ("torus", "additions")
    assert np.array_equal(many.q[:-1], few.q)
    assert np.array_equal(many.p[:-1], few.p)


@compiled
@pytest.mark.parametrize("which", range(2))
@pytest.mark.parametrize("name", MOTIONS)
def test_what_is_wrong_is_noticed(name, which) -> None:
    """A wrong sign of a lift, direction of a phase, phase at the start, or frequency."""
    flow = flow_of(name)

    def torus():
        return made_torus(flow)

    assert confirmed(flow, torus())
    wrong = torus()
    if which < wrong._read:
        kappa, size = wrong._sizes[which]
        wrong._sizes[which] = kappa, -size
        assert not confirmed(flow, wrong)
    for change in (lambda nu: -nu, lambda nu: nu * (1 + 1e-9)):
        wrong = torus()
        wrong._frequencies[which] = change(wrong._frequencies[which])
        assert not confirmed(flow, wrong)
    wrong = torus()
    places = list(wrong._places)
    places[which] = places[which] + 1e-9
    wrong._places = tuple(places)
    assert not confirmed(flow, wrong)


@compiled
def test_a_wrong_characteristic_is_noticed(monkeypatch) -> None:
    right = theta_torus.characteristics

    def wrong(Z, found):
        chars = right(Z, found)
        return [*chars[:-2], chars[-1], chars[-2]]

    monkeypatch.setattr(theta_torus, "characteristics", wrong)
    assert not has_torus(flow_of("two complex roots"))


@compiled
def test_the_source_interpreted_in_long_numbers_is_what_is_compiled() -> None:
    torus, reals = made_torus(flow_of("two complex roots")), BareReals(160)
    phases = np.array([[0.3, 0.1], [-0.75, 1.5], [0.0, 0.25]])
    sums = torus._sums
    with reals:
        table, inverse = (
            [reals.number(x) + reals.number(y) for x, y in row.tolist()] for row in (sums.table, sums.inverse)
        )
        given = [reals.number(x) for x in phases.ravel().tolist()]
        out = [reals.number(0)] * 15
        theta_lifts(sums._replace(table=table, inverse=inverse), given, out)
    found = torus._values(np.stack([phases, 0 * phases], axis=-1))[..., 0]
    assert np.abs(np.reshape([float(x) for x in out], (3, 5)) / found - 1).max() < 1e-14


def test_cycles_are_periods_of_the_curve() -> None:
    """In a basis found by other means, the cycles have integral coordinates and are symplectic; A is real, Im τ is
    reduced.
    """
    f = (0.5, -1, 0.25, 2, 1, -1)
    K = MP(36)
    other = periods(HyperellipticCurve(K, [K.coerce(c) for c in f]))
    with LongField(160) as N:
        roots = theta_torus.complex_roots(N, tuple(map(N.coerce, f)), [])
        with LongField(160, complex=True) as Z:
            roots = [Z.coerce(e) for e in roots]
            found = real_basis.real_basis(Z, real_basis.half_integrals(Z, roots, N.coerce(f[-1])))
            assert sum(e.imag != 0 for e in roots) in (2, 4)
            assert max(abs(x.imag) for cycle in found.cycles[:2] for x in cycle) < 1e-30
            tau = real_basis.ratio(Z, found.cycles)
            assert abs(tau[0][1] - tau[1][0]) < 1e-30
            assert 2 * abs(tau[0][1].imag) <= tau[0][0].imag <= tau[1][1].imag
            rows = [other.coordinates([K.context.mpc(str(x.real), str(x.imag)) for x in c]) for c in found.cycles]
    whole = np.array([[round(float(x)) for x in row] for row in rows])
    assert (
        max(abs(float(x) - n) for row, ns in zip(rows, whole, strict=True) for x, n in zip(row, ns, strict=True))
        < 1e-30
    )
    form = np.array([[0, 0, 1, 0], [0, 0, 0, 1], [-1, 0, 0, 0], [0, -1, 0, 0]])
    assert np.array_equal(abs(whole @ form @ whole.T), abs(form))


def test_branch_points_that_nearly_meet_are_refused() -> None:
    with pytest.raises(PrecisionLoss, match="near"):
        real_basis.checked(real_basis.MOST_NODES + 1)
