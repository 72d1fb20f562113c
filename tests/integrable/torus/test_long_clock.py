"""The real torus of a motion: its periods, the clock of multiprecision on it, and motions that have none."""

from __future__ import annotations

from itertools import accumulate

import numpy as np
import pytest

from integrable import ChaplyginBall
from integrable.classical.veselova import Veselova
from integrable.motion.precise import BodyCarrier, PreciseFlow
from integrable.moving_point.elliptic_integrals import complete, oval_periods
from integrable.moving_point.setup import Setup
from integrable.oracles.reference import taylor
from integrable.torus import ovals as oval_nodes
from integrable.torus.access import BodyTorus, TorusFlow
from integrable.torus.lattice import Units, beginning, motion_row
from integrable.torus.long_clock import LongClock
from integrable.torus.loops import ReadableLoops
from integrable.torus.oval_modes import OvalTorus, modes_of_rate
from integrable.torus.series import LongSeries
from integrable.torus.theta_setup import FOUND, FREQUENCIES, IMAGINARY
from jacobian import MP, HyperellipticCurve
from jacobian.errors import PrecisionLoss
from jacobian.numbers.long_reals import BallReals
from jacobian.periods.matrix import real_periods
from tests.integrable.torus.translations import combine, directed, moved, ovals, translation
from tests.integrable.ways import torus_of

BALL = ChaplyginBall((1, 2, 3), 0.7)
START = ((0.48, 0.6, 0.64), (0.384, 1.28, -1.488))
# γ2 = 0: u1 is at a branch point, like the half periods
AT_A_BRANCH_POINT = ((0.6, 0.0, 0.8), (0.8, 0.5, -0.6))
# 1/d is next to a1
THIN = ChaplyginBall((1e-4, 1, 1.5), 1)


def clock_of(setup: Setup, after: int = 0) -> LongClock:
    """The clock of a motion to the digits of its set-up, or its oscillation to ``after`` digits only."""
    digits = after or setup.digits
    return LongClock(modes_of_rate(setup, digits, mean_digits=setup.digits), digits, setup.wide)


def setup_of(ball, gamma, M):
    return ball.flow(ball.state(gamma, M)).setup


@pytest.mark.parametrize("start", [START, AT_A_BRANCH_POINT], ids=["generic", "branch point"])
def test_the_clock_of_multiprecision_agrees_with_counting_steps(start) -> None:
    state = BALL.state(*start)
    precise = PreciseFlow(BALL.body, state, 16)
    setup = precise.carrier.setup
    for t in (-9.0, 3.0, 40.0):
        (tau,), _ = precise.at([t])
        scaled = clock_of(setup).tau([precise.carrier.scaled(t)])[0]
        assert abs(scaled / setup.time_scale - tau) < 1e-15


@pytest.mark.thinned(3)
@pytest.mark.parametrize(
    ("ball", "start", "tilted"),
    [
        (THIN, START, False),
        (BALL, ((0, 0, 1), (0.1, 1, 0)), False),
        (BALL, (START[0], (1.104, 2.18, -0.528)), True),
        (ChaplyginBall((3, 1, 2), 0.7), (START[0], (0.3, 0.2, 2.1)), True),
        (ChaplyginBall((1, 2, 3), 5), ((0, 1, 0), (0.3, 0.7, 2.1)), True),
    ],
    ids=["thin", "beside the separatrix", "tilted", "tilted, about another axis", "tilted, along an axis"],
)
def test_modes_from_both_ovals_are_those_of_the_clock_that_counts_steps(ball, start, tilted) -> None:
    """The first oval is below or above ζ, the body is upright or tilted, and at one start two σ vanish."""
    state = ball.state(*start, tilted=tilted)
    problem = (ball.body, state.gamma, state.M, tilted)
    setup = Setup(*problem, digits=18)
    counting = BodyCarrier(setup)
    counting._torus = False
    clock = clock_of(setup)
    times = [setup.wide.coerce(t) for t in ("-7.3", "0.25", "30")]
    for t, tau, again in zip(times, clock.tau(times), clock.times(counting.tau(times)), strict=True):
        assert abs(tau - counting.tau([t])[0]) < 1e-24
        assert abs(again - t) < 1e-24


