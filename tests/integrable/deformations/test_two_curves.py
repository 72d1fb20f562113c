"""Divisors and steps of the tilde, check and hat pairs: exact over finite fields; with the flow over MP."""

from __future__ import annotations

from random import Random

import pytest

from integrable import Check, Gyroscopic, Hat, Tilde
from integrable.deformations.two_curves import TwoPoints
from integrable.phase.brackets import image_brackets
from integrable.phase.separation import lifts
from integrable.steps.step import Step
from jacobian import GF, MP, RR, poly
from jacobian.errors import ArgumentError, NotASquare, NotRepresentable, PrecisionLoss
from tests.integrable.exact_states import random_state

FIELDS = {"GF(2^61-1)": lambda: GF(2**61 - 1), "GF(7^3)": lambda: GF(7, 3, [4, 0, 6, 1])}
# moments that are squares, so that the lifts are over the field
SYSTEMS = {
    "tilde": lambda K: Tilde((1, 2, 9), field=K),
    "tilde, d": lambda K: Tilde((1, 2, 9), 1, field=K),
    "check": lambda K: Check((1, 4, 9), field=K),
    "hat": lambda K: Hat((1, 4, 9), field=K),
}
START = (("0.48", "0.6", "0.64"), ("0.384", "1.28", "-1.488"))


def every_case():
    rows = [pytest.param(s, f, id=f"{a} over {b}") for a, s in SYSTEMS.items() for b, f in FIELDS.items()]
    return pytest.mark.parametrize(("make", "field"), rows)


def cases(make, field, count, seed, of):
    """``count`` results of ``of(system, state, rng)`` that lie over the field."""
    K, rng, found = field(), Random(seed), []
    # in GF(7^3) the number 9 is a + 2, not 2: no symmetric function of the moments vanishes
    system = make(K)
    for _ in range(20000):
        try:
            found.append((system, state := random_state(system.rigid, rng), of(system, state, rng)))
        except (NotASquare, NotRepresentable, ArgumentError):
            continue
        if len(found) == count:
            return found
    raise AssertionError(f"{len(found)} defined cases only")


@every_case()
def test_a_state_and_its_two_points(make, field) -> None:
    """from_divisor(divisor(x)) is a state that shares its points, which are on Y² = 4Π(Z − μ/I_i)."""
    for system, state, back in cases(make, field, 5, 1, lambda s, x, _: s.from_divisor(s.divisor(x), like=x)):
        K, points = system.field, system.divisor(state)
        assert system.divisor(back) == points == system.divisor(system.from_divisor(points))
        shared = [(x.gamma, x.M) for x in lifts(system.body, state)]
        opposite = [(tuple(map(K.neg, g)), m) for g, m in shared] + [(g, tuple(map(K.neg, m))) for g, m in shared]
        both = [(tuple(map(K.neg, g)), tuple(map(K.neg, m))) for g, m in shared]
        assert (back.gamma, back.M) in [*shared, *opposite, *both]
        for D in points:
            f = D.jacobian.curve.f
            y = poly.evaluate(K, D.v, K.zero)
            assert K.mul(y, y) == poly.evaluate(K, f, K.neg(D.u[0]))


def step_of(system, state, rng):
    K = system.field
    step = system.translation((K.random(rng), K.random(rng)), sheets=(1, -1))
    return step, step(state)


@pytest.mark.thinned(3)
@every_case()
def test_a_step_preserves_both_integrals_and_adds_its_points(make, field) -> None:
    for system, state, (step, image) in cases(make, field, 4, 2, step_of):
        assert system.integrals(image) == system.integrals(state)
        assert system.field.is_zero(system.rigid.integrals(image).C2)
        total = TwoPoints(*(p + q for p, q in zip(system.divisor(state), step.divisor(state), strict=True)))
        assert system.divisor(image) == total


@pytest.mark.thinned(3)
@every_case()
def test_a_step_preserves_the_bracket(make, field) -> None:
    def of(system, state, rng):
        step, _ = step_of(system, state, rng)
        return image_brackets(system, step, state)

    for _, _, (brackets, target) in cases(make, field, 2, 3, of):
        assert brackets == target


