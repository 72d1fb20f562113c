"""Fuzz of quantities computed from a motion: τ and physical times, attitude, the contact point, events.

Everything is compared with integrals, extrema and zeros of the oracle's states (:mod:`tests.fuzz.integrated`).
"""

from __future__ import annotations

from random import Random
from typing import Any

import numpy as np

from tests.fuzz import distributions as random
from tests.fuzz.case import Case, Complaint, Undecided
from tests.fuzz.closed_forms import EqualMoments
from tests.fuzz.distributions import Motion, equal_moments, general_moments, symmetric_moments
from tests.fuzz.integrated import Integrated

# accuracy of the oracle's integrals, relative to the integral of the absolute value
INTEGRAL = 1e-11
GAUSS = np.polynomial.legendre.leggauss(20)


def _start(rng: Random, rolls: bool) -> Motion:
    inertia = rng.choice((general_moments, general_moments, symmetric_moments))(rng)
    start = random.motion(rng, inertia, rolls=rolls, tilted=rng.random() < 0.4)
    spread = (max(inertia) + start.d) / min(inertia)
    # bodies whose turns the oracle's panels can follow
    return start if spread < 100 else _start(rng, rolls)


def integrals(start: Motion, rate: Any, times: list[float]) -> tuple[np.ndarray, np.ndarray]:
    """∫_0^t of rates of the state, shape (N, k), and bounds of their errors, by composite Gauss rules."""
    found = []
    for share in (1 / 4, 1 / 7):
        length = share * min(start.inertia) / (min(start.inertia) + start.d) / start.speed
        cuts = np.unique(np.concatenate([[0.0], times, *(np.arange(0, t, np.copysign(length, t)) for t in times)]))
        if len(cuts) > 3000:
            raise Undecided("too many panels")
        middle, half = (cuts[1:] + cuts[:-1]) / 2, np.diff(cuts) / 2
        nodes = (middle[:, None] + half[:, None] * GAUSS[0]).ravel()
        values = rate(Integrated(start).rows(nodes)).reshape(len(middle), len(GAUSS[0]), -1)
        parts = half[:, None] * np.einsum("j,ijk->ik", GAUSS[1], values)
        sums = np.concatenate([np.zeros((1, parts.shape[1])), np.cumsum(parts, axis=0)])
        place = np.searchsorted(cuts, times)
        found.append(sums[place] - sums[np.searchsorted(cuts, 0.0)])
        size = half[:, None] * np.einsum("j,ijk->ik", GAUSS[1], abs(values))
    return found[0], 3 * abs(found[0] - found[1]) + INTEGRAL * size.sum(axis=0)


def tau(rng: Random) -> Case:
    """physical_time(τ) is t, and at_tau(τ) the state there, for τ = ∫ g dt of the oracle."""
    start = _start(rng, True)
    wanted = random.times(rng, start, 3, -8, 6)
    share = np.array(start.inertia) / (np.array(start.inertia) + start.d)

    def g(rows: np.ndarray) -> np.ndarray:
        return (rows[:, :3] ** 2 @ share)[:, None] ** -0.5

    try:
        values, off = integrals(start, g, wanted)
    except Undecided:
        return tau(rng)
    given = values[:, 0].tolist()
    slowest = max(share) ** 0.5

    def judge(names: dict[str, Any]) -> Complaint | None:
        allowed = off[:, 0] * slowest + 1e-12 * abs(np.array(wanted))
        errors = abs(names["got"] - wanted)
        if (errors <= allowed).all():
            return None
        i = int(np.argmax(errors / allowed))
        return Complaint(f"t off by {errors[i]:.1e}", repr(wanted[i]), f"abs(got[{i}] - expected) <= {allowed[i]:.1e}")

    return Case(start.setup + "flow = system.flow(state)\n", f"flow.physical_time({given})", judge)