@pytest.mark.parametrize("inertia", [(1, 2, 2), (2, 2, 1)])
def test_modes_of_a_tilted_ball_with_two_equal_moments_are_not_taken_for_none(inertia) -> None:
    """The term of the tilt is 0/0 there: omitting it gave wrong states at far times."""
    ball = ChaplyginBall(inertia, 1)
    state = ball.state(START[0], (1.104, 2.18, -0.528), tilted=True)
    with pytest.raises(PrecisionLoss, match="two moments of this body are equal"):
        clock_of(Setup(ball.body, state.gamma, state.M, True, digits=18))
    precise = PreciseFlow(ball.body, state, 18)
    gamma, M = precise.vectors(precise.at([400.0])[1])[0]
    run = ball.flow(state, kernel="compiled").at([400.0])
    assert run.way == "closed form"
    assert np.abs(run.gamma[0] - np.array(gamma, dtype=float)).max() < 1e-14
    assert np.abs(run.M[0] - np.array(M, dtype=float)).max() < 1e-14


@pytest.mark.parametrize("digits", [20, 45, 300])
def test_a_series_of_many_digits_leaves_to_floats_what_they_hold(digits) -> None:
    """A series whose modes decrease like those of 1/g, compared with its sum term by term in twice the digits."""
    import flint

    K, rng = MP(2 * digits), np.random.default_rng(digits)
    context = K.context
    nu, most = (K.coerce("0.618034"), K.coerce("0.3183")), 9
    fall = 10.0 ** (-(digits + 3) / most)
    sizes = {(k, m): K.coerce(fall) ** (abs(m) + 1.5 * k) for k in range(most) for m in range(-most, most + 1)}
    modes = {at: context.mpc(*rng.normal(size=2)) * size for at, size in sizes.items()}
    with BallReals(context.prec + 16) as balls:
        rows = [
            [
                flint.acb(*(balls.number(x) for x in (modes[k, m].real, modes[k, m].imag)))
                for m in range(-most, most + 1)
            ]
            for k in range(most)
        ]
    series = LongSeries(rows, nu, K, 10.0**-digits)
    angles = [(K.coerce(a), K.coerce(b)) for a, b in rng.uniform(0, 1, (4, 2)).tolist()]

    def swing(a, b) -> object:
        # together with the conjugate modes of −(k, m)
        terms = [
            (context.expjpi(2 * (k * a + m * b)) - 1) * c / (context.mpc(0, 2) * context.pi * (k * nu[0] + m * nu[1]))
            for (k, m), c in modes.items()
            if (k, m) > (0, 0)
        ]
        return 2 * sum(terms).real

    largest = max(abs(c) for c in modes.values())
    for wanted, known in ((None, digits), (10, 10)):
        for (a, b), found in zip(angles, series.at(angles, wanted), strict=True):
            assert abs(found - swing(a, b)) < 100 * largest * K.coerce(10) ** -known


@pytest.mark.parametrize(
    ("inertia", "apart"), [((1, 2, 2), 28), ((2, 2, 1), 22), pytest.param((1, 3, 1), 28, marks=pytest.mark.slow)]
)
def test_a_place_on_a_tiny_oval_is_known_or_asked_for_in_more_digits(inertia, apart) -> None:
    """At 30 digits, far states of a tilted ball with two moments 10^-28 apart were off by 10^-20, without an error."""
    K = MP(30)
    moved = [K.coerce(x) for x in inertia]
    k = next(k for k in range(3) if inertia.count(inertia[k]) == 2)
    moved[k] *= 1 + K.coerce(10) ** -apart
    ball = ChaplyginBall(tuple(moved), 1, field=K)
    state = ball.state(("0.48", "0.6", "0.64"), ("0.864", "1.88", "-0.848"), tilted=True)
    run = ball.flow(state).at([11, 10**9])
    gamma, M, _ = taylor(ball, state, [11], digits=30)
    assert max(abs(gamma[0] - run.gamma[0])) < 1e-29
    assert max(abs(M[0] - run.M[0])) < 1e-28
    if apart == 28:
        # the state with equal moments: at this time the difference has had no effect yet
        other = ChaplyginBall(inertia, 1, field=K)
        there = other.flow(other.state(state.gamma, state.M, tilted=True)).at([10**9])
        assert max(abs(there.gamma[0] - run.gamma[1])) < 1e-18


