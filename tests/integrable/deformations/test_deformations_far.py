"""The deformations at any time: integrals, signs and digits at far times, compared with the group of the curves and
with integrations.

Inputs count as exact, so floats and multiprecision numbers with the same values have the same motion.
"""

from __future__ import annotations

from functools import partial
from random import Random

import numpy as np
import pytest

from integrable import Check, Hat, Tilde
from integrable.deformations.carrier import widened
from integrable.deformations.gyroscopic import Gyroscopic
from integrable.deformations.separated_flow import OvalCarrier
from integrable.phase.state import State
from integrable.series.steps import FINEST
from jacobian import MP, HyperellipticCurve, immutable
from jacobian.errors import Infeasible, NotRepresentable, PrecisionLoss
from jacobian.inexact.long_field import LongField
from jacobian.numbers.long_reals import BareReals
from tests.integrable.deformations.extrapolation import extrapolate
from tests.integrable.deformed_systems import KINDS, random_deformation

START = ((0.48, 0.6, 0.64), (0.384, 1.28, -1.488))
FAR = [1e12, -1e12, 1e8, -3e5, 0.3]


def drift(system, start, run, digits=60):
    """The largest change of H and K over the rows, relative to the effect of rounding a row's coordinates."""
    wide = MP(digits)
    over = system.over(wide)

    def integrals(gamma, M):
        gamma, M = ([wide.coerce(x) for x in v] for v in (gamma, M))
        return over.integrals(State(tuple(gamma), tuple(M)))[2:]

    # the motion is that of the start made to meet (γ, γ) = 1 and (γ, M) = 0
    exact = widened(system, start, wide)[1]
    before, worst = integrals(exact.gamma, exact.M), 0.0
    for gamma, M in zip(run.gamma.tolist(), run.M.tolist(), strict=True):
        after = integrals(gamma, M)
        sizes = [abs(x) for x in before]
        for i in range(6):
            x = [*gamma, *M]
            x[i] = wide.coerce(x[i]) * (1 + wide.coerce("1e-10"))
            moved = integrals(x[:3], x[3:])
            sizes = [s + abs(a - b) * 10**10 for s, a, b in zip(sizes, moved, after, strict=True)]
        worst = max(worst, *(float(abs(a - b) / s) for a, b, s in zip(after, before, sizes, strict=True)))
    return worst


def distance(run, other):
    """The largest difference of γ and of M, relative to |M|, row by row."""
    worst = 0.0
    for a, b in ((run.gamma, other.gamma), (run.M, other.M)):
        for x, y in zip(a, b, strict=True):
            worst = max(worst, float(max(abs(x - y)) / max(abs(y))))
    return worst


# --- what was wrong


@pytest.mark.parametrize("inertia", [(0.1, 6, 9), (1, 2, 4), (0.5, 2, 9)], ids=str)
def test_the_integrals_are_kept_at_times_at_which_they_were_lost(inertia) -> None:
    """The error of H was 6e-4 at t = 1e5, 100 % at 1e7 and 6e-6 at 1e12; the third body raised a TypeError there."""
    system = Tilde(inertia)
    start = system.state(*START)
    run = system.flow(start).at([1e3, 1e5, 1e7, 1e12])
    assert drift(system, start, run) < 1e-15


def test_forty_digits_are_forty_digits_at_1e8() -> None:
    """H and K are those of the start to the last digits; the error of K was once 3e-3."""
    field = MP(40)
    system = Tilde(("15.36", "0.107", "18.51"), field=field)
    start = system.state(("0.48", "0.6", "0.64"), ("0.384", "1.28", "-1.488"))
    run = system.flow(start).at([10**8])
    assert drift(system, start, run) < 1e-39
    again = system.over(MP(70)).flow(start).at([10**8])
    assert distance(run, again) < 1e-38


# --- random bodies


@pytest.mark.thinned(2)
@pytest.mark.parametrize("kind", KINDS)
def test_random_bodies_keep_their_integrals_at_any_time(kind) -> None:
    rng = Random(12)
    for _ in range(6):
        system, start = random_deformation(kind, rng)
        run = system.flow(start).at(FAR)
        assert run.gamma.dtype == np.float64
        assert drift(system, start, run) < 1e-15
        assert np.abs(np.einsum("ij,ij->i", run.gamma, run.gamma) - 1).max() < 4e-16


