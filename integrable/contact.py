"""Where a rolling body touches the plane.

The centre moves with the velocity r·ω×γ, and the point of contact stays below it. In the axes of space of
:mod:`integrable.attitude`, x along the horizontal part M − cγ of the momentum (c = (γ, M), of length m) and y = z × x,

    ẋ = r(ω, γ×M)/m,    ẏ = −r(H1 − c(γ, ω))/m.

For c = 0 the motion across the momentum is uniform, and x only oscillates: γ → −γ turns the sign of ẋ and is a period
of the divisor.
"""

from __future__ import annotations

from functools import partial
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np

from integrable.attitude import angular_velocities
from integrable.dense_panels import Panels
from integrable.legendre import legendre_rule
from integrable.panel_calculus import integrals
from jacobian import RR
from jacobian.errors import NotRepresentable, PrecisionLoss

if TYPE_CHECKING:
    from integrable.flow import Flow
    from integrable.torus_integral import TorusIntegral
    from integrable.trajectory import Trajectory

# turns of the body from which on the torus costs less than integrating along the way
FAR = 50
# so many panels along the way take some seconds: without a torus, and on one where the velocity has no Fourier series,
# which panels resolve badly too
MOST_PANELS = 5000, 200
# what states near the start, made in floats, are good for
TOLERANCE = 1e-13
# nodes of an interval, for each digit, beyond which the velocity counts as not smooth
MOST_NODES = 20


def positions(run: Trajectory) -> np.ndarray:
    """(x, y) of the contact point at the times of a run, shape (N, 2), (0, 0) at t = 0; in the unit of the radius where
    the ball was given one, else in radii.

    NotRepresentable for a body that does not roll.
    """
    flow, system, times = run.flow, run.flow.system, run.times
    if not system.body.rolls:
        raise NotRepresentable(f"{system!r} turns about a fixed point: it has no point of contact with a plane")
    _, c, h1, _ = system.integrals(flow.state)
    along, spin = _integrals(run).T
    scale = 1 if system.radius is None else system.radius
    return scale * np.stack([along, (c * spin - h1 * times) / _length(flow)], axis=1)


def on_torus(flow: Flow) -> TorusIntegral | None:
    """∫ of :func:`velocities` along the flow in floats, None where the motion is no line on a compact torus."""
    from integrable.torus_integral import TorusIntegral

    torus, contact = flow._torus, np.array(flow.system.body.contact)

    def rates(rows: np.ndarray) -> np.ndarray:
        # per unit of τ: dt = dτ/g
        gamma = rows[:, :3]
        return velocities(flow, gamma, rows[:, 3:]) * (np.sum(contact * gamma * gamma, axis=1) ** 0.5)[:, None]

    try:
        return TorusIntegral(torus, rates) if torus else None
    except PrecisionLoss:
        return None


def _length(flow: Flow) -> Any:
    """The length of the horizontal part of M."""
    C1, c, _, h2 = flow.system.integrals(flow.state)
    return (h2 - c * c / C1) ** 0.5


def velocities(flow: Flow, gamma: np.ndarray, M: np.ndarray) -> np.ndarray:
    """(ẋ/r, (γ, ω)) at states, shape (N, 2)."""
    omega, spin = angular_velocities(flow.system.body, gamma, M)
    across = np.cross(gamma, M)
    return np.stack([np.sum(omega * across, axis=1) / _length(flow), spin], axis=1)


def _integrals(run: Trajectory) -> np.ndarray:
    """∫_0^t of :func:`velocities`, shape (N, 2)."""
    flow, times, length = run.flow, run.times, panel_length(run.flow)
    if flow.system.field != RR:
        return _by_gauss(flow, times, length)
    far = np.abs(times).max(initial=0) > FAR * length
    if far and flow.contact_on_torus:
        return flow.contact_on_torus(run.tau)
    reach = MOST_PANELS[flow._torus is not None] * length
    if np.abs(times).max(initial=0) > reach:
        raise PrecisionLoss(
            f"contact at time {np.abs(times).max():.3g}: the velocity has no Fourier series in floats on the torus of "
            f"this motion, and is integrated up to time {reach:.3g} only"
        )
    found = np.zeros((len(times), 2))
    for sign in (1, -1):
        chosen = np.flatnonzero(sign * times > 0)
        if len(chosen):
            later = np.abs(times[chosen])
            along = partial(_backwards if sign < 0 else _at, flow)
            panels = Panels(along, 0.0, float(later.max()), length, TOLERANCE)
            found[chosen] = sign * integrals(panels, later)
    return found


def _by_gauss(flow: Flow, times: np.ndarray, length: float) -> np.ndarray:
    """The same in multiprecision: Gauss–Legendre between 0, the ends of the panels and the times."""
    K = flow.system.field
    ends = {K.zero, *times}
    for sign in (1, -1):
        count = int(float(max((sign * t for t in times), default=0)) / length)
        ends |= {K.coerce(sign * (k + 1) * length) for k in range(count)}
    cuts = sorted(ends)
    parts = [_gauss(flow, a, b) for a, b in pairwise(cuts)]
    sums = np.cumsum([np.array([K.zero, K.zero]), *parts], axis=0)
    place = {t: k for k, t in enumerate(cuts)}
    return np.array([sums[place[t]] - sums[place[K.zero]] for t in times], dtype=object).reshape(-1, 2)


def _gauss(flow: Flow, first: Any, last: Any) -> np.ndarray:
    """∫ over one interval, with as many nodes as make the Legendre series end."""
    K = flow.system.field
    half, middle, count = (last - first) / 2, (last + first) / 2, K.dps + 16
    while True:
        nodes, rows, _ = legendre_rule(K, count)
        series = np.array(rows, dtype=object) @ _at(flow, np.array([middle + half * x for x in nodes]))
        if np.abs(series[-2:]).max() * half <= K.eps * max(1, np.abs(series[0]).max() * half):
            result: np.ndarray = 2 * half * series[0]
            return result
        count = 3 * count // 2
        if count > MOST_NODES * K.dps:
            raise PrecisionLoss(f"between t = {first} and {last}: {count} nodes do not resolve the velocity")


def panel_length(flow: Flow) -> float:
    """A time in which the body makes about a turn."""
    body = flow.system.body
    return 4 / float(max(body.a) * flow.system.integrals(flow.state).H2 ** 0.5)


def _backwards(flow: Flow, times: np.ndarray) -> np.ndarray:
    return _at(flow, -times)


def _at(flow: Flow, times: np.ndarray) -> np.ndarray:
    run = flow.at(times)
    return velocities(flow, run.gamma, run.M)