@pytest.mark.thinned(2)
@pytest.mark.parametrize("d", ["1e-10", "1e-15", "1e-20", "1e-150"])
def test_tables_of_a_light_ball_are_no_larger_than_those_of_another(d) -> None:
    """All modes but one are below the digits of the first tables, whose noise used to be taken for slow decay.

    At a hundred digits this led to thousands of columns, which were refused, and then steps to far times never ended.
    """
    K = MP(20)
    setups = [
        setup_of(ChaplyginBall((1, 2, 3), x, field=K), ("0.48", "0.6", "0.64"), ("0.384", "1.28", "-1.488"))
        for x in ("0.1", d)
    ]
    heavy, light = (modes_of_rate(setup, setup.digits) for setup in setups)
    assert len(light.rows) <= len(heavy.rows) < 30
    assert len(light.rows[0]) <= len(heavy.rows[0]) < 50


def test_a_clock_that_is_not_inverted_says_so(monkeypatch) -> None:
    clock = clock_of(setup_of(ChaplyginBall((1, 2, 3), 0.7), *START))
    monkeypatch.setattr(clock, "_eps", -1)
    with pytest.raises(PrecisionLoss, match="not inverted"):
        clock.tau([clock.wide.one])


@pytest.mark.parametrize("ball", [BALL, THIN], ids=["ball", "thin"])
def test_the_arithmetic_geometric_mean_gives_the_periods_of_quadrature(ball) -> None:
    setup = setup_of(ball, *START)
    curve = HyperellipticCurve(setup.wide, setup.problem.f)
    for found, oval in zip(ovals(setup), real_periods(curve, setup.problem.branch_points), strict=True):
        assert max(abs(x - y) for x, y in zip(found.periods, oval.periods, strict=True)) < 1e-38
        assert (found.start, found.end) == pytest.approx((oval.start, oval.end))


def test_the_period_of_a_shrunk_oval_is_a_residue() -> None:
    """At an isolated double point α1 = α2, 2∫ → 2π/√|f/(x − α)²|; nearly equal moments lead to such points."""
    setup = setup_of(ChaplyginBall((1, 1, 2), 0.7), *START)
    second = setup_of(ChaplyginBall((1, 1 + 1e-9, 2), 0.7), *START)
    K = setup.wide
    point = max(ovals(setup), key=lambda oval: -(oval.end - oval.start))
    a = point.start
    # f/(x − a)² is the product over the other roots with the leading coefficient
    rest = setup.problem.f[5]
    for e in sorted(setup.problem.branch_points, key=lambda e: abs(e - a))[2:]:
        rest *= a - e
    assert abs(point.periods[0] - 2 * K.context.pi / K.sqrt(abs(rest))) < 1e-38
    assert abs(point.periods[1] - a * point.periods[0]) < 1e-38
    near = min(ovals(second), key=lambda oval: oval.end - oval.start)
    assert float(near.periods[0]) == pytest.approx(float(point.periods[0]), rel=1e-7)


def test_half_periods_are_differences_of_branch_points() -> None:
    """T(Λ_k/2) has order two: its V' is 0, and the roots of U' are branch points."""
    setup = setup_of(BALL, *START)
    for low, high, period in ovals(setup):
        u0, u1, v0, v1 = translation(setup, [c / 2 for c in period])[:4]
        for e in (low, high):
            assert abs(u0 + u1 * e + e * e) < 1e-30
        assert max(abs(v0), abs(v1)) < 1e-30


@pytest.mark.parametrize("d", [0.7, 0], ids=["ball", "top"])
def test_a_period_leads_back_up_to_signs(d) -> None:
    """Also at d = 0, where the periods of x dx/y differ by the residue at infinity."""
    setup = setup_of(ChaplyginBall((1, 2, 3), d), *START)
    for oval in ovals(setup):
        third = translation(setup, [c / 3 for c in oval.periods])
        point = setup.problem.start
        for _ in range(3):
            point = moved(setup, third, point)
        for i in range(4):
            assert abs(point[i] - setup.problem.start[i]) < 1e-30
        for i in range(4, 10):
            assert abs(abs(point[i]) - abs(setup.problem.start[i])) < 1e-30