def contact(rng: Random) -> Case:
    """∫ r(ω×γ) on the axes of space along M − cγ and γ × (M − cγ), in radii."""
    start = _start(rng, True)
    wanted = random.times(rng, start, 3, -6, 6)
    size, a = np.linalg.norm(start.M), 1 / (np.array(start.inertia) + start.d)

    def rate(rows: np.ndarray) -> np.ndarray:
        gamma, M = rows[:, :3], rows[:, 3:] * size
        return _velocity(start, a, gamma, M)

    def judge(names: dict[str, Any]) -> Complaint | None:
        truth, off = integrals(start, rate, wanted)
        allowed = off + 1e-11 * abs(truth) + 1e-12
        errors = abs(names["got"] - truth)
        if (errors <= allowed).all():
            return None
        i = int(np.argmax((errors / allowed).max(axis=1)))
        return Complaint(
            f"off by {errors[i].max():.1e} at t = {wanted[i]}",
            f"np.array({truth[i].tolist()})",
            f"(abs(got[{i}] - expected) <= {allowed[i].tolist()}).all()",
        )

    return Case(start.setup + "flow = system.flow(state)\n", f"flow.at({wanted}).contact", judge)


def _velocity(start: Motion, a: np.ndarray, gamma: np.ndarray, M: np.ndarray) -> np.ndarray:
    share = np.array(start.inertia) * a
    spin = (gamma * M) @ a / (gamma**2 @ share)
    omega = a * (M + start.d * spin[:, None] * gamma)
    along = M - np.sum(gamma * M, axis=1)[:, None] * gamma
    along = along / np.linalg.norm(along, axis=1)[:, None]
    centre = np.cross(omega, gamma)
    return np.stack([np.sum(centre * along, axis=1), np.sum(centre * np.cross(gamma, along), axis=1)], axis=1)


def straight_contact(rng: Random) -> Case:
    """Three equal moments roll along a straight line."""
    start = random.motion(rng, equal_moments(rng), rolls=True, tilted=rng.random() < 0.5)
    wanted = random.times(rng, start, 3, -8, 20)
    # ω = aM + …γ and v = ω×γ, normal to M
    row = EqualMoments(start).rows([0.0])[0]
    speed = float(np.linalg.norm(np.cross(row[:3], row[3:]))) * start.speed
    velocity, slow = np.array([0.0, -speed]), 1e-13 * start.speed

    def judge(names: dict[str, Any]) -> Complaint | None:
        for i, t in enumerate(wanted):
            allowed = (1e-12 * speed + slow) * abs(t) + 1e-13
            if not (abs(names["got"][i] - velocity * t) <= allowed).all():
                truth = (velocity * t).tolist()
                return Complaint(
                    f"{names['got'][i]} at t = {t}",
                    f"np.array({truth})",
                    f"(abs(got[{i}] - expected) <= {allowed:.1e}).all()",
                )
        return None

    return Case(start.setup + "flow = system.flow(state)\n", f"flow.at({wanted}).contact", judge)


def attitude(rng: Random) -> Case:
    """The rows of the rotation along M − cγ, γ × (M − cγ) and γ; ω; and the quaternion of the same rotation."""
    start = _start(rng, rng.random() < 0.6)
    wanted = random.times(rng, start, 3, -8, 6)
    call = f"(lambda run: np.hstack([run.attitude.reshape(-1, 9), run.omega, run.quaternion]))(flow.at({wanted}))"
    return Case(
        start.setup + "flow = system.flow(state)\n", call, lambda names: _rotations(names["got"], start, wanted)
    )


