"""The flow in multiprecision: two precisions, three kinds of numbers, panels and cells, certificates."""

from __future__ import annotations

import re

import numpy as np
import pytest

from integrable import ChaplyginBall, EulerTop, load_scene
from integrable.laboratory.bodies import RollingBall
from integrable.motion import precise
from integrable.motion.flow import Flow
from integrable.motion.precise import BodyCarrier, PreciseFlow
from integrable.motion.precise_clock import LONG, NEAR_CELLS, ClockLimits, OneTime, PanelClock, RatePanels
from integrable.motion.swing import Swing
from integrable.moving_point import setup as setups
from integrable.moving_point.legendre import gauss_legendre, legendre_rule
from integrable.moving_point.losses import digits_of, lost_digits
from integrable.moving_point.setup import Setup
from jacobian import MP
from jacobian.errors import ArgumentError, PrecisionLoss
from jacobian.immutable import replaced
from jacobian.numbers.long_reals import BallReals, BareReals
from tests.integrable.ways import precise_of, torus_of
from tests.jacobian.numbers.mpmath_reals import MpmathReals

KINDS = (BareReals, BallReals, MpmathReals)
START = (("0.48", "0.6", "0.64"), ("0.384", "1.28", "-1.488"))


def ball(digits: int, inertia=(1, 2, 3), d="0.7", start=START, tilt=0):
    K = MP(digits)
    system = ChaplyginBall(inertia, d, field=K)
    gamma, M = ([K.coerce(x) for x in v] for v in start)
    M = [m + tilt * x for m, x in zip(M, gamma, strict=True)]
    return system, system.state(gamma, M, tilted=bool(tilt))


def largest(K, run, other) -> float:
    """The largest difference of γ and of M, in numbers of K."""
    pairs = (*zip(run.gamma.flat, other.gamma.flat, strict=True), *zip(run.M.flat, other.M.flat, strict=True))
    return max(abs(K.coerce(x) - K.coerce(y)) for x, y in pairs)


@pytest.mark.thinned(2)
@pytest.mark.parametrize("d", ["1e-8", "1e-12", "1e-20"])
def test_a_clock_that_hardly_varies_keeps_its_digits(d) -> None:
    """1/g = 1 + O(d): variations that floats cannot distinguish from rounding still need many nodes."""
    runs = []
    for digits in (30, 45):
        system, state = ball(digits, d=d)
        runs.append(system.flow(state).at([1, 100]))
    assert largest(MP(45), *runs) < 1e-28


def test_a_heavy_ball_is_told_the_time_by_its_torus() -> None:
    """d·max a → 1: branch points within 10⁻³ of each other cost digits, and τ runs a thousand times faster than t."""
    system, state = ball(20, d=1000)
    times = [1e5, 3e6]
    flow = system.flow(state)
    run = flow.at(times)
    assert precise_of(flow).many.carrier._torus
    floats = ChaplyginBall((1, 2, 3), 1000)
    rounded = floats.state(*([float(x) for x in v] for v in START))
    other = floats.flow(rounded).at(times)
    # the rounded inputs are different
    assert np.abs(run.gamma.astype(float) - other.gamma).max() < 1e-7


@pytest.mark.parametrize("tilt", [0, pytest.param(1.5, marks=pytest.mark.slow)], ids=["upright", "tilted"])
def test_two_hundred_digits_agree_with_two_hundred_and_twenty(tilt) -> None:
    runs = []
    for digits in (200, 220):
        system, state = ball(digits, tilt=tilt)
        runs.append(system.flow(state).at(["3.7", -2]))
    K = MP(220)
    # the starts themselves are rounded to 200 digits
    assert largest(K, *runs) < K.coerce(10) ** -197


@pytest.mark.slow
def test_a_thousand_digits_agree_with_a_thousand_and_twenty() -> None:
    runs = []
    for digits in (1000, 1020):
        system, state = ball(digits)
        runs.append(system.flow(state).at([10]))
    K = MP(1020)
    assert largest(K, *runs) < K.coerce(10) ** -997


def test_numbers_of_mpmath_give_the_same_digits(monkeypatch) -> None:
    system, state = ball(25)
    times = [0, "1.25", -3]
    expected = system.flow(state).at(times)
    monkeypatch.setattr(setups, "BareReals", MpmathReals)
    found = system.flow(state).at(times)
    assert largest(MP(25), expected, found) <= 4 * MP(25).eps


