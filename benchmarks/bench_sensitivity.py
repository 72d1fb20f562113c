"""Sensitivities compared with the variational equations, integrated by heyoka.

Random balls (moments in 1 … 3, d in 0.2 … 3, |M| about 3) up to T = 10⁶, and one near the separatrix. The equations
(:mod:`tests.integrable.portrait.variational`) share no formula with the package. Up to moderate times they are
integrated as a whole, in long doubles. For longer times they are integrated in doubles over stretches of two units of
time, from the package's states, and the matrices S of derivatives are multiplied. After each stretch S is corrected to
satisfy the derivatives of the four integrals, since rounding errors there would grow with the square of time.

``jump`` is the largest difference of heyoka's state at the end of a stretch from the package's. ``gap`` is the largest
difference of an element, relative to the largest element, and ``median`` its median over the balls. ``own`` is the
relative residual of ẋ(t) = S·ẋ(0) in the integration (``pip install 'jacobian-integrable[peers]'``).
"""

from __future__ import annotations

from collections import Counter
from typing import Any

import numpy as np

from integrable import ChaplyginBall
from integrable.extras import installed
from tests.integrable.portrait.variational import rates

LONG = np.longdouble
# pairs (number of bodies, time): integrated as a whole, and in stretches
WHOLE, CHAINED = ((50, 100.0), (10, 1e3), (2, 1e4)), ((50, 1e3), (20, 1e4), (5, 1e5), (1, 1e6))
STRETCH, LANES = 2.0, 8
BESIDE = ((1e-1, 15.0), (1e-3, 15.0), (1e-5, 15.0))


def run(smoke: bool) -> list[dict[str, object]]:
    """A row for each time, and for each distance from the separatrix."""
    if not installed("heyoka"):
        return []
    integrate, chain = _integrator(), _chain()
    if smoke:
        return [_row(way, "random", *_random(1), T) for way, T in ((integrate, 1.0), (chain, 200.0))]
    rows = [_row(integrate, "random", *_random(count), T) for count, T in WHOLE]
    rows += [_row(chain, "random, chained", *_random(count), T) for count, T in CHAINED]
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


def _equations() -> Any:
    import heyoka as hy

    variables = np.array(hy.make_vars(*(f"x{i}" for i in range(66))), dtype=object)
    inertia, d = np.array([[hy.par[0], hy.par[1], hy.par[2]]]), np.array([hy.par[3]])
    return list(zip(variables, rates(inertia, d, variables.reshape(1, 11, 6)).ravel(), strict=True))


def _integrator() -> Any:
    """A function from (flow, T) to the state, shape (6,), S, shape (6, 10), and the jump 0."""
    import heyoka as hy

    equations = _equations()
    begin = np.tile(np.array([1, 0, 0, 0, 1, 0], dtype=LONG), 11)
    stepper = hy.taylor_adaptive(
        equations, begin, fp_type=LONG, pars=np.ones(4, dtype=LONG), compact_mode=True, time=LONG(0)
    )

    def integrate(flow: Any, T: float) -> Any:
        gamma = np.array(flow.state.gamma, dtype=LONG)
        table = np.vstack([np.hstack([gamma, flow.state.M]), np.eye(10, 6)]).astype(LONG)
        table[1:4, :3] -= np.outer(gamma, gamma)
        stepper.time = LONG(0)
        stepper.state[:], stepper.pars[:] = table.ravel(), np.array([*flow.system.inertia, flow.system.d], dtype=LONG)
        outcome, *_ = stepper.propagate_until(LONG(T))
        if outcome != hy.taylor_outcome.time_limit:
            raise RuntimeError(f"heyoka stopped: {outcome}")
        found = stepper.state.reshape(11, 6).copy()
        return found[0], found[1:].T, 0.0

    return integrate