def _rotations(got: np.ndarray, start: Motion, wanted: list[float]) -> Complaint | None:
    oracle, size = Integrated(start), np.linalg.norm(start.M)
    rows = oracle.rows(wanted)
    gamma, M = rows[:, :3], rows[:, 3:]
    a = 1 / (np.array(start.inertia) + start.d)
    share = np.array(start.inertia) * a
    along = M - np.sum(gamma * M, axis=1)[:, None] * gamma
    flat = np.linalg.norm(along, axis=1)
    x = along / flat[:, None]
    spin = (gamma * M) @ a / (gamma**2 @ share)
    omega = a * (M + start.d * spin[:, None] * gamma) * size
    truth = np.hstack([x, np.cross(gamma, x), gamma, omega])
    scale = np.concatenate([np.ones(9), np.full(3, max(a) * size * (1 + start.d * max(a) / min(share)))])
    allowed = (1e-12 + 300 * oracle.floor(wanted))[:, None] / flat[:, None] * scale
    if not (abs(got[:, :12] - truth) <= allowed).all():
        i = int(np.argmax((abs(got[:, :12] - truth) / allowed).max(axis=1)))
        bound = f"np.array({allowed[i].tolist()})"
        return Complaint(
            "attitude or ω", f"np.array({truth[i].tolist()})", f"(abs(got[{i}, :12] - expected) <= {bound}).all()"
        )
    for row in got:
        w, v, matrix = row[12], row[13:], row[:9].reshape(3, 3)
        turned = (w * w - v @ v) * np.eye(3) + 2 * np.outer(v, v) + 2 * w * np.cross(np.eye(3), v)
        if not (w >= 0 and abs(turned - matrix).max() < 1e-13):
            return Complaint("the quaternion turns another way", "None", "False")
    return None


def events(rng: Random) -> Case:
    """Zeros of a component, or of its difference from a value, and the oracle's sign changes on a fine grid."""
    start = _start(rng, rng.random() < 0.6)
    first, last = sorted(random.times(rng, start, 2, -1, 5))
    name, k = rng.choice((("gamma", rng.randrange(3)), ("M", rng.randrange(3))))
    column, size = (k, 1.0) if name == "gamma" else (3 + k, float(np.linalg.norm(start.M)))
    level = rng.choice((0.0, 0.0, size * (rng.random() - 0.5)))
    call = f"flow.events(lambda gamma, M: {name}[:, {k}] - {level}, {first}, {last}).times"

    def values(times: Any) -> np.ndarray:
        return Integrated(start).rows(times)[:, column] - level / size

    setup = start.setup + "flow = system.flow(state)\n"
    return Case(setup, call, lambda names: _zeros(names["got"], values, start, first, last), limit=3)


def _zeros(got: Any, values: Any, start: Motion, first: float, last: float) -> Complaint | None:
    fast = start.speed * (min(start.inertia) + start.d) / min(start.inertia)
    grid = np.linspace(first, last, int(40 * (last - first) * fast) + 100)
    if len(grid) > 60000:
        raise Undecided("too long for the oracle's grid")
    found = values(grid)
    if np.isnan(found).any():
        raise Undecided("beyond the oracle's horizon")
    turning = np.flatnonzero((np.diff(found[:-1]) * np.diff(found[1:])) <= 0) + 1
    if abs(found[[0, -1, *turning]]).min() < 1e-4:
        raise Undecided("a zero at an end, or nearly a double one")
    at = np.flatnonzero(found[:-1] * found[1:] < 0)
    if len(got) != len(at):
        return Complaint(f"{len(got)} zeros for {len(at)}", f"{len(at)}", "len(got) == expected")
    if not len(at):
        return None
    rest = abs(values(np.asarray(got, dtype=float)))
    if ((got < grid[at]) | (got > grid[at + 1])).any() or rest.max() > 1e-10:
        i = int(np.argmax(rest))
        return Complaint(
            f"no zero at {got[i]}", f"({grid[at[i]]}, {grid[at[i] + 1]})", f"expected[0] <= got[{i}] <= expected[1]"
        )
    return None


KINDS = {
    "tau": tau,
    "contact": contact,
    "straight contact": straight_contact,
    "attitude": attitude,
    "events": events,
}
