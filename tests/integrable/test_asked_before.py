"""The same request has the same states, to the last bit, whatever was computed before."""

from __future__ import annotations

from random import Random
from typing import Any

import numpy as np
import pytest

from integrable.scene.doubles import in_doubles
from integrable.scene.file import load_scene, scene_names
from jacobian import MP, RR
from jacobian.errors import Infeasible, PrecisionLoss
from tests.integrable.classical.rows import CASES, REAL
from tests.integrable.deformed_systems import KINDS, SYSTEMS, random_deformation

NEAR, BETWEEN, MANY, FAR = [7.3], [-61.0, 45.0], np.linspace(0, 5, 40), np.linspace(40, 3000, 31)
MOTIONS = [name for name in scene_names() if not load_scene(name).finite_field]


def bits(run: Any) -> Any:
    """The bits of a run, or the message of its refusal."""
    try:
        found = run()
    except (PrecisionLoss, Infeasible) as error:
        return str(error)
    return found.way, found.q.tolist(), found.p.tolist()


def same(name: str, digits: int, *requests: Any) -> None:
    """:func:`equal` for the motion of a scene."""
    system, state = in_doubles(load_scene(name)).start(digits)
    equal(lambda: system.motion_through(state), *requests)


def equal(made: Any, *requests: Any) -> None:
    """Makes the first request, then all, then all in another order, and each with a fresh flow, and compares."""
    alone = [bits(lambda t=t: made().at(t)) for t in requests]
    flow = made()
    for order in ([0, *range(len(requests))], [*reversed(range(len(requests)))]):
        assert [bits(lambda i=i: flow.at(requests[i])) for i in order] == [alone[i] for i in order]


@pytest.mark.thinned(3)
@pytest.mark.parametrize("name", MOTIONS)
def test_a_state_has_the_same_bits_whatever_was_asked_before(name: str) -> None:
    same(name, 15, NEAR, BETWEEN, MANY, FAR)


@pytest.mark.thinned(2)
@pytest.mark.parametrize("name", ["chaplygin", "equal_moments", "separatrix", "tilde", "neumann"])
def test_digits_are_the_same_whatever_was_asked_before(name: str) -> None:
    same(name, 30, NEAR, [-30.0, 20.0])


@pytest.mark.parametrize("digits", [15, pytest.param(30, marks=pytest.mark.slow)])
@pytest.mark.parametrize(("name", "n"), CASES)
def test_every_classical_system_has_the_same_bits_whatever_was_asked_before(name: str, n: int, digits: int) -> None:
    system, state = REAL[name](RR if digits == 15 else MP(digits), n)
    requests = (NEAR, BETWEEN, MANY, FAR) if digits == 15 else (NEAR, [-30.0, 20.0], [300.0])
    equal(lambda: system.flow(state), *requests)


@pytest.mark.parametrize("name", SYSTEMS)
def test_every_deformation_has_the_same_bits_whatever_was_asked_before(name: str) -> None:
    system = SYSTEMS[name](RR)
    state = system.state((0.48, 0.6, 0.64), (0.384, 1.28, -1.488))
    equal(lambda: system.motion_through(state), NEAR, BETWEEN, MANY, [70.0, 100.0])


@pytest.mark.thinned(2)
@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("name", KINDS)
def test_motions_on_two_curves_have_the_same_bits_whatever_was_asked_before(name: str, seed: int) -> None:
    system, state = random_deformation(name, Random(seed))
    equal(lambda: system.flow(state), NEAR, BETWEEN, MANY, FAR, [1e8])


QUESTIONS = {
    "states": lambda flow: flow.at([3.0, 77.0, 1e4]).q.tolist(),
    "portrait": lambda flow: [*map(float, (*flow.portrait.frequencies, *(flow.portrait.actions or ())))],
    "sensitivity": lambda flow: flow.sensitivity([2.0, 300.0]).matrix.tolist(),
    "section": lambda flow: flow.section(3).theta.tolist(),
    "certified states": lambda flow: flow.certify([3.0, 50.0]).p.tolist(),
}
OF_ALL = {
    **{f"{name} {n}": lambda name=name, n=n: REAL[name](RR, n) for name, n in CASES},
    **{name: lambda name=name: random_deformation(name, Random(6), mild=True) for name in KINDS},
}


@pytest.mark.thinned(3)
@pytest.mark.parametrize("name", OF_ALL)
def test_answers_of_all_kinds_are_the_same_in_any_order(name: str) -> None:
    """States, portrait, sensitivities, sections and certificates of one flow, and each of a fresh flow."""
    system, state = OF_ALL[name]()
    alone = {question: ask(system.flow(state)) for question, ask in QUESTIONS.items()}
    flow, order = system.flow(state), [*QUESTIONS]
    Random(name).shuffle(order)
    for question in (*order, *reversed(order)):
        assert QUESTIONS[question](flow) == alone[question], question


@pytest.mark.parametrize("name", ["chaplygin", "euler_top", "thin_ball", "tilted_ball", "equal_moments", "tilde"])
def test_its_own_time_has_the_same_bits_whatever_was_asked_before(name: str) -> None:
    system, state = in_doubles(load_scene(name)).start(15)
    first, second = system.motion_through(state), system.motion_through(state)
    second.at(FAR)
    for ask in (lambda flow: flow.at_tau(NEAR).gamma, lambda flow: flow.physical_time(NEAR)):
        once = ask(first)
        first.at(FAR)
        assert once.tolist() == ask(first).tolist() == ask(second).tolist()
