"""Integrators that take part in races of tests."""

import numpy as np

CALLS = []
WAITED = [0.0]


def clock():
    """Seconds of a clock that advances by a millisecond at each reading, and by the waiting of :func:`compiling`."""
    WAITED[0] += 0.001
    return WAITED[0]


def runge_kutta(problem, times, tolerance):
    """The classical Runge–Kutta method with a step that depends on the tolerance."""
    longest = 0.5 * problem.time_scale * tolerance**0.25
    y, now, rows = problem.y0, 0.0, []
    for end in times:
        count = max(1, int(np.ceil((end - now) / longest)))
        h = (end - now) / count
        for _ in range(count):
            a = problem.rhs(now, y)
            b = problem.rhs(now, y + h / 2 * a)
            c = problem.rhs(now, y + h / 2 * b)
            y = y + h / 6 * (a + 2 * b + 2 * c + problem.rhs(now, y + h * c))
        now = end
        rows.append(y)
    return np.array(rows)


def compiling(problem, times, tolerance):
    """A solver whose first call takes a while."""
    if not CALLS:
        WAITED[0] += 0.5
    CALLS.append(tolerance)
    return problem.truth(times).y


def failing(problem, times, tolerance):
    """A solver that gives up at tight tolerances, and returns NaN at slightly wider ones."""
    if tolerance < 1e-6:
        raise FloatingPointError("the step size is too small")
    return np.full((len(times), len(problem.y0)), 1.0 if tolerance > 1e-5 else np.nan)


def wrong_shape(problem, times, tolerance):
    return problem.y0


NOT_A_FUNCTION = 3