def test_directions_add_up() -> None:
    """T(ε, cε) about two centres compared with the general translation."""
    setup = setup_of(BALL, *START)
    K = setup.wide
    s, w = K.coerce("0.1"), K.coerce("0.07")
    both = combine(setup, directed(setup, -2, s), directed(setup, "0.25", w))
    found = translation(setup, (s + w, w / 4 - 2 * s))
    assert max(abs(x - y) for x, y in zip(both, found, strict=True)) < 1e-35


@pytest.mark.parametrize("ball", [BALL, THIN, ChaplyginBall((1, 1e4, 1e8), 1)], ids=["ball", "thin", "far apart"])
def test_the_basis_of_the_periods_is_unimodular_and_reduced(ball) -> None:
    """Compared with the periods around either oval; the flow is a sum of both periods."""
    setup = setup_of(ball, *START)
    loops, wide = ReadableLoops(setup), setup.wide
    units, motion, *_ = beginning(setup, loops)
    found = loops.room(FOUND)
    (a, b, c, d) = loops.periods(motion, loops.short, loops.room(4), found)
    assert abs(a * d - b * c) == 1
    first, second = loops.wide(found[:2], wide), loops.wide(found[2:4], wide)
    origin = setup.reals.element(wide, units.origin)
    own = [(units.time * x, units.lift * (y - origin * x)) for x, y in (oval.periods for oval in ovals(setup))]
    for (m, n), period in (((a, b), first), ((c, d), second)):
        assert max(abs(m * x + n * y - z) for x, y, z in zip(*own, period, strict=True)) < 1e-35
    nu = loops.wide(found[FREQUENCIES : FREQUENCIES + 2], wide)
    assert abs(nu[0] * first[0] + nu[1] * second[0] - 1) < 1e-35
    assert abs(nu[0] * first[1] + nu[1] * second[1] + origin / units.length) < 1e-35
    y11, y12, y22 = map(float, found[IMAGINARY : IMAGINARY + 3])
    assert 2 * abs(y12) <= y22 <= y11


@pytest.mark.parametrize(
    ("ball", "start", "tilted"),
    [
        (BALL, START, False),
        (BALL, (START[0], (1.104, 2.18, -0.528)), True),
        pytest.param(THIN, START, False, marks=pytest.mark.slow),
        pytest.param(ChaplyginBall((1, 1.01, 2), 0.7), START, False, marks=pytest.mark.slow),
    ],
    ids=["ball", "tilted", "thin", "moments nearly equal"],
)
def test_the_mean_of_the_clock_is_that_of_its_samples(ball, start, tilted) -> None:
    """A determinant of complete elliptic integrals compared with the mean over grids, which converges to it
    geometrically.
    """
    state = ball.state(*start, tilted=tilted)
    setup = Setup(ball.body, state.gamma, state.M, tilted, digits=25)
    loops = ReadableLoops(setup, setup.digits)
    torus = BodyTorus(setup, loops)
    with loops.reals:
        means = [loops.reals.element(setup.wide, torus.samples(sizes).mean()) for sizes in ((16, 16), (64, 64))]
    coarse, fine = (abs(float(mean / torus.mean - 1)) for mean in means)
    assert fine < max(coarse**2, 1e-30)
    assert fine < 1e-15


def test_the_general_complete_elliptic_integral() -> None:
    """Compared with mpmath: cel(k, p, 1, 1) = Π(1 − p | 1 − k²), cel(k, 1, 1, k²) = E, cel(k, 1, 1, 1) = K."""
    K = MP(60)
    for k, p in (("0.3", "0.2"), ("0.9", "4"), ("1e-8", "1e-6"), ("5", "0.01")):
        k, p = K.coerce(k), K.coerce(p)
        pi, near = +K.context.pi, 1e-15
        first = complete(k, p, K.one, K.one, pi, near)
        assert abs(first / K.context.ellippi(1 - p, 1 - k * k) - 1) < 1e-24
        assert abs(complete(k, K.one, K.one, k * k, pi, near) / K.context.ellipe(1 - k * k) - 1) < 1e-24
        assert abs(complete(k, K.one, K.one, K.one, pi, near) / K.context.ellipk(1 - k * k) - 1) < 1e-24