@pytest.mark.parametrize("kind", KINDS)
def test_floats_are_the_rounded_motion_of_forty_digits(kind) -> None:
    """From the same floats, signs and values of γ and M at 1e5 and 1e8 agree to one rounding."""
    rng = Random(3)
    for _ in range(3):
        system, start = random_deformation(kind, rng)
        exact = system.over(MP(40))
        # unchanged: the constraints hold to the rounding of floats
        same = State(*(tuple(map(exact.field.coerce, v)) for v in (start.gamma, start.M)))
        run, truth = system.flow(start).at([1e5, -1e8]), exact.flow(same).at([1e5, -1e8])
        assert distance(run, truth) < 1e-15


@pytest.mark.thinned(2)
@pytest.mark.parametrize("kind", KINDS)
def test_times_add_up_and_go_back(kind) -> None:
    """at(t1 + t2) is the flow of at(t1) at t2, and at(t1) goes back to the start: t1 = 1e9, over 45 digits."""
    system, start = random_deformation(kind, Random(8))
    system = system.over(MP(45))
    start = system.state(*_exactly(system.field, start))
    first = system.flow(start).at([10**9, 10**9 + 7, 10**9 - 10**4])
    middle = State(tuple(first.gamma[0]), tuple(first.M[0]))
    again = system.flow(middle).at([7, -(10**4), -(10**9)])
    for row in range(2):
        assert max(abs(again.gamma[row] - first.gamma[row + 1])) < 1e-35
        assert max(abs(again.M[row] - first.M[row + 1])) < 1e-35 * max(abs(first.M[row + 1]))
    # the effect of rounding to 45 digits after 1e9 units of time
    assert max(abs(again.gamma[2] - start.gamma)) < 1e-30
    assert max(abs(again.M[2] - start.M)) < 1e-30 * max(abs(np.array(start.M)))


def _exactly(K, state):
    gamma, M = ([K.coerce(x) for x in v] for v in (state.gamma, state.M))
    size = K.sqrt(K.dot(gamma, gamma))
    gamma = [x / size for x in gamma]
    tilt = K.dot(gamma, M)
    return gamma, [m - tilt * x for x, m in zip(gamma, M, strict=True)]


# --- oracles that know no periods


@pytest.mark.parametrize("kind", ["tilde", "tilde, d", "check", "hat"])
def test_far_states_are_multiples_in_the_group_of_the_curves(kind) -> None:
    """P_k(n) = P_k(0) + n·(P_k(1) − P_k(0)) by doubling in `jacobian`, for n = 10⁸, is the flow at time n."""
    system, start = random_deformation(kind, Random(5))
    system, count = system.over(MP(120)), 10**8
    start = system.state(*_exactly(system.field, start))
    run = system.flow(start).at_tau([1, count])
    origin, unit, far = (
        system.divisor(s) for s in (start, *(State(tuple(x), tuple(m)) for x, m in zip(run.gamma, run.M, strict=True)))
    )
    for P0, P1, Pn in zip(origin, unit, far, strict=True):
        # the curves of three states differ in their last digits
        f, fewer = P0.jacobian.curve.f, MP(100)
        group = HyperellipticCurve(fewer, list(map(fewer.coerce, f))).jacobian()
        P0, P1, Pn = (group.from_points([tuple(map(fewer.coerce, (-P.u[0], P.v[0])))]) for P in (P0, P1, Pn))
        found = P0 + count * (P1 - P0)
        for x, y in zip((*found.u, *found.v), (*Pn.u, *Pn.v), strict=True):
            assert abs(x - y) < 1e-30 * (1 + abs(y))


@pytest.mark.thinned(2)
@pytest.mark.parametrize("kind", KINDS)
def test_the_motion_far_out_is_that_of_the_equations(kind) -> None:
    """From at(10⁶) to at(10⁶ + 1/2) by an integration at 30 digits: signs, direction and, at d ≠ 0, the clock."""
    system, start = random_deformation(kind, Random(2), mild=True)
    system = system.over(MP(30))
    K = system.field
    start = system.state(*_exactly(K, start))
    run = system.flow(start).at([10**6, K.coerce("1000000.5")])
    y = extrapolate(_rates(system), [*run.gamma[0], *run.M[0]], K.coerce("0.5"), pieces=4)
    assert max(abs(a - b) for a, b in zip(y, (*run.gamma[1], *run.M[1]), strict=True)) < 1e-20 * max(abs(run.M[1]))


