"""The path of the point at which a rolling body touches the plane.

The centre moves with the velocity r·ω×γ, and the point of contact stays below it. In the axes of space of
:mod:`integrable.phase.attitude`, x points along the horizontal part M − cγ of the momentum, c = (γ, M), and y = z × x.
With the length m of this part

    ẋ = r(ω, γ×M)/m,    ẏ = −r(H1 − c·n)/m,    n = (γ, ω).

On average ẋ is 0, n is −kH1 and ẏ is −rH1(1 + kc)/m, with k of Chaplygin's transformation (k = 0 at c = 0). The rest of
the path is the integral of a function with mean 0, and is bounded. For two equal moments this rest is a function of the
state (:mod:`integrable.motion.contact_symmetric`), for three equal moments it is 0.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from integrable.motion.trajectory import BodyMotion
from integrable.moving_point.legendre import integral
from integrable.phase.body import cross, symmetry_axis
from integrable.phase.brackets import over
from integrable.phase.state import onto_constraints
from integrable.torus.panels import Panels, panel_integrals
from jacobian import RR
from jacobian.element import Real
from jacobian.errors import NotRepresentable, PrecisionLoss

if TYPE_CHECKING:
    from integrable.motion.trajectory import Trajectory
    from integrable.torus.integrals import TorusIntegral

# length of a panel in basic steps (Setup.step_length)
PANEL_STEPS = 5
# with more panels than this the torus costs less than integrating along the motion
FAR = 50
# MOST_PANELS panels with states from the torus, or MOST_PRECISE with states computed one by one, take about a second
MOST_PANELS, MOST_PRECISE = 4000, 60
# in multiprecision FAR_GAUSS takes the place of FAR; MOST_GAUSS panels without a torus take minutes
FAR_GAUSS, MOST_GAUSS = 4, 40
# guard digits of the bounded part of the path
GUARD = 2
# γ × M loses digits if it is this many times smaller than M
PARALLEL = 30
# (x, y) is the contact point. The rounding error of ẋ is about 8·eps·LEAST times an upper bound of |ẋ|; near a rotation
# about a principal axis it is larger than |ẋ|
LEAST = 1 / 16
# the accuracy of states near the start, computed in floats
TOLERANCE = 1e-13


def positions(run: Trajectory) -> np.ndarray:
    """(x, y) of the contact point at the times of a run, shape (N, 2); (0, 0) at t = 0. The unit is that of
    ``system.radius`` if the radius was given, else the radius itself.

    NotRepresentable for a body that does not roll, PrecisionLoss for times far from 0 of a motion without a torus.
    """
    flow, system = run.flow, run.flow.system
    if not system.body.rolls:
        raise NotRepresentable(f"{system!r} turns about a fixed point: it has no point of contact with a plane")
    rolling = Rolling(flow)
    path = rolling.bounded(run)
    path[:, 1] -= rolling.drift * run.times
    path[(run.tau == 0) | (run.times == 0)] = 0 * rolling.drift
    if path.dtype == object:
        path = np.frompyfunc(system.field.coerce, 1, 1)(path)
    return path if system.radius is None else system.radius * path


class Rolling:
    """The constants of the path of contact: ``drift`` is minus the mean of ẏ in radii, ``loss`` the factor |M|/|γ × M|
    by which rounding in γ × M grows.
    """

    def __init__(self, flow: BodyMotion, number: Callable[[Real], Real] | None = None) -> None:
        """``number`` converts the constants from wide numbers: by default to floats over RR, else not at all."""
        self.flow = flow
        setup = flow.setup
        number = number or (float if flow.system.field is RR else setup.wide.coerce)

        def numbers(*values: Real) -> np.ndarray:
            return np.array([number(x) for x in values])

        system = over(flow.system, setup.wide)
        body, state = system.body, onto_constraints(system, flow.state)
        _, c, h1, h2 = system.integrals(state)
        length = setup.wide.sqrt(sum(x * x for x in cross(setup.wide, *state.vectors)))
        middle = sorted(range(3), key=lambda i: body.inertia[i])[1]
        self._different = numbers(
            *((body.inertia[middle] - x) * body.a[middle] * a for x, a in zip(body.inertia, body.a, strict=True))
        )
        self._d = number(body.d)
        self._contact, self._start = numbers(*body.contact), [numbers(*v)[None] for v in state.vectors]
        self.loss = float(setup.wide.sqrt(h2) / length)
        self._tilt, rest = None, setup.wide.one
        if setup.tilt:
            k, s, p, upright = setup.tilt.k, setup.tilt.s, setup.tilt.p, setup.tilt.upright
            rest = upright.d / body.d
            self._tilt = numbers(p, p * k, -s * setup.tilt.shift, s, c / (length * p)), numbers(*upright.contact)
        self.drift, self._length, self._base = numbers(h1 * rest / length, length, body.a[middle] * c)

    def bounded(self, run: Trajectory) -> np.ndarray:
        """The bounded part of the contact point's (x, y), in radii, at the times of a run: shape (N, 2)."""
        moments = self.flow.system.inertia
        if len(set(moments)) == 1:
            return np.zeros((len(run.tau), 2), dtype=run.tau.dtype)
        if symmetry_axis(moments) is not None:
            from integrable.motion.contact_symmetric import SymmetricPath

            path = SymmetricPath(self.flow)
            return path.at(run.gamma, run.M) - path.at(*self._start)
        return self._integrated(run)

    def rates(self, rows: np.ndarray) -> np.ndarray:
        """The derivatives of the bounded part with respect to τ, dt = dτ/g, at states γ and M side by side: shape (N,
        2).

        The middle a_i is subtracted from A, because the a_i hardly differ if m r² is large. Since (M, γ×M) = (γ, γ×M) =
        0, this changes nothing. Let p be that of Chaplygin's transformation (:mod:`integrable.phase.upright`), and
        tildes mark the upright body. Then n = (γ, ω) minus its mean is ñ·g/(p·g̃), ñ = g̃²(γ̃, AM̃).
        """
        gamma, M = rows[:, :3], rows[:, 3:]
        w = np.cross(gamma, M)
        slowness = np.sum(self._contact * gamma * gamma, axis=1)
        n = (self._base + np.sum(self._different * gamma * M, axis=1)) / slowness
        along = np.sum(self._different * M * w, axis=1) + self._d * n * np.sum(self._different * gamma * w, axis=1)
        x = along * slowness**0.5 / self._length
        if self._tilt is None:
            return np.stack([x, 0 * x], axis=1)
        (p, turn, shift, s, lean), contact = self._tilt
        gamma, M = p * gamma + turn * M, shift * gamma + s * M
        y = lean * np.sum(self._different * gamma * M, axis=1) / np.sum(contact * gamma * gamma, axis=1) ** 0.5
        return np.stack([x, y], axis=1)

    def _integrated(self, run: Trajectory) -> np.ndarray:
        flow, tau = self.flow, run.tau
        length = PANEL_STEPS * flow.setup.step_length / flow.setup.time_scale
        count = int(max(map(abs, tau), default=0) / length)
        precise = flow.system.field is not RR
        torus = flow.contact_on_torus if count > (FAR_GAUSS if precise else FAR) else None
        if torus:
            return torus.at(run)
        if precise:
            self._bound(count, MOST_GAUSS)
            return self._by_gauss(tau, length)
        quick = count <= FAR or (flow._torus is not None and flow._torus.compiled)
        self._bound(count, MOST_PANELS if quick else MOST_PRECISE)
        found = np.zeros((len(tau), 2))
        for sign in (1, -1):
            chosen = np.flatnonzero(sign * tau > 0)
            if len(chosen):
                later = np.abs(tau[chosen])
                along = partial(self._at, sign)
                panels = Panels(along, 0.0, float(later.max()), float(length), TOLERANCE, self.noise)
                found[chosen] = sign * panel_integrals(panels, later)
        return found

    @property
    def noise(self) -> np.ndarray:
        """The approximate rounding error of :meth:`rates`, which near M ∥ γ exceeds the rates themselves."""
        body, (h1, h2) = self.flow.system.body, self.flow.system.integrals(self.flow.state)[2:]
        size, spread, y = h2**0.5, float(np.abs(self._different).max()), 0.0
        x = LEAST * spread * size * size / self._length
        if size > PARALLEL * self._length:
            x = spread * size * (size + body.d * (h1 / min(body.inertia)) ** 0.5) / self._length
        if self._tilt is not None:
            (p, turn, shift, s, lean), contact = self._tilt
            y = abs(lean) * spread * (p + abs(turn) * size) * (abs(shift) + s * size) / min(contact) ** 0.5
        return 8 * RR.eps * np.array([x, y])

    def _bound(self, count: int, most: int) -> None:
        if count > most:
            raise PrecisionLoss(
                f"contact: over {self.flow.system.field.name} the velocity has no Fourier series on a torus of this "
                f"motion (a separatrix is near, or moments and d are of many sizes), and is integrated over {most} "
                f"panels only, not over {count}: ask for times nearer to 0, or for fewer digits"
            )

    def _at(self, sign: int, tau: np.ndarray) -> np.ndarray:
        if self.flow.system.field is not RR:
            many = self.flow._precise.many
            states = many.vectors(many.at_tau((sign * tau).tolist()))
            return self.rates(np.array([(*gamma, *M) for gamma, M in states], dtype=object).reshape(-1, 6))
        run = self.flow.at_tau(sign * tau)
        return self.rates(np.hstack([run.gamma, run.M]))

    def _by_gauss(self, tau: np.ndarray, length: Real) -> np.ndarray:
        """The bounded part of the path at ``tau`` in multiprecision, by a Gauss–Legendre rule on each interval between
        neighbours among 0, the ends of panels and all τ.
        """
        K = self.flow.system.field
        ends = {K.zero, *tau}
        for sign in (1, -1):
            count = int(max((sign * t for t in tau), default=0) / length)
            ends |= {K.coerce(sign * (k + 1) * length) for k in range(count)}
        cuts = sorted(ends)
        parts = [integral(K, partial(self._at, 1), a, b, self.loss) for a, b in pairwise(cuts)]
        sums = np.cumsum([np.array([K.zero, K.zero]), *parts], axis=0)
        place = {t: k for k, t in enumerate(cuts)}
        return np.array([sums[place[t]] - sums[place[K.zero]] for t in tau], dtype=object).reshape(-1, 2)


