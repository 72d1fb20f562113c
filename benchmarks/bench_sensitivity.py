"""Sensitivities beside the equations of variation, integrated by heyoka in long doubles.

Random balls (moments in 1 … 3, d in 0.2 … 3, |M| about 3) up to T = 10⁴, and one beside the separatrix. The
equations (:mod:`tests.integrable.portrait.variational`) share no formula with the package. ``gap`` is the largest
difference of an element, relative to the largest element, ``median`` that of the middle ball; ``own`` how far the
integration is off ẋ(t) = S·ẋ(0), so relative (``pip install 'jacobian-integrable[peers]'``).
"""

from __future__ import annotations

from collections import Counter
from typing import Any

import numpy as np

from integrable import ChaplyginBall
from integrable.extras import installed
from tests.integrable.portrait.variational import rates

LONG = np.longdouble
# bodies and times
CASES = ((50, 100.0), (10, 1e3), (2, 1e4))
BESIDE = ((1e-1, 15.0), (1e-3, 15.0), (1e-5, 15.0))


def run(smoke: bool) -> list[dict[str, object]]:
    """A row for each time, and for each distance from the separatrix."""
    if not installed("heyoka"):
        return []
    integrate = _integrator()
    if smoke:
        return [_row(integrate, "random", *_random(1), 1.0)]
    rows = [_row(integrate, "random", *_random(count), T) for count, T in CASES]
    for near, T in BESIDE:
        given = [[1.0, 2.0, 3.0]], [0.7], [[0.6, 0.0, 0.8]], [[0.0, 2.0, 0.3 * near]]
        rows.append(_row(integrate, f"{near:g} beside", *map(np.array, given), T))
    return rows


def _random(count: int) -> tuple[np.ndarray, ...]:
    rng = np.random.default_rng(51)
    inertia, gamma = np.sort(rng.uniform(1, 3, (50, 3)), axis=1), rng.normal(size=(50, 3))
    gamma /= np.linalg.norm(gamma, axis=1)[:, None]
    found = inertia, rng.uniform(0.2, 3, 50), gamma, 2 * rng.normal(size=(50, 3))
    return tuple(x[:count] for x in found)


def _integrator() -> Any:
    """(I, d, γ, M, T) ↦ the state (6,) and S (6, 10)."""
    import heyoka as hy

    variables = np.array(hy.make_vars(*(f"x{i}" for i in range(66))), dtype=object)
    inertia, d = np.array([[hy.par[0], hy.par[1], hy.par[2]]]), np.array([hy.par[3]])
    equations = list(zip(variables, rates(inertia, d, variables.reshape(1, 11, 6)).ravel(), strict=True))
    begin = np.tile(np.array([1, 0, 0, 0, 1, 0], dtype=LONG), 11)
    stepper = hy.taylor_adaptive(
        equations, begin, fp_type=LONG, pars=np.ones(4, dtype=LONG), compact_mode=True, time=LONG(0)
    )

    def integrate(inertia: np.ndarray, d: float, gamma: np.ndarray, M: np.ndarray, T: float) -> Any:
        table = np.vstack([np.hstack([gamma, M]), np.eye(10, 6)]).astype(LONG)
        table[1:4, :3] -= np.outer(gamma.astype(LONG), gamma)
        stepper.time = LONG(0)
        stepper.state[:], stepper.pars[:] = table.ravel(), np.array([*inertia, d], dtype=LONG)
        outcome, *_ = stepper.propagate_until(LONG(T))
        if outcome != hy.taylor_outcome.time_limit:
            raise RuntimeError(f"heyoka stopped: {outcome}")
        found = stepper.state.reshape(11, 6).copy()
        return found[0], found[1:].T

    return integrate


def _row(integrate: Any, kind: str, inertia: Any, d: Any, gamma: Any, M: Any, T: float) -> dict[str, object]:
    gaps, own, ways, largest = [], [], Counter[str](), 0.0
    for body in zip(inertia, d, gamma, M, strict=True):
        state, truth = integrate(*body, T)
        ball = ChaplyginBall(body[0], body[1])
        flow = ball.flow(ball.state(body[2], body[3], tilted=True))
        found = flow.sensitivity([T])
        size = float(abs(truth).max())
        gaps.append(float(abs(found.matrix[0] - truth).max()) / size)
        begin, end = (_moved(*np.split(x, 2), ball) for x in (np.hstack(body[2:]), state))
        own.append(float(abs(truth[:, :6] @ begin - end).max()) / size)
        ways.update([found.way])
        largest = max(largest, size)
    return {
        "balls": len(gaps), "kind": kind, "T": T, "gap": max(gaps), "median": float(np.median(gaps)), "own": max(own),
        "largest element": largest, "ways": ", ".join(f"{way} {n}" for way, n in ways.items()),
    }  # fmt: skip


def _moved(gamma: Any, M: Any, ball: ChaplyginBall) -> Any:
    """ẋ of a state, in long doubles."""
    a = 1 / (np.array(ball.inertia, dtype=LONG) + ball.d)
    n = (gamma * a * M).sum() / (np.array(ball.inertia) * a * gamma * gamma).sum()
    omega = a * (M + ball.d * n * gamma)
    return np.hstack([np.cross(gamma, omega), np.cross(M, omega)])
