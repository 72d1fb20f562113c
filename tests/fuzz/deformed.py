"""Fuzz of the deformations: near times against their equations integrated, any time by H and K, written out here."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from random import Random
from typing import Any

import mpmath
import numpy as np

from jacobian import PrecisionLoss
from tests.fuzz import distributions as random
from tests.fuzz.case import Case, Complaint, Undecided
from tests.fuzz.distributions import Motion
from tests.fuzz.integrated import Integrated, cross, dot, times

# allowed errors of H and K of float states, relative to the sizes of their terms
KEPT = 1e-10
NAMES = {"tilde": "Tilde", "check": "Check", "hat": "Hat", "gyroscopic": "Gyroscopic"}


def system_lines(name: str, start: Motion, c: float) -> str:
    extra = f", {c}" if name == "gyroscopic" else f", {start.d}" if start.d else ""
    return (
        f"import numpy as np\nfrom integrable import {NAMES[name]}\n"
        f"system = {NAMES[name]}({start.inertia}{extra})\n"
        f"motion = system.motion_through(system.state({start.gamma}, {start.M}))\n"
    )


def near(name: str, rng: Random) -> Case:
    from tests.fuzz.flow import judged

    start, c = _start(name, rng)
    most = 2 if name == "gyroscopic" else 5
    wanted = [t / _pace(name, start) for t in random.times(rng, start, 3, -8, most)]
    return Case(
        system_lines(name, start, c),
        f"np.hstack([(run := motion.at({wanted})).gamma, run.M])",
        lambda names: judged(names["got"], start, Integrated(start, name, c), wanted),
    )


def poles(rng: Random) -> Case:
    """Repelling poles, |M| up to 10⁸: these motions never end, so nothing may be refused."""
    from tests.fuzz.flow import judged

    b = tuple(random.magnitude(rng, -8, 2) for _ in range(3))
    inertia = tuple(random.magnitude(rng, -4, 4) for _ in range(3))
    gamma = random.unit(rng)
    M = random.cross(gamma, [random.magnitude(rng, 0, 27) * x for x in random.unit(rng)])
    start = Motion(inertia, 0.0, gamma, M, False)
    wanted = [t / float(np.linalg.norm(M)) for t in random.times(rng, replace(start, M=(1.0, 0.0, 0.0)), 3, -8, 3)]
    return Case(
        "import numpy as np\nfrom integrable import Tilde\n"
        f"system = Tilde({inertia}, potential=(0, 0, *{b}))\nstate = system.state({gamma}, {M})\n",
        f"np.hstack([(run := system.flow(state).at({wanted})).gamma, run.M])",
        lambda names: judged(names["got"], start, Integrated(start, "poles", np.array(b)), wanted),
        refusals=(),
    )


def potential(name: str, rng: Random) -> Case:
    """All five terms, of either sign and some of them 0; |M| up to 10⁸, with a potential of comparable size or of size
    1.
    """
    start, _ = _start(name, rng)
    size, gamma = random.magnitude(rng, 0, 27), random.unit(rng)
    start = replace(start, gamma=gamma, M=random.cross(gamma, [size * x for x in random.unit(rng)]))
    unit = float(np.linalg.norm(start.M)) ** 2 if rng.random() < 0.5 else 1.0
    terms = [rng.choice((0.0, 1.0, 1.0, -1.0)) * random.magnitude(rng, -8, 2) * unit for _ in range(5)]
    if name == "tilde" and not start.d and rng.random() < 0.5:
        # repelling poles, whose curves are known
        terms = [0.0, 0.0, *(abs(x) or unit for x in terms[2:])]
    wanted = [t / _pace(name, start) for t in random.times(rng, start, 3, -8, 2)]
    made = f"{NAMES[name]}({start.inertia}{f', {start.d}' if start.d else ''}, potential={tuple(terms)})"
    equations = f"{'rolling ' if start.d else ''}{name} in a potential"
    return Case(
        f"import numpy as np\nfrom integrable import {NAMES[name]}\nsystem = {made}\n"
        f"state = system.state({start.gamma}, {start.M})\nfrom tests.fuzz.deformed import rows_or_end\n",
        f"rows_or_end(system.motion_through(state), {wanted})",
        lambda names: _goes_on(names["got"], start, Integrated(start, equations, np.array(terms)), wanted),
        limit=3.0,
    )


def rows_or_end(motion: Any, wanted: list[float]) -> Any:
    """The states, or the message if the motion ends before."""
    try:
        return np.hstack([(run := motion.at(wanted)).gamma, run.M])
    except PrecisionLoss as error:
        return str(error)


def _goes_on(got: Any, start: Motion, oracle: Integrated, wanted: list[float]) -> Complaint | None:
    """Compares with the oracle's states; a motion that is said to end must not continue in the oracle."""
    from tests.fuzz.flow import HOPELESS, judged

    if not isinstance(got, str):
        return judged(got, start, oracle, wanted)
    if "the motion ends" not in got:
        raise Undecided("digits are lost, as is said")
    if np.isnan(oracle.rows(wanted)).any() or not (oracle.floor(wanted) < HOPELESS / 100).all():
        raise Undecided("the motion ends")
    return Complaint(f"refused, {got}, and goes on", f"np.array({oracle.rows(wanted).tolist()})", "False")