def on_torus(flow: BodyMotion) -> TorusIntegral | PreciseContact | None:
    """The bounded part of the path as a Fourier series; None if the motion is not a line on a compact torus."""
    from integrable.torus.integrals import TorusIntegral

    try:
        if flow.system.field is not RR:
            return PreciseContact(flow)
        torus, rolling = flow._torus, Rolling(flow)
        return TorusIntegral(torus, rolling.rates, rolling.noise) if torus else None
    except PrecisionLoss:
        return None


class PreciseContact:
    """The bounded part of the path in multiprecision, by a Fourier series on the torus; PrecisionLoss where no series
    exists.
    """

    def __init__(self, flow: BodyMotion) -> None:
        from integrable.torus.integrals import LongIntegral

        self._flow, setup = flow, flow.setup
        with setup.reals:
            rolling = Rolling(flow, setup.reals.number)
        self._integral = LongIntegral(setup, flow.system.field.dps + GUARD, rolling.rates)

    def at(self, run: Trajectory) -> np.ndarray:
        """The bounded part of the path at a run's times, (N, 2). For physical times τ is recomputed to all digits."""
        tau = run.tau.tolist() if run.given_in_tau else self._flow._precise.many.at(run.times.tolist())[0]
        return self._integral.at([self._flow.setup.wide.coerce(t) for t in tau])
