"""States with (γ, M) ≠ 0: Chaplygin's transformation exactly, and the flow, steps and divisors that use it."""

from __future__ import annotations

import json
from pathlib import Path
from random import Random

import numpy as np
import pytest

from integrable import ChaplyginBall, EulerTop, load_scene
from integrable.oracles.reference import taylor
from integrable.phase.body import cross
from integrable.phase.brackets import image_brackets
from jacobian import GF, MP, QQ, NotASquare, NotRepresentable, SingularCurve
from jacobian.errors import ArgumentError
from tests.integrable.exact_states import SYSTEMS, systems, unit_vector, until_defined

SCENE = json.loads((Path(__file__).parents[2] / "data" / "trajectories.json").read_text())["scenes"]["S6"]
BALL = ChaplyginBall((1, 2, 3), 0.7)
GAMMA, M = (0.48, 0.6, 0.64), (1.104, 2.18, -0.528)


def tilted_state(system, rng):
    """A random state of any (γ, M) whose transformation is over the field."""
    K = system.field

    def attempt():
        try:
            state = system.state(unit_vector(K, rng), [K.random(rng) for _ in range(3)], tilted=True)
            system.upright(state)
        except (ZeroDivisionError, NotRepresentable):  # small fields: (γ, Aγ)d = 1, or isotropic vectors
            raise NotASquare("no such state") from None
        if K.is_zero(system.integrals(state).C2):
            raise NotASquare("upright as it is")
        return state

    return until_defined(attempt, 2000)


# --- the transformation


@systems()
def test_the_transformation_is_linear_invertible_and_upright(system) -> None:
    system, rng = system(), Random(1)
    for _ in range(10):
        state = tilted_state(system, rng)
        upright, image, change = system.upright(state)
        assert upright.state(image.gamma, image.M, image.g) == image  # |γ̃| = 1, (γ̃, M̃) = 0, the root g̃
        assert upright.a == system.a
        assert change.invert(image) == state


@systems()
def test_every_relation_of_the_transformation(system) -> None:
    """ω̃ ∥ ω with dt̃/dt = s(1 − dkn), dτ̃ = dτ, H̃1 = H1, H̃2 = dH1 − c/k, d̃ = d(1 + kc), Ĩ_i = I_i − dkc."""
    system, rng = system(), Random(2)
    K, d = system.field, system.d
    for _ in range(10):
        state = tilted_state(system, rng)
        upright, image, change = system.upright(state)
        _, c, h1, h2 = system.integrals(state)
        omega = system.omega(state)
        spin = K.dot(state.gamma, omega)
        rate = K.mul(change.s, K.sub(K.one, K.mul(K.mul(d, change.k), spin)))
        assert all(K.mul(rate, x) == y for x, y in zip(upright.omega(image), omega, strict=True))
        assert h1 == upright.integrals(image).H1
        assert K.sub(K.mul(d, h1), K.div(c, change.k)) == upright.integrals(image).H2
        turn = K.mul(change.k, c)
        assert upright.d == K.add(d, K.mul(d, turn))
        assert upright.inertia == tuple(K.sub(x, K.mul(d, turn)) for x in system.inertia)
        quadratic = K.sub(K.mul(K.mul(turn, change.k), K.mul(d, h1)), K.mul(K.sub(h2, K.mul(d, h1)), change.k))
        assert quadratic == c
        if system.body.rolls:
            assert image.g == K.div(state.g, rate)


def test_the_clock_of_a_tilted_body_is_a_function_of_the_transformed_state() -> None:
    """1/g = (α + βñ)/g̃, exactly, with α = s and β = dks²/p: dt̃/dt = s(1 − dkn), n = (γ, ω), and ω = ω̃ dt̃/dt."""
    system, rng = SYSTEMS["ball"](GF(2**61 - 1)), Random(3)
    K = system.field
    for _ in range(10):
        state = tilted_state(system, rng)
        upright, image, change = system.upright(state)
        beta = K.div(K.mul(K.mul(system.d, change.k), K.mul(change.s, change.s)), change.p)
        spin = K.dot(image.gamma, upright.omega(image))
        assert K.inv(state.g) == K.div(K.add(change.s, K.mul(beta, spin)), image.g)