class MovingPoint(Step):
    """The step whose abscissa on the first curve is the value of H."""

    def __init__(self, system, second) -> None:
        self.system, self.second = system, second

    def __call__(self, state):
        system = self.system
        return system.translation((system.integrals(state).H, self.second))(state)


@pytest.mark.thinned(3)
@every_case()
def test_a_point_that_moves_with_the_integrals_is_not_canonical(make, field) -> None:
    """The negative control: x' = H = λ1 + λ2 keeps H and K, but not the bracket."""

    def of(system, state, rng):
        step = MovingPoint(system, system.field.random(rng))
        return system.integrals(step(state)), image_brackets(system, step, state)

    for system, state, (after, (brackets, target)) in cases(make, field, 2, 5, of):
        assert after == system.integrals(state)
        assert brackets != target


def test_a_step_on_one_curve_leaves_the_other_point_and_its_inverse_leads_back() -> None:
    def of(system, state, rng):
        step = system.translation((None, system.field.random(rng)))
        return step, step(state), (-step)(step(state)), (2 * step)(state)

    for system, state, (step, image, back, double) in cases(SYSTEMS["tilde, d"], FIELDS["GF(2^61-1)"], 2, 4, of):
        assert system.divisor(image).first == system.divisor(state).first
        assert system.divisor(back) == system.divisor(state)
        assert system.divisor(double) == system.divisor(step(image))


# --- over the reals: a step on each curve with an x_k for which the image is real


REAL = {"tilde": (30, -30), "tilde, d": (None, -30), "check": (30, -30), "hat": (30, -30)}


def real_case(name, digits=30):
    K = MP(digits)
    d = ("0.1",) if name == "tilde, d" else ()
    kind = {"check": Check, "hat": Hat}.get(name, Tilde)
    system = kind((1, 2, 4), *d, field=K)
    return system, system.state(*START)


def distance(x, y):
    return max(abs(a - b) for a, b in zip((*x.gamma, *x.M), (*y.gamma, *y.M), strict=True))


@pytest.mark.parametrize("name", SYSTEMS)
def test_a_real_step(name) -> None:
    """The image's points are the sums, by the group of `jacobian`; integrals, inverse and floats."""
    system, state = real_case(name)
    step = system.translation(REAL[name], multiple=2)
    image = step(state)
    before, after = system.integrals(state), system.integrals(image)
    assert max(abs(a - b) / max(1, abs(a)) for a, b in zip(before, after, strict=True)) < 1e-25
    for p, q, r in zip(system.divisor(state), step.divisor(state), system.divisor(image), strict=True):
        total = p + q
        scale = max(map(abs, (*r.u, *r.v)))
        assert max(abs(a - b) for a, b in zip((*total.u, *total.v), (*r.u, *r.v), strict=True)) < 1e-22 * scale
    assert distance((-step)(image), state) < 1e-25
    assert distance(system.from_divisor(system.divisor(image), like=image), image) < 1e-25
    floats = type(system)(*([float(x) for x in v] if i == 0 else float(v) for i, v in enumerate(_shape(system))))
    found = floats.translation(REAL[name], multiple=2)(floats.state(*([float(x) for x in v] for v in START)))
    assert all(isinstance(x, float) for x in found.gamma)
    assert distance(found, image) < 1e-12
    assert floats.field == RR


@pytest.mark.thinned(2)
@pytest.mark.parametrize("name", SYSTEMS)
def test_a_large_multiple_of_a_real_step(name) -> None:
    """10⁶ + 1 times, which once took seconds in floats, equals the sum by `jacobian`; 1000 times equals 1000 steps."""
    system, state = real_case(name)
    step = system.translation(REAL[name], multiple=10**6 + 1)
    image = step(state)
    for p, q, r in zip(system.divisor(state), step.divisor(state), system.divisor(image), strict=True):
        total, scale = p + q, max(map(abs, (*r.u, *r.v)))
        assert max(abs(a - b) for a, b in zip((*total.u, *total.v), (*r.u, *r.v), strict=True)) < 1e-12 * scale
    assert distance((-step)(image), state) < 1e-25
    one, moved = system.translation(REAL[name]), state
    for _ in range(200):
        moved = one(moved)
    assert distance(system.translation(REAL[name], multiple=200)(state), moved) < 1e-25