def test_ovals_that_nearly_meet_keep_the_digits_of_their_periods() -> None:
    """Two ovals that are 2^-80 apart, at two precisions."""
    K, L = MP(40), MP(80)
    for exponent in (10, 40, 80):
        rows = []
        for field in (K, L):
            out = [field.zero] * 4
            middle = field.coerce("0.5")
            ends = (field.coerce("0.3"), middle, middle + middle**exponent, field.one)
            oval_periods(ends, field.coerce("0.9"), field.one, +field.context.pi, field.eps**0.5 / 16, out)
            rows.append(out)
        assert max(abs(float(K.coerce(x) / y - 1)) for y, x in zip(*rows, strict=True)) < 1e-29


def test_the_separatrix_has_no_compact_torus_and_is_followed_while_it_pays() -> None:
    """H1/H2 = a2: at t = 400 errors have grown by e^(λt), beyond all digits of a float; more digits reach further."""
    ball = ChaplyginBall((1, 2, 3), 0.7)
    flow = ball.flow(ball.state((0, 0, 1), (0, 1, 0)))
    with pytest.raises(PrecisionLoss, match="met"):
        motion_row(flow.setup.bare, flow.setup, Units())
    run = flow.at([1.0, 400.0])
    # M rests, and γ turns about the middle axis
    assert np.abs(run.M - [0, 1, 0]).max() < 1e-15
    angle = MP(30).coerce(400) * ball.field.coerce(ball.a[1])
    assert run.gamma[1] == pytest.approx(
        [-float(MP(30).context.sin(angle)), 0, float(MP(30).context.cos(angle))], abs=1e-13
    )
    # this rotation has a closed form, but motions that tend to a rotation have none
    ball = ChaplyginBall((1, 2, 5), 1)
    flow = ball.flow(ball.state((2 / 3, -1 / 3, 2 / 3), (1, -0.5, -1.25)))
    with pytest.raises(PrecisionLoss, match=r"loses more than \d+ digits .* times nearer to 0"):
        flow.at([1e12])


@pytest.mark.parametrize(
    ("inertia", "gamma", "M"),
    [((1, 1, 2), *START), ((1, 2, 3), (0, 0, 1), (1, 0, 0)), ((1, 1 + 1e-12, 2), *START)],
    ids=["equal moments", "relative equilibrium", "nearly equal moments"],
)
def test_isolated_double_points_leave_the_torus_compact(inertia, gamma, M) -> None:
    ball = ChaplyginBall(inertia, 0.7)
    flow = ball.flow(ball.state(gamma, M), kernel="compiled")
    run = flow.at([40.0, 1e12])
    assert isinstance(torus_of(flow), TorusFlow)
    assert np.abs(run.integrals.H1 / ball.integrals(flow.state).H1 - 1).max() < 1e-14
    again = ball.flow(flow.state, kernel="python").at([40.0, 1e12])
    assert np.abs(run.gamma - again.gamma).max() < 1e-15


def test_far_times_against_the_same_motion_in_multiprecision() -> None:
    """T = 10^6 and 10^9 at 30 digits, by an independent series on the torus and by the table of counts."""
    times = [1e6, 1e9]
    found = BALL.flow(BALL.state(*START), kernel="compiled").at(times).gamma
    K = MP(30)
    ball = ChaplyginBall((1, 2, 3), 0.7, field=K)
    gamma, M = ([K.coerce(x) for x in v] for v in START)
    size = K.sqrt(K.dot(gamma, gamma))
    gamma = [x / size for x in gamma]
    tilt = K.dot(gamma, M)
    truth = ball.flow(ball.state(gamma, [m - tilt * x for m, x in zip(M, gamma, strict=True)])).at(times).gamma
    assert np.abs(found - truth.astype(float)).max() < 1e-14