def test_the_vector_field_is_mapped_to_that_of_the_other_body() -> None:
    """Over GF(p), d(γ̃, M̃)/dt̃ at the transformed state is the upright body's own rate."""
    system, rng = SYSTEMS["ball"](GF(2**61 - 1)), Random(4)
    K = system.field
    for _ in range(10):
        state = tilted_state(system, rng)
        upright, image, change = system.upright(state)
        rate = K.div(state.g, image.g)
        moved = change.apply_vectors(*(lambda v: (v.gamma, v.M))(system.vector_field(state)))
        field = upright.vector_field(image)
        assert moved == tuple(tuple(K.mul(rate, x) for x in v) for v in (field.gamma, field.M))


def test_the_top_keeps_M_and_projects_gamma() -> None:
    top = EulerTop((3, 5, 11), field=MP(30))
    K = top.field
    state = top.state(("0.48", "0.6", "0.64"), (1, 2, -1), tilted=True)
    _, image, _ = top.upright(state)
    c, h2 = top.integrals(state).C2, top.integrals(state).H2
    flat = [x - c / h2 * y for x, y in zip(state.gamma, state.M, strict=True)]
    size = K.sqrt(K.dot(flat, flat))
    assert (image.M == state.M).all()
    assert max(abs(x - y / size) for x, y in zip(image.gamma, flat, strict=True)) < 1e-29


def test_at_c_zero_the_transformation_is_the_identity() -> None:
    for system in (BALL, EulerTop((1, 2, 3))):
        state = system.state((0.6, 0.8, 0), (0, 0, 1.5), tilted=True)
        upright, image, change = system.upright(state)
        assert upright == system
        assert change.k == 0
        assert image.vectors == state.vectors


# --- refusals


def test_tilted_states_are_asked_for() -> None:
    with pytest.raises(ArgumentError, match=r"needs \(γ, M\) = 0, or tilted=True"):
        BALL.state(GAMMA, M)
    with pytest.raises(ArgumentError, match="unit"):
        BALL.state((1, 1, 0), M, tilted=True)
    from integrable.phase import coordinates

    with pytest.raises(ArgumentError, match="upright"):
        coordinates.to_pairs(BALL.body, BALL.state(GAMMA, M, tilted=True))


@pytest.mark.parametrize("system", [BALL, EulerTop((1, 2, 3)), EulerTop((3, 5, 11), field=QQ)], ids=str)
@pytest.mark.parametrize("c", [2, -3])
def test_parallel_momentum_is_refused_by_name(system, c) -> None:
    gamma = ("3/5", 0, "4/5") if system.field is QQ else (0.6, 0.0, 0.8)
    state = system.state(gamma, [c * x for x in map(system.field.coerce, gamma)], tilted=True)
    uses = [system.divisor, system.upright] if system.field is QQ else [system.divisor, system.upright, system.flow]
    for use in uses:
        with pytest.raises(NotRepresentable, match="M is parallel to gamma"):
            use(state)


def test_parallel_momentum_is_no_equilibrium() -> None:
    """At M = cγ, γ̇ = cg²γ × Aγ: γ moves like the momentum of a free top, and rests only along an axis."""
    system, rng = SYSTEMS["ball"](GF(2**61 - 1)), Random(5)
    K = system.field
    gamma = until_defined(lambda: system.state(unit_vector(K, rng), (0, 0, 0))).gamma
    state = system.state(gamma, [K.mul(3, x) for x in gamma], tilted=True)
    scale = K.mul(3, K.mul(state.g, state.g))
    turned = cross(K, gamma, tuple(K.mul(a, x) for a, x in zip(system.a, gamma, strict=True)))
    assert system.vector_field(state).gamma == tuple(K.mul(scale, x) for x in turned)
    assert any(turned)