def test_times_on_the_torus_by_every_kind_of_numbers(monkeypatch) -> None:
    # the translation by half of one of this scene's reduced periods is infinite
    found = []
    for kind in (BareReals, MpmathReals):
        monkeypatch.setattr(setups, "BareReals", kind)
        system, state = load_scene("chaplygin").start(25)
        found.append(system.flow(state).at(["1e4"]))
    assert largest(MP(25), *found) <= 4 * MP(25).eps


def test_long_panels_agree_with_cells() -> None:
    system, state = ball(40)
    setup, other = (Setup(system.body, state.gamma, state.M) for _ in range(2))
    other.decays[1, LONG] = 0.0
    clock, slow = PanelClock(setup, 1), PanelClock(other, 1)
    for cell in (NEAR_CELLS, NEAR_CELLS + 1, NEAR_CELLS + LONG, 3 * LONG + NEAR_CELLS + 4):
        x = setup.reals.number(0.375)
        assert abs(float(clock.time(cell, x) - slow.time(cell, x))) < 1e-50
    assert clock._far
    assert not slow._far


HEAVY = ((1292470.6091623725, 0.0001674366553965903, 0.0002769791442540581), 1202231.4846889994)
HEAVY_START = (
    (0.922922072665066, 0.3379941265626881, 0.18432259274637028),
    (5.288028882373172, -13.87989158333257, -1.0260095689924893),
)


def heavy_setup(digits: int) -> Setup:
    """The set-up of a ball beyond double-double numbers: its clock needs 15,000 values of 1/g for a few turns."""
    system = ChaplyginBall(*HEAVY)
    state = system.state(*HEAVY_START)
    return Setup(system.body, state.gamma, state.M, digits=digits)


@pytest.mark.parametrize("sign", [1, -1])
def test_a_clock_of_few_digits_shows_what_one_of_many_digits_does(sign) -> None:
    setup = heavy_setup(41)
    quick, slow = PanelClock(setup, sign, ClockLimits(digits=24)), PanelClock(setup, sign)
    for cell in (0, 5, NEAR_CELLS + 2, NEAR_CELLS + 3 * LONG + 4):
        x = setup.reals.number(-0.375)
        assert abs(float(quick.time(cell, x) / slow.time(cell, x) - 1)) < 1e-23
    assert len(quick._nodes.steps) < len(slow._nodes.steps)


def test_what_floats_leave_to_more_digits_has_the_digits_of_a_slower_way() -> None:
    system = ChaplyginBall(*HEAVY)
    flow = system.flow(system.state(*HEAVY_START))
    times = [380.1479591886898, -5045549.602646869, -2516822.66596671, -93769.63370811127]
    # a short run reaches these times too
    rows, found = precise_of(flow).at(np.array(times))
    slow = PreciseFlow(system.body, flow.state, 20)
    tau, points = slow.at(times[2:])
    truth = np.array([[float(x) for x in gamma] for gamma, _ in slow.vectors(points)])
    run = flow.at(times)
    for gamma, shown in ((rows[:, :3], found), (run.gamma, run.tau)):
        assert np.abs(gamma[2:] - truth).max() < 1e-15
        assert max(abs(x / float(y) - 1) for x, y in zip(shown[2:], tau, strict=True)) < 1e-15


def test_points_on_the_way_are_those_of_a_way_of_its_own() -> None:
    setup, fresh = heavy_setup(27), heavy_setup(27)
    for steps in (1, 700, 691, 40, 700):
        assert setup.reached(-1, steps) == heavy_setup(27).reached(-1, steps)
    assert fresh.reached(-1, 691) != fresh.reached(1, 691)


def test_times_and_places_are_inverse_to_each_other() -> None:
    system, state = ball(30, inertia=(3, 1, 2))
    flow = system.flow(state)
    times = [MP(30).coerce(x) for x in ("-40", "-0.001", "0", "1e-25", "2.5", "60")]
    run = flow.at(times)
    again = flow.physical_time(run.tau)
    assert max(abs(x - y) for x, y in zip(times, again, strict=True)) < 1e-28
    assert largest(MP(30), run, flow.at_tau(run.tau)) < 1e-28


def test_the_torus_takes_over_far_away_and_agrees() -> None:
    system, state = ball(20)
    problem = system.body, state.gamma, state.M, False
    motion, stepping = (BodyCarrier(Setup(*problem)) for _ in range(2))
    stepping._torus = False
    far = [motion.scaled(5000)]
    assert motion._far(far)
    assert abs(motion.tau(far)[0] - stepping.tau(far)[0]) < 1e-26