def _chain() -> Any:
    """A function from (flow, T) to the state, shape (6,), S, shape (6, 10), both by stretches, and the largest jump
    between two stretches.
    """
    import heyoka as hy

    begin = np.tile(np.array([1.0, 0, 0, 0, 1, 0]), 11)
    gradients = _gradients()
    stepper = hy.taylor_adaptive_batch(
        _equations(), np.tile(begin[:, None], (1, LANES)), pars=np.ones((4, LANES)), compact_mode=True, tol=1e-19
    )

    def stretches(flow: Any, starts: np.ndarray, length: float) -> np.ndarray:
        """The states after ``length`` from ``starts``, shape (K, 6), and their ten derivatives: shape (K, 11, 6)."""
        stepper.pars[:] = np.array([*flow.system.inertia, flow.system.d])[:, None]
        found = np.empty((len(starts), 11, 6))
        for first in range(0, len(starts), LANES):
            part = np.arange(first, first + LANES) % len(starts)
            stepper.set_time(np.zeros(LANES))
            stepper.state[:6], stepper.state[6:] = starts[part].T, np.eye(10, 6).reshape(-1, 1)
            stepper.propagate_until([length] * LANES)
            found[part] = stepper.state.T.reshape(LANES, 11, 6)
        return found

    def integrate(flow: Any, T: float) -> Any:
        count = round(T / STRETCH)
        run = flow.at(np.linspace(0, T, count + 1))
        states = np.hstack([run.gamma, run.M])
        tables = stretches(flow, states[:-1], T / count)
        by_state, by_body = gradients(flow, states)
        S = np.eye(6, 10)
        S[:3, :3] -= np.outer(states[0, :3], states[0, :3])
        kept = by_state[0] @ S + by_body[0]
        for table, F, rest in zip(tables, by_state[1:], by_body[1:], strict=True):
            S = table[1:7].T @ S
            S[:, 6:] += table[7:].T
            S -= np.linalg.pinv(F) @ (F @ S + rest - kept)
        return states[-1], S, float(abs(tables[:, 0] - states[1:]).max())

    return integrate


def _gradients() -> Any:
    """A function from a flow and states, shape (K, 6), to the derivatives of γ², (γ, M), (M, ω) and M²: by the state,
    shape (K, 4, 6), and by the ten inputs at a fixed state, shape (K, 4, 10).
    """
    import heyoka as hy

    names = np.array(hy.make_vars(*(f"y{i}" for i in range(10))), dtype=object)
    gamma, M, inertia, d = names[:3], names[3:6], names[6:9], names[9]
    a = 1.0 / (inertia + d)
    energy = (a * M * M).sum() + d * (a * gamma * M).sum() ** 2.0 / (inertia * a * gamma * gamma).sum()
    integrals = ((gamma * gamma).sum(), (gamma * M).sum(), energy, (M * M).sum())
    slopes = hy.cfunc([hy.diff(H, x) for H in integrals for x in names], vars=list(names))

    def gradients(flow: Any, states: np.ndarray) -> Any:
        body = np.broadcast_to([*flow.system.inertia, flow.system.d], (len(states), 4))
        found = slopes(np.hstack([states, body]).T.copy()).T.reshape(-1, 4, 10)
        at_rest = found.copy()
        at_rest[:, :, :6] = 0
        return found[:, :, :6], at_rest

    return gradients


def _row(integrate: Any, kind: str, inertia: Any, d: Any, gamma: Any, M: Any, T: float) -> dict[str, object]:
    gaps, own, jumps, ways, largest = [], [], [], Counter[str](), 0.0
    for body in zip(inertia, d, gamma, M, strict=True):
        ball = ChaplyginBall(body[0], body[1])
        flow = ball.flow(ball.state(body[2], body[3], tilted=True))
        state, truth, jump = integrate(flow, T)
        found = flow.sensitivity([T])
        size = float(abs(truth).max())
        gaps.append(float(abs(found.matrix[0] - truth).max()) / size)
        begin, end = (_moved(*np.split(x, 2), ball) for x in (np.hstack(body[2:]), state))
        own.append(float(abs(truth[:, :6] @ begin - end).max()) / size)
        jumps.append(jump)
        ways.update([found.way])
        largest = max(largest, size)
    return {
        "balls": len(gaps), "kind": kind, "T": T, "gap": max(gaps), "median": float(np.median(gaps)), "own": max(own),
        "jump": max(jumps), "largest element": largest, "ways": ", ".join(f"{way} {n}" for way, n in ways.items()),
    }  # fmt: skip


def _moved(gamma: Any, M: Any, ball: ChaplyginBall) -> Any:
    """The derivative ẋ of a state by time, in long doubles."""
    a = 1 / (np.array(ball.inertia, dtype=LONG) + ball.d)
    n = (gamma * a * M).sum() / (np.array(ball.inertia) * a * gamma * gamma).sum()
    omega = a * (M + ball.d * n * gamma)
    return np.hstack([np.cross(gamma, omega), np.cross(M, omega)])
