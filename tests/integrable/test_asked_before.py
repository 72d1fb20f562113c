"""The same request has the same states, to the last bit, whatever was computed before."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from integrable.scene.doubles import in_doubles
from integrable.scene.file import load_scene, scene_names
from jacobian.errors import Infeasible, PrecisionLoss

NEAR, BETWEEN, MANY, FAR = [7.3], [-61.0, 45.0], np.linspace(0, 5, 40), np.linspace(40, 3000, 31)
MOTIONS = [name for name in scene_names() if not load_scene(name).finite_field]


def bits(run: Any) -> Any:
    """The bits of a run, or the message of its refusal."""
    try:
        found = run()
    except (PrecisionLoss, Infeasible) as error:
        return str(error)
    return found.way, found.gamma.tolist(), found.M.tolist()


def same(name: str, digits: int, *requests: Any) -> None:
    """Makes the first request, then all, then all in another order, and each with a fresh flow, and compares."""
    system, state = in_doubles(load_scene(name)).start(digits)
    alone = [bits(lambda t=t: system.motion_through(state).at(t)) for t in requests]
    flow = system.motion_through(state)
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


@pytest.mark.parametrize("name", ["chaplygin", "euler_top", "thin_ball", "tilted_ball", "equal_moments", "tilde"])
def test_its_own_time_has_the_same_bits_whatever_was_asked_before(name: str) -> None:
    system, state = in_doubles(load_scene(name)).start(15)
    first, second = system.motion_through(state), system.motion_through(state)
    second.at(FAR)
    for ask in (lambda flow: flow.at_tau(NEAR).gamma, lambda flow: flow.physical_time(NEAR)):
        once = ask(first)
        first.at(FAR)
        assert once.tolist() == ask(first).tolist() == ask(second).tolist()