def test_beside_a_separatrix_the_torus_waits_until_it_costs_less_than_counting_steps() -> None:
    """The cost of its tables grows near the separatrix: here they take half a second, as long as ten thousand steps."""
    system, state = ball(16, start=((0, 0, 1), ("0.01", "1", 0)))
    carrier = PreciseFlow(system.body, state, 16).carrier
    setup = carrier.setup
    assert carrier._far([1000 * setup.step_length]) is None
    assert 1000 * precise.WORK_A_STEP * setup.digits < carrier._least_work < 1 << 26
    torus = carrier._far([1e7 * setup.step_length])
    counting = carrier._clock(1)
    (tau,) = torus.tau([100 * setup.time_scale])
    with setup.reals:
        shown = counting.time(*carrier._place(setup.reals.number(tau)))
    assert abs(setup.reals.element(setup.wide, shown) / setup.time_scale - 100) < 1e-20


def test_lost_digits_are_found_and_made_up_for() -> None:
    """Near the separatrix errors grow like e^(λt): the precision is raised until 30 digits remain."""
    unstable = (("1e-20", "0", "1"), ("0", "1", "0"))
    system, state = ball(30, start=unstable)
    flow = PreciseFlow(system.body, state, 30)
    _, points = flow.at([200])
    assert flow.carrier.setup.digits > 40
    more = PreciseFlow(system.body, state, 60)
    truth = more.vectors(more.at([200])[1])[0]
    found = flow.vectors(points)[0]
    assert (
        max(abs(MP(90).coerce(x) - y) for a, b in zip(found, truth, strict=True) for x, y in zip(a, b, strict=True))
        < 1e-30
    )


@pytest.mark.parametrize("digits", [pytest.param(17, marks=pytest.mark.slow), 40])
def test_the_unstable_rotation_against_the_exact_motion(digits) -> None:
    """H1/H2 = a2 with M along the middle axis: M rests, γ turns by a2·t, and every rounding grows like e^(λt)."""
    system = ChaplyginBall((1, 2, 3), 0.7)
    state = system.state((0, 0, 1), (0, 1, 0))
    flow = PreciseFlow(system.body, state, digits)
    context = MP(digits + 10).context
    rate = 1 / (2 + context.mpf(0.7))
    for t in (-60.0, 400.0):
        gamma, M = flow.vectors(flow.at([t])[1])[0]
        expected = (-context.sin(rate * t), 0, context.cos(rate * t))
        assert max(abs(x - y) for x, y in zip(gamma, expected, strict=True)) < context.mpf(10) ** -digits
        assert max(abs(x - y) for x, y in zip(M, (0, 1, 0), strict=True)) < context.mpf(10) ** -digits


@pytest.mark.parametrize("t", [50, 100, 200])
def test_the_digits_lost_are_those_that_the_curve_foretells(t) -> None:
    """The same rotation at 100 digits and at 250: as many digits are lost as the curve predicts, or slightly fewer."""
    system = ChaplyginBall((1, 2, 3), 0.7)
    state = system.state((0, 0, 1), (0, 1, 0))
    problem = system.body, state.gamma, state.M, False
    setup, wider = (Setup(*problem, digits=digits) for digits in (100, 250))
    tau = BodyCarrier(setup).scaled(1.5 * t)
    point, truth = BodyCarrier(setup).point(tau), BodyCarrier(wider).point(tau)
    with wider.reals:
        number = wider.reals.number
        error = max(abs(number(setup.reals.element(setup.wide, x)) - y) for x, y in zip(point, truth, strict=True))
    lost = digits_of(error) + setup.wide.dps
    assert lost <= lost_digits(setup, tau) <= lost + 15


def test_an_ordinary_motion_is_not_expected_to_lose_digits() -> None:
    system, state = ball(30)
    setup = Setup(system.body, state.gamma, state.M)
    assert lost_digits(setup, 0) == 0
    assert lost_digits(setup, 10**6) < PreciseFlow.expected


def test_what_loses_too_much_is_refused_by_name(monkeypatch) -> None:
    monkeypatch.setattr(PreciseFlow, "most_lost", 5)
    system, state = ball(30, start=(("1e-20", "0", "1"), ("0", "1", "0")))
    with pytest.raises(PrecisionLoss, match="loses more than 35 digits") as refused:
        PreciseFlow(system.body, state, 30).at([200])
    enough = int(re.findall(r"at least (\d+) digits", str(refused.value))[0])
    assert 30 < enough < 200
    assert len(PreciseFlow(system.body, state, enough + 20).at([200])[1]) == 1