@pytest.mark.slow
def test_modes_that_rounding_has_drowned_are_not_looked_for_among_more(monkeypatch) -> None:
    """Twice and four times as many modes used to be computed, for half a minute, before the same refusal.

    Powers by repeated products, whose radii double with every second one, drown them.
    """

    def chain(first, base, count):
        return list(accumulate([base] * (count - 1), lambda x, y: x * y, initial=first))

    moments = (12.488247637324774, 1.46209256319696e-10, 12.253046214624495)
    gamma = (-0.6266829347572684, 0.6372198491462872, 0.44857481331211685)
    M = (0.00010323665044658085, 0.00017293937154728905, -0.00010144072253290405)
    quick, body = Veselova(moments), Veselova(moments, field=MP(20))
    # the state of 60 digits
    true = (0.24965842677588994, -0.5606026789030146, -0.7895538653863656)
    assert np.abs(quick.flow(quick.state(gamma, M)).at(-756309.6).q[0] - true).max() < 2e-16
    # the torus of floats does without these modes
    use, flow, rows = OvalTorus.use, body.flow(body.state(gamma, M)), [0]
    monkeypatch.setattr(oval_nodes, "powers", chain)

    def noted(self, size, most_work) -> None:
        rows.append(size[0])
        use(self, size, most_work)

    monkeypatch.setattr(OvalTorus, "use", noted)
    with pytest.raises(PrecisionLoss, match=r"more than \d+ steps.* too near one for its clock"):
        flow.at(-756309.6)
    assert 100 < max(rows) < 300


@pytest.mark.slow
def test_a_far_time_needs_modes_for_its_digits_after_the_point_alone():
    """At t = 10⁴⁵ with a set-up of 90 digits, modes to 40 digits give the same τ to 1e-35: a quarter as many."""
    body = ChaplyginBall((1, 2, 3), "0.7", field=MP(90))
    state = body.state(*([body.field.coerce(str(x)) for x in v] for v in START))
    setup = Setup(body.body, state.gamma, state.M, digits=90)
    whole, short = clock_of(setup), clock_of(setup, after=40)
    assert short.frequencies == whole.frequencies
    assert abs(short.mean - whole.mean) < 1e-85
    for t in ("1e45", "-3.25e42", "5"):
        one, two = (clock.tau([setup.wide.coerce(t)])[0] for clock in (whole, short))
        assert abs(one - two) < 1e-35
    few, all_of_them = (len(modes_of_rate(setup, n).rows) ** 2 for n in (40, 90))
    assert 4 * few < all_of_them


def test_an_interrupted_far_time_leaves_the_digits_as_they_were(monkeypatch):
    """After Ctrl-C at a far time, nearer times used to be as slow as that one."""
    ball = ChaplyginBall((1, 2, 3), "0.7", field=MP(30))
    flow = ball.flow(ball.state(*([ball.field.coerce(str(x)) for x in v] for v in START)))
    before = flow.at([2]).gamma[0].tolist()
    many = flow._many
    digits = many.carrier.digits
    with monkeypatch.context() as patch:

        def interrupted(*_):
            assert many.carrier.digits > digits + 50
            raise KeyboardInterrupt

        patch.setattr(BodyCarrier, "point", interrupted)
        with pytest.raises(KeyboardInterrupt):
            flow.at([ball.field.coerce("1e80")])
    assert many.carrier.digits == digits
    assert flow.at([2]).gamma[0].tolist() == before


def test_near_times_have_the_first_digits_again_after_a_far_one():
    """After a far time they used to take ten times as long ever after. A second far time needs no second set-up."""
    ball = ChaplyginBall((1, 2, 3), "0.7", field=MP(30))
    state = ball.state(*([ball.field.coerce(str(x)) for x in v] for v in START))
    flow, alone = ball.flow(state), ball.flow(state)
    before, many = flow.at([2]).gamma[0].tolist(), flow._many
    first = many.carrier
    far = flow.at([ball.field.coerce("1e60")])
    wide = many.carrier
    assert wide.digits > first.digits + 30
    assert flow.at([2]).gamma[0].tolist() == before
    assert many.carrier is first
    for method in ("at", "at_tau"):
        run = getattr(flow, method)([ball.field.coerce("1e60"), 2])
        assert many.carrier is wide
        assert run.gamma.tolist() == getattr(alone, method)([ball.field.coerce("1e60"), 2]).gamma.tolist()
    assert far.gamma[0].tolist() == flow.at([ball.field.coerce("1e60")]).gamma[0].tolist()
