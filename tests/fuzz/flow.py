"""Fuzz of motions: states at any time of tops, balls and their relatives, and quantities computed from them.

A state is wrong if its error exceeds both 1e-13 and a hundred times the effect of one unit in the last place of every
input, γ measured absolutely and M relative to |M|. The oracle gives this effect (``floor``), from the rates of its
angles or by changing the inputs. A wrong sign is always seen, unless the floor exceeds 1/500: such states are not
judged.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from random import Random
from typing import Any

import numpy as np

from tests.fuzz import deformed, observed, steps
from tests.fuzz.case import Case, Complaint, Undecided
from tests.fuzz.closed_forms import EqualMoments, SymmetricBall, SymmetricTop
from tests.fuzz.distributions import (
    Motion,
    close_moments,
    equal_moments,
    general_moments,
    motion,
    symmetric_moments,
    times,
)
from tests.fuzz.elliptic import General
from tests.fuzz.integrated import Integrated
from tests.fuzz.run import Suite

FREE, FACTOR, HOPELESS = 1e-13, 100, 0.5
# turns up to which motions are integrated
NEAR = 10


def case_of(start: Motion, oracle: Callable[[Motion], Any], wanted: list[float]) -> Case:
    """The states of a motion at ``wanted`` times, in floats."""
    return Case(
        start.setup + "flow = system.flow(state)\n",
        f"np.hstack([(run := flow.at({wanted})).gamma, run.M])",
        lambda names: judged(names["got"], start, oracle(start), wanted),
    )


def judged(got: Any, start: Motion, oracle: Any, wanted: list[float]) -> Complaint | None:
    """Compares states with the rows of an oracle; the worst row is reported."""
    size = float(np.linalg.norm(start.M))
    if got.shape != (len(wanted), 6):
        return Complaint(f"shape {got.shape}", f"({len(wanted)}, 6)", "got.shape == expected")
    truth = oracle.rows(wanted)
    worst = worst_row(abs(got / [1, 1, 1, size, size, size] - truth).max(axis=1), truth, lambda: oracle.floor(wanted))
    if worst is None:
        return None
    if hasattr(oracle, "doubted") and (better := oracle.doubted()) is not None:
        return judged(got, start, better, wanted)
    i, error, allowed = worst
    row = (truth[i] * [1, 1, 1, size, size, size]).tolist()
    allow = f"{allowed:.1e} * np.array([1, 1, 1, {size:.17g}, {size:.17g}, {size:.17g}])"
    return Complaint(
        f"off by {error:.1e}, allowed {allowed:.1e}, at t = {wanted[i]}",
        f"np.array({row})",
        f"(abs(got[{i}] - expected) <= {allow}).all()",
    )


def worst_row(
    errors: np.ndarray, truth: np.ndarray, floor: Callable[[], np.ndarray]
) -> tuple[int, float, float] | None:
    """The row whose error exceeds the bound from ``floor`` the most, with its error and the bound; None if no row
    exceeds it. Rows of ``truth`` that are NaN are beyond the oracle. Raises Undecided where no row can be judged.
    """
    reached = ~np.isnan(truth[:, 0])
    if not reached.any():
        raise Undecided("beyond the oracle's horizon")
    suspects = reached & ~(errors <= FREE)
    if not suspects.any():
        return None
    allowed = FREE + FACTOR * floor()
    worst = suspects & ~(errors <= allowed) & (allowed < HOPELESS)
    if not worst.any():
        if not (allowed[reached] < HOPELESS).any():
            raise Undecided("one unit in the last place of the inputs decides")
        return None
    i = int(np.argmax(np.where(worst, np.nan_to_num(errors / allowed, nan=np.inf), -1)))
    return i, float(errors[i]), float(allowed[i])


# --- kinds


def symmetric_top(rng: Random) -> Case:
    start = motion(rng, symmetric_moments(rng), rolls=False, tilted=rng.random() < 0.5)
    return case_of(start, SymmetricTop, times(rng, start, 6))


def symmetric_ball(rng: Random) -> Case:
    start = motion(rng, symmetric_moments(rng), rolls=True, tilted=False)
    return case_of(start, SymmetricBall, times(rng, start, 6))


def three_equal(rng: Random) -> Case:
    start = motion(rng, equal_moments(rng), rolls=rng.random() < 0.6, tilted=rng.random() < 0.5)
    return case_of(start, EqualMoments, times(rng, start, 6))


def top(rng: Random) -> Case:
    start = motion(rng, general_moments(rng), rolls=False, tilted=rng.random() < 0.4)
    return case_of(start, General, times(rng, start, 4))


def close_top(rng: Random) -> Case:
    start = motion(rng, close_moments(rng), rolls=False, tilted=rng.random() < 0.4)
    return case_of(start, General, times(rng, start, 4))


def ball(rng: Random) -> Case:
    start = motion(rng, general_moments(rng), rolls=True, tilted=False)
    return case_of(start, Integrated, times(rng, start, 4, high=NEAR))


def close_ball(rng: Random) -> Case:
    start = motion(rng, close_moments(rng), rolls=True, tilted=rng.random() < 0.4)
    return case_of(start, Integrated, times(rng, start, 4, high=NEAR))


def tilted_ball(rng: Random) -> Case:
    moments = rng.choice((general_moments, general_moments, symmetric_moments))(rng)
    start = motion(rng, moments, rolls=True, tilted=True)
    return case_of(start, Integrated, times(rng, start, 4, high=NEAR))


def many_times(rng: Random) -> Case:
    """Enough times for the compiled torus to be used for near times too."""
    start = motion(rng, general_moments(rng), rolls=rng.random() < 0.7, tilted=rng.random() < 0.3)
    first, last = sorted(times(rng, start, 2, high=NEAR))
    made = case_of(start, Integrated, np.linspace(first, last, 600).tolist())
    call = made.call.replace(str(np.linspace(first, last, 600).tolist()), f"np.linspace({first}, {last}, 600)")
    return replace(made, call=call)


def far(rng: Random) -> Case:
    """Up to 2^40 ≈ 10^12 turns, for motions with a closed form."""
    moments, oracle, rolls, tilted = rng.choice(
        (
            (symmetric_moments, SymmetricTop, False, True),
            (symmetric_moments, SymmetricTop, False, False),
            (symmetric_moments, SymmetricBall, True, False),
            (equal_moments, EqualMoments, True, True),
            (general_moments, General, False, False),
            (general_moments, General, False, True),
            (close_moments, General, False, False),
        )
    )
    start = motion(rng, moments(rng), rolls=rolls, tilted=tilted)
    return case_of(start, oracle, times(rng, start, 3, 20, 40))


def multiprecision(rng: Random) -> Case:
    """MP(30), against closed forms in 60 digits: floats are exact inputs there."""
    moments, oracle, rolls = rng.choice(
        (
            (symmetric_moments, SymmetricTop, False),
            (equal_moments, EqualMoments, True),
            (general_moments, General, False),
        )
    )
    start = motion(rng, moments(rng), rolls=rolls, tilted=True)
    wanted = times(rng, start, 2, -10, 30)
    name = "ChaplyginBall" if start.d else "EulerTop"
    offset = f", {start.d}" if start.d else ""
    setup = (
        f"from integrable import {name}\nfrom jacobian import MP\nK = MP(30)\n"
        f"system = {name}({start.inertia}{offset}, field=K)\n"
        f"gamma = [K.coerce(x) for x in {start.gamma}]\nsize = K.sqrt(sum(x * x for x in gamma))\n"
        f"state = system.state([x / size for x in gamma], {start.M}, tilted=True)\nflow = system.flow(state)\n"
    )
    call = f"[[*x, *m] for run in [flow.at({wanted})] for x, m in zip(run.gamma.tolist(), run.M.tolist())]"
    return Case(setup, call, lambda names: _exactly(names["got"], start, oracle, wanted), limit=5)


def _exactly(got: Any, start: Motion, oracle: Any, wanted: list[float]) -> Complaint | None:
    found = oracle(start, 60)
    truth, c = found.wide_rows(wanted), found.context
    for i, (row, right) in enumerate(zip(got, truth, strict=True)):
        scales = [1] * 3 + [found.length] * 3
        error = max(abs(c.mpf(x) / s - y) for x, y, s in zip(row, right, scales, strict=True))
        allowed = float(found.floor([wanted[i]])[0]) / 2.0**-52 * 1e-30 * FACTOR + 1e-28
        if not error <= allowed:
            right = [c.nstr(y * s, 35) for y, s in zip(right, scales, strict=True)]
            bound = f"{allowed:.1e} * {float(found.length)!r}"
            return Complaint(
                f"off by {float(error):.1e}, allowed {allowed:.1e}, at t = {wanted[i]}",
                f"[K.coerce(x) for x in {right}]",
                f"max(abs(x - y) for x, y in zip(got[{i}], expected)) <= {bound}",
            )
    return None


WARM = """
import numpy as np
from integrable import ChaplyginBall, EulerTop
for system in (ChaplyginBall((1, 2, 3), 0.7), ChaplyginBall((1, 2, 2), 0.7), EulerTop((1, 2, 3)), EulerTop((1, 2, 2))):
    for state in (
        system.state((0.48, 0.6, 0.64), (0.384, 1.28, -1.488)),
        system.state((0.48, 0.6, 0.64), (1, 1.28, -1), tilted=True),
    ):
        flow = system.flow(state)
        flow.at([0.1, 10.0, 1e3]), flow.at(np.linspace(0, 100, 600)), flow.at_tau(np.linspace(0, 100, 600))
        flow.events(lambda gamma, M: gamma[:, 2], 0, 10)
        if system.d:
            flow.at([10.0, 1e3]).contact
"""
SUITE = Suite(
    "flow",
    {
        "symmetric top": symmetric_top,
        "symmetric ball": symmetric_ball,
        "three equal": three_equal,
        "top": top,
        "close top": close_top,
        "ball": ball,
        "close ball": close_ball,
        "tilted ball": tilted_ball,
        "many times": many_times,
        "far": far,
        "multiprecision": multiprecision,
        **observed.KINDS,
        **steps.KINDS,
        **deformed.KINDS,
    },
    {"symmetric top": 6, "symmetric ball": 6, "three equal": 3, "top": 4, "close top": 2, "ball": 4, "tilted ball": 3},
    {"": WARM},
)