@pytest.mark.parametrize("digits", [15, 30])
def test_a_certificate_counts_the_digits_that_agree(digits) -> None:
    system, state = load_scene("chaplygin").start(digits)
    run = system.flow(state).certify([0, 2, -7.5])
    assert run.digits.shape == run.error.shape == (3,)
    assert (run.digits >= (12 if digits == 15 else 29)).all()
    assert (run.error.astype(float) <= 10.0**-run.digits).all()
    assert run.gamma.dtype == (float if digits == 15 else object)


@pytest.mark.parametrize("digits", [15, 30])
def test_a_certificate_of_a_tilted_ball_with_two_equal_moments_far_away(digits) -> None:
    """Correct states were refused because only one digit seemed to agree."""
    system, state = load_scene("chaplygin").start(digits)
    system = ChaplyginBall((1, 2, 2), 1, field=system.field)
    state = system.state(state.gamma, [m + g for m, g in zip(state.M, state.gamma, strict=True)], tilted=True)
    run = system.flow(state).certify([3, 1e4, -1e9])
    assert run.way == "closed form"
    assert (run.digits >= (12 if digits == 15 else 29)).all()


@pytest.mark.thinned(3)
@pytest.mark.parametrize("digits", [15, 30])
@pytest.mark.parametrize("inertia", [(1, 2, 2), (2, 2, 2)])
def test_a_certificate_of_equal_moments_shares_no_closed_form(inertia, digits, monkeypatch) -> None:
    """The motion used to be compared with the same closed form in more digits, which has the same mistakes."""
    system, state = ball(digits, inertia, tilt=0.7)
    assert (system.flow(state).certify([1e3, -1e9]).digits >= digits - 3).all()
    true = Swing.clock
    late = lambda swing, upright: (true(swing, upright)[0] * (1 + 1e-9), true(swing, upright)[1])  # noqa: E731
    monkeypatch.setattr(Swing, "clock", late)
    with pytest.raises(PrecisionLoss, match=r"agree to [56] digits, not to"):
        system.flow(state).certify([1e3])


@pytest.mark.parametrize("field", [15, 30])
def test_a_certificate_fails_where_the_run_is_wrong(field, monkeypatch) -> None:
    """A run with a delay of 10^-5 is right to five digits only."""
    system, state = load_scene("chaplygin").start(field)
    flow = system.flow(state)
    true_at = Flow.at

    def late(flow, times):
        return replaced(true_at(flow, [t + 1e-5 for t in times]), _times=true_at(flow, times).times)

    monkeypatch.setattr(Flow, "at", late)
    with pytest.raises(PrecisionLoss, match=r"times\[0\] = 1\.0.*agree to [345] digits, not to"):
        flow.certify([1.0])
    assert flow.certify([1.0], digits=3).digits[0] in (4, 5)


@pytest.mark.parametrize("digits", [0, 31, 2.5, True])
def test_a_certificate_for_digits_that_there_are_not(digits) -> None:
    system, state = ball(30)
    with pytest.raises(ArgumentError, match=r"digits = .*1 to 30 digits"):
        system.flow(state).certify([1], digits=digits)


def test_the_top_needs_no_clock() -> None:
    runs = []
    for digits in (60, 80):
        K = MP(digits)
        top = EulerTop((1, 2, 3), field=K)
        state = top.state(*([K.coerce(x) for x in v] for v in START))
        runs.append(top.flow(state).at(["0.5", 1000]))
    assert largest(MP(80), *runs) < MP(80).coerce(10) ** -57


@pytest.mark.parametrize("size", ["0.01", "1", "1000"])
def test_translations_add_up(size) -> None:
    """T(a) + T(b) = T(a + b), in half steps."""
    system, state = ball(50)
    setup = Setup(system.body, state.gamma, state.M)
    maker = setup.translations
    with setup.reals:
        a = setup.reals.number(setup.wide.coerce(size)) * maker.half_step
        b = a * 3 / 7
        for x, y in zip(maker.sum(maker.near(a), maker.near(b)), maker.near(a + b), strict=True):
            assert abs(x - y) <= 1e-70 * (1 + abs(y))


def test_a_tiny_translation_has_all_its_digits() -> None:
    """The points of T(eps) are at ±√(f0)·eps/2, to leading order."""
    system, state = ball(50)
    setup = Setup(system.body, state.gamma, state.M)
    with setup.reals:
        eps = setup.reals.number(setup.wide.coerce("1e-200"))
        u0, u1, v0, v1 = setup.translations.near(eps)[:4]
        f0, f1 = setup.translations.f[:2]
        assert abs(u0 / (-f0 * eps * eps / 4) - 1) < 1e-75
        assert abs(v1 * eps / 2 - 1) < 1e-75
        assert abs(u1) < eps
        assert abs(v0) < abs(f1)


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("count", [1, 2, 7, 40])
def test_gauss_legendre_is_exact_for_polynomials(count, kind) -> None:
    reals = kind(200)
    x, w = gauss_legendre(reals, count)
    with reals:
        assert x == sorted(x)
        for k in range(2 * count):
            integral = sum(c * a**k for c, a in zip(w, x, strict=True))
            assert abs(integral - (0 if k % 2 else reals.number(2) / (k + 1))) < 2**-180