def _rates(system):
    def rates(y):
        rate = system.vector_field(State(tuple(y[:3]), tuple(y[3:])))
        return [*rate.gamma, *rate.M]

    return rates


# --- special positions


SPECIAL = {
    "turning point": ((0.6, 0.0, 0.8), (0.8, 0.5, -0.6)),
    "nearly a turning point": ((0.6, 1e-11, 0.8), (0.8, 0.5, -0.6)),
    "K nearly 0": ((0.48, 0.6, 0.64), None),
    "along two axes": ((0.0, 0.6, 0.8), (0.7, 0.8, -0.6)),
}


@pytest.mark.parametrize("start", SPECIAL)
@pytest.mark.parametrize("kind", ["tilde", "tilde, d", "check", "hat"])
def test_special_positions_far_out(kind, start) -> None:
    """Floats against 60 digits; half the digits of √|ũ − a_i| were lost at a turning point."""
    make = {"tilde": Tilde, "tilde, d": partial(Tilde, d=0.7), "check": Check, "hat": Hat}[kind]
    system, (gamma, M) = make((1.0, 2.0, 4.0)), SPECIAL[start]
    if M is None:
        # with (γ, AM) about 1e-6
        x, a = np.array(gamma), np.array(system.a)
        M = np.cross(x, a * x) + 1e-6 * np.cross(x, np.cross(x, a * x))
    x = np.array(gamma) / np.linalg.norm(gamma)
    state = system.state(x.tolist(), (np.array(M) - x * (x @ np.array(M))).tolist())
    exact = make((1.0, 2.0, 4.0), field=MP(60))
    same = State(*(tuple(map(exact.field.coerce, v)) for v in (state.gamma, state.M)))
    run, truth = system.flow(state).at([1e12, -2.5]), exact.flow(same).at([1e12, -2.5])
    assert distance(run, truth) < 1e-15
    assert drift(system, state, run) < 1e-15


def test_a_turning_point_has_as_many_digits_as_the_field() -> None:
    runs = []
    for digits in (60, 90):
        system = Tilde((1, 2, 4), field=MP(digits))
        # the flow normalizes γ, since (0.6, 0, 0.8) in floats is no exact unit vector
        start = State(*(tuple(map(system.field.coerce, v)) for v in ((0.6, 0.0, 0.8), (0.8, 0.5, -0.6))))
        runs.append(system.flow(start).at([1.5, 1e6]))
    assert distance(*runs) < 1e-58


def test_nearly_equal_moments_far_out() -> None:
    for inertia in ((1.0, 1 + 2.0**-40, 3.0), (1.0, 3.0, 3 + 2.0**-40)):
        for d in (0.0, 0.7):
            system = Tilde(inertia, d)
            start = system.state(*START)
            exact = system.over(MP(50))
            same = State(*(tuple(map(exact.field.coerce, v)) for v in (start.gamma, start.M)))
            run, truth = system.flow(start).at([3.0, 1e9]), exact.flow(same).at([3.0, 1e9])
            assert distance(run, truth) < 1e-15


def test_a_resonance_of_the_two_phases_is_no_small_divisor() -> None:
    """The frequencies of this motion have the ratio 2 : 1 to all digits; t(τ) is compared with a short way back."""
    field = MP(30)
    system = Tilde((1, 2, 4), "0.7", field=field)
    start = _resonant(system)
    periods = [curve.period for curve in system.flow(start)._curves.many.carrier.curves]
    assert min(abs(periods[0] / periods[1] - x) for x in (2, 0.5)) < 1e-25
    run = system.flow(start).at([10**7, 10**7 + 3])
    middle = State(tuple(run.gamma[0]), tuple(run.M[0]))
    again = system.flow(middle).at([3, -(10**7)])
    assert max(abs(again.gamma[0] - run.gamma[1])) < 1e-25
    assert max(abs(again.gamma[1] - np.array(start.gamma))) < 1e-20


