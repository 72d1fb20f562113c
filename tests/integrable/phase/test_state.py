"""γ and M of a state: arrays over the reals, as in a trajectory, and tuples over exact fields."""

from __future__ import annotations

import copy
import dataclasses
import pickle
from fractions import Fraction

import numpy as np
import pytest

from integrable import ChaplyginBall
from integrable.phase.state import State
from jacobian import GF, MP, QQ, RR, ArgumentError

GAMMA, M = ("12/25", "3/5", "16/25"), ("48/125", "32/25", "-186/125")


def state_over(K) -> State:
    return ChaplyginBall((1, 2, 3), 0, field=K).state(GAMMA, M)


@pytest.mark.parametrize(("K", "kind"), [(RR, np.float64), (MP(30), object)], ids=str)
def test_real_vectors_are_those_of_a_trajectory(K, kind) -> None:
    state = state_over(K)
    run = ChaplyginBall((1, 2, 3), 0, field=K).flow(state).at([0])
    for found, row, vector in zip((state.gamma, state.M), (run.gamma[0], run.M[0]), state.vectors, strict=True):
        assert found.dtype == row.dtype == kind
        assert found.shape == row.shape == (3,)
        assert tuple(found.tolist()) == vector
        assert {type(x) for x in vector} == {type(K.one)}
        with pytest.raises(ValueError, match="read-only"):
            found[0] = found[1]
    assert float(abs(state.gamma @ state.M)) < 1e-15
    x, y, z = state.gamma
    assert (x, y, z) == tuple(map(K.coerce, GAMMA))


@pytest.mark.parametrize("K", [QQ, GF(10007)], ids=str)
def test_exact_vectors_are_tuples(K) -> None:
    state = state_over(K)
    assert (state.gamma, state.M) == state.vectors == (tuple(map(K.coerce, GAMMA)), tuple(map(K.coerce, M)))
    assert state.row == (*state.gamma, *state.M)


@pytest.mark.parametrize("K", [RR, MP(30), QQ, GF(10007)], ids=str)
def test_vectors_off_the_phase_space_are_refused(K) -> None:
    system = ChaplyginBall((1, 2, 3), 0, field=K)
    with pytest.raises(ArgumentError, match=r"gamma = .* has \(γ, γ\) = .*: γ is a unit vector"):
        system.state(("13/25", *GAMMA[1:]), M)
    with pytest.raises(ArgumentError, match=r"M = .* has \(γ, M\) = .*: this system needs \(γ, M\) = 0"):
        system.state(GAMMA, (*M[:2], "-187/125"))


@pytest.mark.parametrize("K", [RR, MP(30), QQ, GF(10007)], ids=str)
def test_a_state_is_one_value(K) -> None:
    state = state_over(K)
    others = [
        State(state.gamma, state.M),
        State(list(state.vectors[0]), list(state.vectors[1])),
        pickle.loads(pickle.dumps(state)),
    ]
    others += [copy.copy(state), copy.deepcopy(state), dataclasses.replace(state, gamma=state.gamma)]
    for other in others:
        assert (other == state) is True
        assert (other != state) is False
        assert hash(other) == hash(state)
        assert {type(x) for x in other.row} == {type(K.one)}
    moved = dataclasses.replace(state, M=tuple(map(K.neg, state.M)))
    assert (moved == state) is False
    assert moved.vectors == (state.vectors[0], tuple(map(K.neg, state.vectors[1])))
    assert state != state.vectors


def test_the_repr_has_tuples() -> None:
    state = state_over(RR)
    assert repr(state) == "State(gamma=(0.48, 0.6, 0.64), M=(0.384, 1.28, -1.488), g=None, tilted=False)"
    assert repr(State((Fraction(1),) * 3, (0, 0, 0))).startswith("State(gamma=(Fraction(1, 1), ")
    with pytest.raises(AttributeError, match="immutable"):
        state.gamma = state.M