def test_the_legendre_rule_recovers_a_polynomial() -> None:
    K = MP(40)
    x, rows = legendre_rule(K, 6)
    values = [t**5 - 2 * t for t in x]
    series = [sum(c * v for c, v in zip(row, values, strict=True)) for row in rows]
    # t⁵ = (8P₅ + 28P₃ + 27P₁)/63
    expected = [0, K.coerce(27) / 63 - 2, 0, K.coerce(28) / 63, 0, K.coerce(8) / 63]
    assert max(abs(a - b) for a, b in zip(series, expected, strict=True)) < 1e-38


@pytest.mark.parametrize(("x", "exponent"), [(1.0, 0), (0.09, -1), (1e-300, -300), (float("nan"), 10**9)])
def test_decimal_exponents(x, exponent) -> None:
    assert digits_of(x) == exponent
    assert digits_of(MP(20).coerce(10) ** -1000) in (-1000, -999)
    assert np.sign(digits_of(0)) == -1


@pytest.mark.thinned(2)
@pytest.mark.parametrize(("time", "tilt"), [("0.3", 0), ("5e-30", 0), ("-3", 1)])
def test_one_time_alone_is_that_of_the_series(time, tilt) -> None:
    system, state = ball(270, tilt=tilt)
    flow = PreciseFlow(system.body, state, 270)
    time = flow.carrier.setup.wide.coerce(time)
    (alone,) = flow.at([time])[0]
    assert not flow.carrier._clocks
    # the second request makes the series of the clock
    (again,) = flow.at([time])[0]
    assert flow.carrier._clocks
    assert abs(again - alone) <= abs(again) * flow.carrier.setup.wide.coerce(10) ** -275


def test_one_time_alone_goes_another_way_where_its_rule_does_not_resolve(monkeypatch) -> None:
    system, state = ball(270)
    truth = PreciseFlow(system.body, state, 290).at([2])[0][0]
    monkeypatch.setattr(OneTime, "_node_count", lambda panels, rate: RatePanels._node_count(panels, rate) // 4 * 2)
    flow = PreciseFlow(system.body, state, 270)
    (found,) = flow.at([2])[0]
    assert flow.carrier._clocks
    assert abs(found - truth) <= flow.carrier.setup.wide.coerce(10) ** -270


def test_a_body_of_very_different_moments_has_a_torus_and_its_clock_of_steps_too_many_values() -> None:
    """Found by fuzz: 1/g after given translations was computed by a compiled loop with different arguments, which
    raised a TypeError; later far times were refused.
    """
    ball = ChaplyginBall((8.273628774282642e-10, 2.327949170355821e-11, 0.049038183644058375), 13.772366268411727)
    state = ball.state(
        (-0.7151500585883254, -0.21478530610510715, 0.6651523629834372),
        (-0.21167872789306744, 1.314508810219763, 0.1968798876980665),
    )
    flow = ball.flow(state)
    with pytest.raises(PrecisionLoss, match="values of 1/g"):
        precise_of(flow).at(np.array([-915.4078022169451]))
    times = np.array([1e-3, -1e-2])
    assert np.abs(torus_of(flow).at(times)[0] - precise_of(flow).at(times)[0]).max() < 1e-15
    assert flow.at([-915.4078022169451]).way == "torus"


def test_a_body_of_the_laboratory_is_checked_by_itself() -> None:
    """The second computation had the principal moments rounded to the field: eleven digits seemed to be missing."""
    K = MP(30)
    tensor = [["0.4", "0.03", "0.02"], ["0.03", "0.5", "0.01"], ["0.02", "0.01", "0.45"]]
    ball = RollingBall([[K.coerce(x) for x in row] for row in tensor], 2, K.coerce("0.9"), field=K)
    motion = ball.motion([[1, 0, 0], [0, 1, 0], [0, 0, 1]], [K.coerce(x) for x in ("1.1", "0.3", "0.7")])
    assert motion.at([3]).matrices.shape == (1, 3, 3)
    carrier = precise_of(motion.flow).many.carrier
    assert carrier.setup is motion.flow.setup
    assert carrier.witnessed > 0