def _resonant(system):
    """M turned about γ until the ratio of the periods is 2 : 1."""
    K = system.field
    gamma = [K.coerce(x) for x in ("0.48", "0.6", "0.64")]
    first = [K.coerce(x) for x in ("0.384", "1.28", "-1.488")]
    second = [gamma[i - 2] * first[i - 1] - gamma[i - 1] * first[i - 2] for i in range(3)]

    def state(angle):
        c, s = K.context.cos(angle), K.context.sin(angle)
        return system.state(gamma, [c * x + s * y for x, y in zip(first, second, strict=True)])

    def ratio(angle):
        with LongField(200) as N:
            one, two = OvalCarrier(*widened(system, state(angle), N)).curves
            return K.context.log(BareReals(200).element(K, one.period / two.period))

    wanted = K.context.log(2)
    angles = [K.coerce(k) / 50 for k in range(1, 157)]
    values = [ratio(x) for x in angles]
    wanted = next(target for target in (wanted, -wanted) if min(values) < target < max(values))
    k = next(k for k in range(len(angles)) if (values[k] - wanted) * (values[k + 1] - wanted) < 0)
    return state(K.context.findroot(lambda x: ratio(x) - wanted, (angles[k], angles[k + 1]), solver="anderson"))


@pytest.mark.thinned(4)
@pytest.mark.parametrize(
    ("inertia", "d", "gamma", "M", "times"),
    [
        # two nearly equal moments; a peaked 1/g; times far below that of the motion; moments negligible compared with d
        (
            (38.47, 0.0278, 0.0278 * (1 + 1e-13)),
            0.748,
            (0.748, 0.149, -0.647),
            (-6894.0, 3912.0, -7069.0),
            [-3.1, -8.3e8],
        ),
        ((4.695, 0.00068, 0.0155), 4.885, (-0.265, 0.964, 5e-10), (-22.88, -6.287, 2.375), [0.0759, 14124.0]),
        ((1.261, 2.813, 1.496), 59.93, (-0.236, -0.9, 0.3666), (-5.9e-122, -4e-123, -4.8e-122), [8.57e-4, 1e126]),
        ((2.39, 0.396, 0.432), 1.79e24, (0.9977, -0.0678, 1.4e-8), (0.0533, 0.784, -0.1117), [6.9e8, -3e18]),
    ],
)
def test_the_clock_of_extreme_bodies(inertia, d, gamma, M, times) -> None:
    """Floats against 45 digits."""
    x = np.array(gamma) / np.linalg.norm(gamma)
    system = Tilde(inertia, d)
    start = system.state(x.tolist(), (np.array(M) - x * (x @ np.array(M))).tolist())
    exact = system.over(MP(45))
    same = State(*(tuple(map(exact.field.coerce, v)) for v in (start.gamma, start.M)))
    run, truth = system.flow(start).at(times), exact.flow(same).at(times)
    assert distance(run, truth) < 1e-15
    assert drift(system, start, run, 120) < 1e-15


# --- what is looked at, and what is refused


def test_a_changed_integral_or_a_changed_sign_is_noticed() -> None:
    system = Tilde((1, 2, 4))
    with LongField(103) as field:
        motion = OvalCarrier(*widened(system, system.state(*START), field))
        good = motion.point(field.coerce(5))
        assert motion.drift([good]) + 25 <= 0
        bad = good[0], tuple(x * (1 + field.coerce(1e-20)) for x in good[1])
        assert 4 <= motion.drift([bad]) + 25 <= 6


@pytest.mark.parametrize("spoiled", ["integrals", "signs"])
def test_what_is_wrong_at_any_precision_is_refused(monkeypatch, spoiled) -> None:
    """A motion that loses H, and one whose signs differ between precisions, which H and K cannot detect."""
    right, precisions = OvalCarrier.point, []

    def wrong(self, tau):
        gamma, M = right(self, tau)
        if abs(tau) < 1:
            # the start and the rates there are compared too
            return gamma, M
        if spoiled == "integrals":
            return gamma, tuple(x * 1.5 for x in M)
        if self.field.bits not in precisions:
            precisions.append(self.field.bits)
        sign = 1 if precisions.index(self.field.bits) % 2 else -1
        return (sign * gamma[0], *gamma[1:]), (M[0], sign * M[1], sign * M[2])

    monkeypatch.setattr(OvalCarrier, "point", wrong)
    system = Tilde((1, 2, 4))
    with pytest.raises(PrecisionLoss, match="digits"):
        system.flow(system.state(*START)).at([1e4])