def test_at_rest_is_refused_by_name() -> None:
    with pytest.raises(NotRepresentable, match=r"parallel.*\(γ, M\) = 0"):
        BALL.flow(BALL.state((1, 0, 0), (0, 0, 0), tilted=True))


# --- divisors and steps


@systems()
def test_steps_keep_the_four_integrals_and_come_back(system) -> None:
    system, rng = system(), Random(6)

    def attempt():
        state = tilted_state(system, rng)
        step = system.translation([system.field.random(rng), system.field.random(rng)], multiple=2)
        try:
            return state, step, step(state)
        except (NotRepresentable, SingularCurve):  # g is infinite at the image, or h1/h2 is at a branch point
            raise NotASquare("no image") from None

    for _ in range(4):
        state, step, image = until_defined(attempt, 2000)
        assert image.tilted
        assert system.state(image.gamma, image.M, image.g, tilted=True) == image
        assert system.integrals(image) == system.integrals(state)
        assert system.divisor(image) == system.divisor(state) + step.divisor(state)
        assert (-step)(image) == state
        assert system.from_divisor(system.divisor(state), like=state) == state


REAL_STEPS = {
    "conjugate pair": lambda s: s.translation([0.5j, -0.5j]),
    "beyond the branch point": lambda s: s.translation([3.8, 4.5]),
    "2-torsion": lambda s: s.torsion(),
    "double": lambda s: s.translation([0.5, 0.55], multiple=2),
}


@pytest.mark.parametrize("name", REAL_STEPS)
def test_real_steps_keep_the_integrals(name) -> None:
    state = BALL.state(GAMMA, M, tilted=True)
    step = REAL_STEPS[name](BALL)
    orbit = [state]
    for _ in range(20):
        orbit.append(step(orbit[-1]))
    for point in orbit:
        assert tuple(BALL.integrals(point)) == pytest.approx(tuple(BALL.integrals(state)), abs=1e-10)
    if name == "2-torsion":
        # two steps take γ̃ to −γ̃, and four steps (γ, M) to itself
        assert orbit[4].gamma == pytest.approx(state.gamma, abs=1e-12)
        assert pytest.approx(state.M, abs=1e-12) == orbit[4].M


def test_steps_and_the_time_of_the_flow_commute() -> None:
    state = BALL.state(GAMMA, M, tilted=True)
    step = BALL.translation([0.5j, -0.5j])
    run = BALL.flow(state, kernel="python").at_tau([1.7])
    later = BALL.state(run.gamma[0], run.M[0], tilted=True)
    one, other = step(later), BALL.flow(step(state), kernel="python").at_tau([1.7])
    assert one.gamma == pytest.approx(other.gamma[0], abs=1e-12)
    assert pytest.approx(other.M[0], abs=1e-12) == one.M


# --- the flow


@pytest.mark.parametrize("kernel", ["python", "compiled"])
def test_floats_against_the_reference(kernel) -> None:
    """Scene S6 of tests/data/trajectories.json, (γ, M) = 1.5, T = 1 … 10000."""
    state = BALL.state(GAMMA, M, tilted=True)
    times = [10000, 1, 100, 10, 1000]
    run = BALL.flow(state, kernel=kernel).at(times)
    for t, gamma, momentum in zip(times, run.gamma, run.M, strict=True):
        truth = SCENE["states"][str(t)]
        assert np.abs(gamma - np.array(truth["gamma"], dtype=float)).max() <= 1e-13 * (1 + t)
        assert np.abs(momentum - np.array(truth["M"], dtype=float)).max() <= 1e-13 * (1 + t)
    for found, expected in zip(run.integrals, BALL.integrals(state), strict=True):
        assert np.abs(found - expected).max() < 1e-12