def test_multiples_beyond_every_time_are_quick_or_refused_by_name() -> None:
    system, state = real_case("tilde")
    step = system.translation(REAL["tilde"], multiple=10**300)
    assert distance((-step)(step(state)), state) < 1e-25
    with pytest.raises(PrecisionLoss, match="multiple = 1"):
        system.translation(REAL["tilde"], multiple=10**5000)(state)


def _shape(system):
    return (system.rigid.inertia, system.d) if system.d else (system.rigid.inertia,)


@pytest.mark.parametrize("name", SYSTEMS)
def test_steps_commute_with_the_flow_in_its_own_time(name) -> None:
    system, state = real_case(name)
    step, tau = system.translation(REAL[name]), ["0.7"]

    def moved(x):
        run = system.flow(x).at_tau(tau)
        return system.state(run.gamma[0], run.M[0])

    assert distance(step(moved(state)), moved(step(state))) < 1e-23


def test_a_real_step_is_orbit_stable() -> None:
    """A hundred float steps keep both integrals."""
    system = Tilde((1, 2, 4))
    state = start = system.state(*([float(x) for x in v] for v in START))
    step = system.translation((30, -30))
    for _ in range(100):
        state = step(state)
    assert system.integrals(state) == pytest.approx(system.integrals(start), rel=1e-12, abs=1e-12)


# --- refusals


@pytest.mark.parametrize(
    ("use", "error", "words"),
    [
        (lambda s, x: s.translation((1, 2, 3)), ArgumentError, "two abscissas"),
        (lambda s, x: s.translation((None, None)), ArgumentError, "two abscissas"),
        (lambda s, x: s.translation((1, 2), sheets=(1, 0)), ArgumentError, "sheets"),
        (lambda s, x: s.translation((1, 2), multiple=0), ArgumentError, "multiple = 0"),
        (lambda s, x: s.translation((1, 2), multiple=0.5), ArgumentError, "multiple = 0.5"),
        (lambda s, x: s.translation((0, 0))(x), NotASquare, r"points\[0\] = 0.0: the image of a state is not real"),
        (lambda s, x: s.divisor("state"), ArgumentError, "state = 'state'"),
    ],
)
def test_refusals(use, error, words) -> None:
    system = Tilde((1, 2, 4))
    with pytest.raises(error, match=words):
        use(system, system.state(*([float(x) for x in v] for v in START)))


@pytest.mark.parametrize(
    "system",
    [
        Gyroscopic((1, 2, 4), 1.0),
        Tilde((1, 2, 4), potential=(1, 0, 0, 0, 0)),
        Hat((1, 2, 4), potential=(1, 0, 0, 0, 0)),
    ],
    ids=repr,
)
def test_systems_without_curves_say_so(system) -> None:
    state = system.state(*([float(x) for x in v] for v in START))
    for use in (
        lambda: system.divisor(state),
        lambda: system.from_divisor(None, like=state),
        lambda: system.translation((1, 2)),
    ):
        with pytest.raises(ArgumentError, match="two curves of a tilde, check or hat pair without potential"):
            use()


@pytest.mark.parametrize(
    ("system", "start", "error", "words"),
    [
        (Tilde((1, 1, 4)), START, NotRepresentable, "equal"),
        (Tilde((1, 2, 4)), (("0.6", "0.8", 0), (0, 0, 0)), ArgumentError, "at rest"),
        (Tilde((1, 2, 4)), ((1, 0, 0), (0, 1, 1)), NotRepresentable, "λ = 0"),
    ],
)
def test_states_without_two_points(system, start, error, words) -> None:
    with pytest.raises(error, match=words):
        system.divisor(system.state(*([float(x) for x in v] for v in start)))