def test_times_that_no_digits_reach_are_refused_by_name() -> None:
    system = Tilde((1, 2, 4), 0.7)
    flow = system.flow(system.state(*START))
    with pytest.raises(PrecisionLoss, match=r"series of \d+ × \d+ modes"):
        flow.at([1e300])
    assert drift(system, flow.state, flow.at_tau([1e300])) < 1e-15
    free = Tilde((1, 2, 4), field=MP(30))
    with pytest.raises(PrecisionLoss, match="loses more than"):
        free.flow(free.state(("0.48", "0.6", "0.64"), ("0.384", "1.28", "-1.488"))).at(["1e900"])


@pytest.mark.thinned(3)
@pytest.mark.parametrize(
    "system",
    [
        Tilde((1, 2, 4), 0.7, potential=(0.1, 0.05, 0.02, 0.04, 0.06)),
        Gyroscopic((1, 2, 4), 1.0),
        Tilde((1, 1, 4)),
    ],
    ids=repr,
)
def test_integrations_that_would_take_minutes_are_refused_by_name(system, monkeypatch) -> None:
    """The finest steps, which take as long to compile as the others together, are not compiled for a refusal."""
    monkeypatch.setattr(immutable, "_MADE", {})
    motion = system.motion_through(system.state(*START))
    assert motion.method == "integrated"
    for time in (1e12, -1e5):
        with pytest.raises(Infeasible, match=r"times: the equations of motion are integrated, and t = \S+ takes"):
            motion.at([time])
    (kind,) = immutable._MADE.values()
    assert kind is not None
    assert FINEST.orders not in kind._walks


def test_an_integration_that_loses_the_integrals_is_refused(monkeypatch) -> None:
    from integrable.deformations import integrated

    right = integrated.integrate
    monkeypatch.setattr(integrated, "integrate", lambda *a: [[x * (1 + 1e-12) for x in row] for row in right(*a)])
    system = Gyroscopic((1, 2, 4), 1, field=MP(20))
    with pytest.raises(PrecisionLoss, match="H and K"):
        system.motion_through(system.state(*(tuple(map(str, x)) for x in START))).at([0.1])


def test_steps_on_the_curves_keep_the_integrals_too() -> None:
    """Two hundred small translations on the curves keep the integrals as well as the flow does."""
    system = Tilde((1, 2, 4))
    start = system.state(*START)
    with LongField(130) as field:
        lambdas = [float(x) for x in OvalCarrier(*widened(system, start, field)).lambdas]
    # Z above every e: beyond a_max for λ1 > 0, below 0 for λ2 < 0
    points = [5.0 if value > 0 else -5.0 for value in lambdas]
    image = system.translation(points, multiple=200)(start)
    one = State(image.gamma, image.M)

    class Row:
        gamma, M = np.array([one.gamma]), np.array([one.M])

    assert drift(system, start, Row) < 1e-15


def test_equal_moments_are_still_refused() -> None:
    with pytest.raises(NotRepresentable, match="equal"):
        Tilde((2, 2, 1)).flow(Tilde((2, 2, 1)).state(*START))


@pytest.mark.thinned(2)
@pytest.mark.parametrize("size", [0.0, 2.0**-40, 2.0**-22, 2.0**-12])
def test_phases_nearly_in_resonance_are_no_small_divisors(size) -> None:
    """M turned by ``size`` from a resonance of 2 : 1, floats at 10³ and 10⁷ against 30 digits there and back."""
    field = MP(30)
    exact = _resonant(Tilde((1, 2, 4), "0.7", field=field))
    gamma, M = (np.array([float(x) for x in v]) for v in (exact.gamma, exact.M))
    M = M + size * np.cross(gamma, M)
    system = Tilde((1, 2, 4), 0.7)
    state = system.state(gamma.tolist(), (M - gamma * (gamma @ M) / (gamma @ gamma)).tolist())
    many = system.over(field)
    same = State(*(tuple(map(field.coerce, v)) for v in (state.gamma, state.M)))
    times = [1e3, 1e7, -1e7]
    run, truth = system.flow(state).at(times), many.flow(same).at(times)
    assert distance(run, truth) < 1e-15
    # at these times the clock in floats suffices
    assert distance(system.flow(state).at(times[:1]), many.flow(same).at(times[:1])) < 3e-16
    assert np.abs(run.tau - truth.tau.astype(float)).max() < 1e-15 * 1e7
    back = many.flow(State(tuple(truth.gamma[1]), tuple(truth.M[1]))).at([-1e7])
    assert max(abs(back.gamma[0] - np.array(same.gamma))) < 1e-15