@pytest.mark.parametrize("last", [1, pytest.param(10, marks=pytest.mark.slow)])
def test_fifty_digits_against_the_reference(last) -> None:
    K = MP(50)
    ball = ChaplyginBall(SCENE["I"], SCENE["d"], field=K)
    run = ball.flow(ball.state(SCENE["gamma0"], SCENE["M0"], tilted=True)).at([last])
    truth = SCENE["states"][str(last)]
    for found, expected in ((run.gamma[0], truth["gamma"]), (run.M[0], truth["M"])):
        assert max(abs(x - K.coerce(y)) for x, y in zip(found, expected, strict=True)) <= 1e-35


SPECIAL = {
    "top": (EulerTop((1, 2, 3)), GAMMA, M),
    "ball at d = 0": (ChaplyginBall((1, 2, 3), 0), GAMMA, M),
    "c < 0": (BALL, GAMMA, tuple(-x for x in M)),
    "c = 0, asked for as tilted": (BALL, GAMMA, (0.384, 1.28, -1.488)),
    "almost parallel": (BALL, GAMMA, (0.48, 0.6, 0.641)),
    "equal moments": (ChaplyginBall((2, 2, 3), 0.7), GAMMA, M),
    "three equal moments": (ChaplyginBall((2, 2, 2), 0.7), GAMMA, M),
    "gamma on an axis": (BALL, (0, 0, 1), (0.3, 0.4, 1.0)),
    "thin ball": (ChaplyginBall((1e-2, 1, 1.5), 1), GAMMA, M),
}


@pytest.mark.thinned(2)
@pytest.mark.parametrize("name", SPECIAL)
def test_special_bodies_and_starts_against_a_taylor_integration(name) -> None:
    system, gamma, momentum = SPECIAL[name]
    state = system.state(gamma, momentum, tilted=True)
    times = [2.0, -1.0, 0.0]
    run = system.flow(state, kernel="python").at(times)
    truth = taylor(system, state, times, digits=20)
    tolerance = 1e-11 if name in ("almost parallel", "thin ball") else 5e-13
    assert np.abs(run.gamma - truth.gamma.astype(float)).max() < tolerance
    assert np.abs(run.M - truth.M.astype(float)).max() < 4 * tolerance
    assert run.tau[0] > 0
    assert system.flow(state).at_tau(run.tau).times == pytest.approx(times, abs=1e-12)


def test_a_scene_asks_for_it(tmp_path) -> None:
    scene = load_scene("tilted_ball")
    assert scene.tilted
    run = scene.start(15)[0].flow(scene.start(15)[1]).at([10.0])
    assert np.abs(run.gamma[0] - np.array(SCENE["states"]["10"]["gamma"], dtype=float)).max() < 1e-12
    text = (Path(__file__).parents[3] / "integrable" / "scenes" / "tilted_ball.toml").read_text(encoding="utf-8")
    for old, new, words in (
        ("tilted = true", "", r"\[start\] M = .* or tilted=True"),
        ("tilted = true", "tilted = 1", r"\[start\] tilted: 1 given; true or false"),
    ):
        path = tmp_path / "ball.toml"
        path.write_text(text.replace(old, new), encoding="utf-8")
        with pytest.raises(ArgumentError, match=words):
            load_scene(path).start(15)


def test_a_field_without_the_roots_is_refused_by_name() -> None:
    top = EulerTop((1, 2, 3), field=QQ)
    with pytest.raises(NotASquare, match=r"1 \+ kc .* has no square root in QQ"):
        top.divisor(top.state(("3/5", "4/5", 0), (1, 2, 3), tilted=True))


@pytest.mark.parametrize("name", SYSTEMS)
def test_steps_are_poisson(name) -> None:
    system, rng = SYSTEMS[name](GF(2**61 - 1)), Random(8)

    def attempt():
        state = tilted_state(system, rng)
        step = system.translation([system.field.random(rng), system.field.random(rng)], multiple=2)
        return image_brackets(system, step, state)

    found, wanted = until_defined(attempt, 500)
    assert found == wanted
