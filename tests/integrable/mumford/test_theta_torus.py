"""Motions whose branch points are not all real, or whose points are not one in each oval, by theta functions."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

from integrable.classical.garnier import Garnier
from integrable.classical.henon_heiles import HenonHeiles
from integrable.classical.veselova import Veselova
from integrable.moving_point.elliptic_integrals import oval_periods
from integrable.mumford import theta_torus
from integrable.mumford.bodies import BodyFlow
from integrable.mumford.branch_points import PairModel, long_roots, opened, without_root
from integrable.mumford.theta_torus import ThetaTorus
from integrable.torus.lifts import Torus
from integrable.torus.loops import CompiledLoops, theta_sums
from integrable.torus.pair_loops import PairTorus, pairs_at
from integrable.torus.states import phases_at
from integrable.torus.theta_series import half_turn, theta
from jacobian import MP, HyperellipticCurve, PrecisionLoss
from jacobian.inexact.long_field import LongField
from jacobian.numbers.compiler import interpreted
from jacobian.numbers.long_reals import BareReals
from jacobian.periods import paths, real_basis
from jacobian.periods.matrix import periods
from jacobian.relatives.extended import Lift
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


@pytest.mark.thinned(2)
@compiled
@pytest.mark.parametrize("name", MOTIONS)
def test_far_states_are_those_of_additions(name) -> None:
    flow = flow_of(name)
    assert has_torus(flow)
    assert isinstance(made_torus(flow), ThetaTorus)
    times = [0, 0.5, -3.25, 97, 1e3, -1e6, 1e9]
    found, true = forced(flow, "torus").at(times), forced(flow, "additions").at(times)
    for part, right in ((found.q, true.q), (found.p, true.p)):
        assert (np.abs(part - right).max(axis=1) <= 4e-16 * np.abs(right).max(axis=1)).all()


@compiled
def test_one_far_time_is_read_on_the_torus() -> None:
    times = np.linspace(1e6, 1e6 + 40, 6)
    many, one = flow_of("two complex roots").at(times), flow_of("two complex roots").at(times[:1])
    assert (many.way, one.way) == ("torus", "torus")
    assert np.array_equal(many.q[:1], one.q)
    assert np.array_equal(many.p[:1], one.p)


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
    if which < sum(isinstance(kind, Lift) for kind in wrong._kinds):
        wrong._torus.sizes[2 * which : 2 * which + 2] *= -1
        assert not confirmed(flow, wrong)
    for change in (lambda nu: -nu, lambda nu: nu * (1 + 1e-9)):
        wrong = torus()
        wrong._torus.frequencies[which] = change(wrong._torus.frequencies[which])
        assert not confirmed(flow, wrong)
    wrong = torus()
    wrong._torus.torus.places[which, 0] += 1e-9
    assert not confirmed(flow, wrong)


@compiled
def test_a_wrong_characteristic_is_noticed(monkeypatch) -> None:
    right = theta_torus.characteristics

    def wrong(found):
        chars = right(found)
        return [*chars[:-2], chars[-1], chars[-2]]

    monkeypatch.setattr(theta_torus, "characteristics", wrong)
    assert not has_torus(flow_of("two complex roots"))


@compiled
def test_the_source_interpreted_in_long_numbers_is_what_is_compiled() -> None:
    torus, reals = made_torus(flow_of("two complex roots")), BareReals(160)
    times = np.array([0.3, -17.5, 1e4])
    compiled, found = torus._torus, torus.at(times)
    with reals:

        def long(row):
            return [reals.number(x) + reals.number(y) for x, y in row.tolist()]

        own, places, factors = compiled.torus
        sums = own._replace(table=long(own.table), inverse=long(own.inverse))
        rows = [long(row) for row in compiled[1:]]
        interpreted = PairTorus(Torus(sums, long(places), long(factors)), *rows)
        out, phases = [reals.number(0)] * (3 * (2 * len(found.data) + 4)), [reals.number(0)] * 6
        phases_at(interpreted.frequencies, times.tolist(), phases)
        pairs_at(interpreted, phases, [reals.number(0)] * 12, out)
    columns = np.reshape([float(x) for x in out], (-1, 3))
    for k, column in enumerate([*found.data[0][1:], *found.u[:2], *found.v]):
        assert np.abs(columns[k] / column.hi - 1).max() < 1e-14


@compiled
@pytest.mark.parametrize("f", [(0.5, -1, 0.25, 2, 1, -1), (-8.0, -2.0, 18.0, 4.5, -4.0, -1.0), (4.0, 0, -5, 0, 1, 1)])
def test_series_are_theta_functions(f: tuple[float, ...]) -> None:
    """Values, derivatives and scales are those of Σ e^(πi nτn + 2πi n(φ + ½δ)), n in Z² + ½ε, up to one phase."""
    along = (0.75, -0.5)
    with LongField(160) as N, LongField(160, complex=True) as Z:
        roots = [Z.coerce(e) for e in long_roots(N, tuple(map(N.coerce, f)), [])]
        found = real_basis.real_basis(real_basis.half_integrals(Z, roots, N.coerce(f[-1])))
        tau, chars = real_basis.ratio(found.cycles), real_basis.characteristics(found)
        # the series of complex branch points are not real
        chars = [char for char, e in zip(chars, [*roots, Z.one], strict=True) if e.imag == 0]
        entries = tau[0][0], tau[0][1], tau[1][1]
        loops, real = CompiledLoops(), [round(2 * float(x.real)) for x in entries]
        sums, tops = theta_sums(loops, loops.row([*(x.imag for x in entries), *map(N.coerce, along)]), real, chars)
    table, tau = sums._replace(table=sums.table[:, 0].copy()), np.array([[complex(x) for x in row] for row in tau])
    # powers that all terms of all series have are left out
    common = [min(char[i] for char in chars) for i in (0, 1)]
    left_out = np.exp(-np.pi * (tau[0, 0].imag * common[0] + tau[1, 1].imag * common[1]) / 4)
    for k, (e1, e2, d1, d2) in enumerate(chars):
        a, b = (np.arange(-12, 13) + e / 2 for e in (e1, e2))
        a, b = a[:, None], b[None, :]
        form = tau[0, 0] * a * a + 2 * tau[0, 1] * a * b + tau[1, 1] * b * b
        ratios = []
        for phi in ((0.1, 0.2), (-0.7, 0.35), (1.3, -0.45)):
            terms = np.exp(1j * np.pi * (form + 2 * a * (phi[0] + d1 / 2) + 2 * b * (phi[1] + d2 / 2)))
            true = terms.sum(), (2j * np.pi * (a * along[0] + b * along[1]) * terms).sum()
            made = theta(table, k, *((np.cos(np.pi * x), np.sin(np.pi * x)) for x in phi))
            ratios += [x / (y * tops[k, 0] * left_out) for x, y in zip(true, made, strict=True)]
        assert np.abs(np.array(ratios) / ratios[0] - 1).max() < 1e-11
        assert abs(abs(ratios[0]) - 1) < 1e-12


def test_cycles_are_periods_of_the_curve() -> None:
    """In a basis found by other means, the cycles have integral coordinates and are symplectic; A is real, Im τ is
    reduced.
    """
    f = (0.5, -1, 0.25, 2, 1, -1)
    K = MP(36)
    other = periods(HyperellipticCurve(K, [K.coerce(c) for c in f]))
    with LongField(160) as N:
        roots = long_roots(N, tuple(map(N.coerce, f)), [])
        with LongField(160, complex=True) as Z:
            roots = [Z.coerce(e) for e in roots]
            found = real_basis.real_basis(real_basis.half_integrals(Z, roots, N.coerce(f[-1])))
            assert sum(e.imag != 0 for e in roots) in (2, 4)
            assert max(abs(x.imag) for cycle in found.cycles[:2] for x in cycle) < 1e-30
            tau = real_basis.ratio(found.cycles)
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


def test_rules_agree_and_branch_points_that_nearly_meet_are_refused() -> None:
    """Rules that crowd at the ends serve real branch points, wherever these are; complex ones are refused there."""
    with LongField(160, complex=True) as Z:
        roots = [Z.coerce(x) for x in (-2, -0.75, 0.5, 1, 3)]
        for k in range(4):
            path = paths.straight(Z, roots[k], roots[k + 1], [e for i, e in enumerate(roots) if i not in (k, k + 1)])
            gauss, other = (
                paths.path_integrals(path, rule) for rule in (paths.chebyshev_rule(120), paths.logistic_rule(False))
            )
            assert max(abs(x / y - 1) for x, y in zip(gauss, other, strict=True)) < 1e-29
        path = paths.straight(Z, roots[0], Z.coerce(-1), roots[1:])
        gauss, other = (
            paths.path_integrals(path, rule) for rule in (paths.legendre_rule(120), paths.logistic_rule(True))
        )
        assert max(abs(x / y - 1) for x, y in zip(gauss, other, strict=True)) < 1e-29
        assert not path.graded(paths.MOST_NODES_IF_REAL)
        assert path.graded(paths.MOST_NODES + 1)
        with pytest.raises(PrecisionLoss, match="near"):
            path._replace(poles=[Z.coerce(1j)]).graded(paths.MOST_NODES + 1)


@pytest.mark.parametrize("gap", [2.0**-10, 2.0**-40])
def test_periods_of_branch_points_that_nearly_meet_are_those_of_richelot(gap: float) -> None:
    roots = [-2, -0.75, 1 - gap, 1, 3]
    with LongField(160) as N:
        ends, out = [N.coerce(x) for x in roots], [N.zero] * 4
        oval_periods(ends[:4], N.one, ends[4], half_turn(), N.root_of_eps / 16, out)
        with LongField(160, complex=True) as Z:
            found = [paths.along(Z, [Z.coerce(x) for x in roots], Z.one, k) for k in (0, 2)]
            flat = [2 * x for pair in found for x in pair]
            signs = [1 if (x / y).real > 0 else -1 for x, y in zip(flat, out, strict=True)]
            assert signs[0] == signs[1]
            assert signs[2] == signs[3]
            assert max(abs(s * x / y - 1) for s, x, y in zip(signs, flat, out, strict=True)) < 1e-28


def test_integrals_to_a_point_end_where_they_begin() -> None:
    """Twice the integral from the end of an oval to the other one is its period, in parts or whole."""
    roots, x = [-2, -0.75, 1 - 2.0**-40, 1, 3], 0.25
    with LongField(160, complex=True) as Z:
        whole = [*map(Z.coerce, roots)]
        # a point of the second gap, from either end of it
        y = Z.sqrt(paths_value(whole, x))
        begin = [(Z.zero, Z.zero)] * 6
        parts = []
        for k in (1, 2):
            far = [e for i, e in enumerate(whole) if i != k]
            path = paths.straight(Z, whole[k], Z.coerce(x), far)
            first, _ = paths.path_integrals(path, paths.logistic_rule(True))
            parts.append(abs(first / path.factor * Z.sqrt(Z.coerce(x) - whole[k])))
        gap = abs(paths.along(Z, whole, Z.one, 1)[0])
        assert abs(sum(parts) / gap - 1) < 1e-28
        assert abs(abs(paths.to_point(Z, whole, Z.one, begin, (Z.coerce(x), y))[0]) / min(parts) - 1) < 1e-28


def paths_value(roots, x):
    product = 1
    for e in roots:
        product *= x - e
    return product


@pytest.mark.parametrize(
    ("lead", "points", "taken"),
    [(1, (2.5, 4.5), True), (1, (2, 5), True), (1, (2.5, 2.75), False), (1, (2.5, 7), False), (-1, (1.5, 3.5), False)],
)
def test_a_pair_that_may_pass_the_root_at_infinity_is_refused(lead, points, taken) -> None:
    """On a model of even degree the points of the pair must be one in each bounded oval below the largest root."""
    x, y = points
    model = PairModel(lead, (x * y, -x - y), (0.5, 0.25), (1, 0), [1, 2, 3, 4, 5, 6])
    if taken:
        moved = without_root(model)
        assert moved.lead == -lead * 120
        assert moved.roots == [1 / 5, 1 / 4, 1 / 3, 1 / 2, 1]
    else:
        with pytest.raises(PrecisionLoss, match="one in each oval"):
            without_root(model)


def test_an_oval_that_is_a_point_is_opened_and_no_other() -> None:
    with LongField(160) as N:
        one, low = N.one, N.coerce(0.25)
        for lead, roots, good in (
            (1, (low, low, one, 2 * one, 3 * one), True),
            (1, (-one, low, low, one, 2 * one), False),
            (-1, (-one, low, low, one, 2 * one), True),
        ):
            model = PairModel(lead, (low, low), (low, low), (1, 0), roots)
            if good:
                found = opened(N, model, {low}).roots
                assert sum(x != y for x, y in zip(found, roots, strict=True)) == 1
                assert 0 < min(y - x for x, y in pairwise(found)) < 1e-38
            else:
                with pytest.raises(PrecisionLoss, match="not told apart"):
                    opened(N, model, {low})


@compiled
def test_series_confirm_the_torus_of_very_unequal_moments(monkeypatch):
    """Additions took minutes there, since τ at a time is computed by quadrature along the motion (tests.fuzz systems
    --seed 20261128, kind "veselova", case 596).
    """
    system = Veselova((0.0009987571475752288, 0.00026160301755309814, 703.5566441873931))
    gamma = (0.0, 0.5181471586469594, 0.8552914836393981)
    state = system.state(gamma, (342.9930926679658, -0.0010356803675919657, 0.000627429186422798))
    monkeypatch.delattr(BodyFlow, "_places")
    times = [-7.344171024925524e-08, -8.380193915832079e-07, -2.7884953249485633e-05]
    flow = system.flow(state)
    far, near = flow.at([*times, 1.0]), system._kind.walked(flow._walk_given, np.array(times), 1e6)
    assert far.way == "series, torus"
    assert abs(far.q[:3] - near.states[:, 0]).max() < 1e-15
    assert abs(far.p[:3] - near.states[:, 1]).max() < 1e-12


START = (0.48, 0.6, 0.64), (0.384, 1.28, -1.488)
PEAKED = (
    (0.24437093291914905, -0.9694903662316473, -0.019268547642493635),
    (6.24834368864047e-05, 0.00021247112808618054, -0.009897973607382636),
)
HALF_PEAKED = (
    (0.8300975043001154, -0.49018440344848624, 0.2658145668893481),
    (68939.89971874331, 81210.17395086645, -65530.18608053496),
)


@pytest.mark.thinned(2)
@compiled
@pytest.mark.parametrize(
    ("moments", "start"),
    [
        ((1.0, 2.0, 3e9), START),
        ((1e-5, 2e-3, 40.0), START),
        ((5e-4, 7e-7, 1e-3), START),
        pytest.param((305770.3550398829, 1.170872358333604e-06, 2534.3278223786147), PEAKED, marks=pytest.mark.slow),
        pytest.param(
            (7.075894384487356e-09, 150.49825275773247, 1655.7120383823026), HALF_PEAKED, marks=pytest.mark.slow
        ),
    ],
)
def test_states_of_very_unequal_moments_are_the_nearest_floats(moments, start):
    """They were up to 1e-14 off: most modes of the clock were summed in floats, and where dt/dτ is small, τ amplifies
    their errors. The last two motions took seconds: their lifts have narrow peaks, with two and four of the eight
    points at which the witness of a torus is computed.
    """
    system = Veselova(moments)
    flow = system.flow(system.state(*start))
    pace = max(map(abs, made_torus(flow).witnesses))
    times = [0.3 * pace, 1.1 * pace, -17 * pace]
    far, right = forced(flow, "torus").at(times), forced(flow, "additions").at(times)
    assert np.abs(far.q - right.q).max() < 1.2e-16
    assert np.abs(far.p - right.p).max() < 2.3e-16 * max(1.0, np.abs(right.p).max())