def far(name: str, rng: Random) -> Case:
    start, c = _start(name, rng)
    wanted = [t / _pace(name, start) for t in random.times(rng, start, 3, 5, 17 if start.d else 40)]
    return Case(
        system_lines(name, start, c),
        f"np.hstack([(run := motion.at({wanted})).gamma, run.M])",
        lambda names: _kept(names["got"], name, start, wanted),
    )


def _start(name: str, rng: Random) -> tuple[Motion, float]:
    """Moments between 2^-4 and 2^4; for the tilde pair, d ≠ 0 in half of the cases."""
    inertia = tuple(random.magnitude(rng, -4, 4) for _ in range(3))
    start = random.motion(rng, inertia, rolls=False, tilted=False)
    if name == "tilde" and rng.random() < 0.5:
        start = replace(start, d=max(inertia) * random.magnitude(rng, -6, 4))
    c = random.magnitude(rng, -3, 3) * np.linalg.norm(start.M) if name == "gyroscopic" else 0.0
    return start, float(c)


def _pace(name: str, start: Motion) -> float:
    """About how many times faster the system moves than a body with these moments."""
    return 1.0 if name in ("tilde", "gyroscopic") else 1 / min(start.inertia)


def _kept(got: Any, name: str, start: Motion, wanted: list[float]) -> Complaint | None:
    first = _integrals(name, start, [*start.gamma, *start.M])
    for i, row in enumerate(got.tolist()):
        for label, (before, size), (now, other) in zip("HK", first, _integrals(name, start, row), strict=True):
            drift = float(abs(now - before) / (size + other))
            if not drift <= KEPT:
                return Complaint(
                    f"{label} is off by {drift:.1e} at t = {wanted[i]}",
                    f"system.integrals(system.state({start.gamma}, {start.M})).{label}",
                    f"abs(system.integrals(system.state(got[{i}, :3], got[{i}, 3:])).{label} - expected)"
                    f" <= {KEPT * float(size + other)}",
                )
    return None


def _integrals(name: str, start: Motion, row: list[float]) -> list[tuple[Any, Any]]:
    """H and K in 40 digits, each with the sum of the sizes of its terms."""
    w = mpmath.MPContext()
    w.dps = 40
    a, d = [1 / (w.mpf(x) + w.mpf(start.d)) for x in start.inertia], w.mpf(start.d)
    x, m = [w.mpf(y) for y in row[:3]], [w.mpf(y) for y in row[3:]]
    dual = [a[i - 2] * a[i - 1] for i in range(3)]
    s, m1, m2, xi, zeta = (
        dot(x, times(a, x)),
        dot(m, times(a, m)),
        dot(m, m),
        dot(x, times(a, m)),
        dot(x, times(dual, m)),
    )
    sigma, tau = dot(x, times(dual, x)), sum(a) - s
    if name == "tilde":
        G = 1 / (1 - d * s)
        h1 = m1 + d * G * xi * xi
        return [(m1 - s * m2 + 2 * d * G * xi * xi, m1 + s * m2 + 2 * d * G * xi * xi),
                (G * xi * xi * (m2 - d * h1), G * max(a) ** 2 * m2 * m2)]  # fmt: skip
    if name == "check":
        return [(s * m1 - s * s * m2 - 2 * xi * xi, s * m1 + s * s * m2), (xi * xi * (s * m1 - xi * xi), (s * m1) ** 2)]
    alpha, normal = sigma * sum(1 / y for y in a) - 2 * tau, cross(x, m)
    root, rest = sigma * xi + tau * zeta, dot(normal, times(a, normal))
    bound = (sigma * max(a) + tau * max(dual)) ** 2 * m2 * rest
    terms = abs(alpha) * m1, abs(sigma + alpha * tau) * m2
    return [(alpha * m1 - (sigma + alpha * tau) * m2, sum(terms)), (root * root * rest, bound)]


KINDS = {
    "tilde": partial(near, "tilde"),
    "check": partial(near, "check"),
    "hat": partial(near, "hat"),
    "gyroscopic": partial(near, "gyroscopic"),
    "poles": poles,
    "tilde in a potential": partial(potential, "tilde"),
    "check in a potential": partial(potential, "check"),
    "hat in a potential": partial(potential, "hat"),
    "far tilde": partial(far, "tilde"),
    "far check": partial(far, "check"),
    "far hat": partial(far, "hat"),
}
