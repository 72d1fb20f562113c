"""The angles of points in their ovals at many given phases, in floats."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from jacobian.errors import PrecisionLoss

# largest numbers of Newton steps and of halvings of a step. After a step below LAST the error is about its square; a
# difference from the given phases below ROUNDED may be rounding
MOST_STEPS, MOST_HALVINGS, LAST, ROUNDED = 60, 30, 1e-8, 1e-12
# number of sines summed in one array operation
SINES = 1 << 20

Array = np.ndarray


class OvalAngles(NamedTuple):
    """The integrals of g differential forms, each a sum over g points at angles φ_i in their ovals.

    The sums are Σ_i(means[i]·φ_i + Σ_n waves[i][n]·sin nφ_i). ``means`` has the shape (g, g), for each oval and form;
    each of ``waves`` has the shape (n, g).
    """

    means: Array
    waves: tuple[Array, ...]

    def at(self, phases: Array) -> Array:
        """The angles φ, (N, g), at phases in turns, (N, g): Newton's method, with steps halved while the residual
        grows.

        The sums map angles to phases one to one, with a derivative that is regular everywhere, so the method converges.
        """
        return self._in_parts(self._at, phases)

    def delays(self, phases: Array, oval: int, rates: Array) -> Array:
        """The times, shape (N,), that the motion takes from ``phases`` until the point in one ``oval`` is at the angle
        φ = 2π·phases[:, oval].

        ``rates`` are the derivatives of the class's g sums by time. Combinations of the sums that are constant in time
        determine the angles of the other points; a sum that grows then gives the time.
        """
        grows, others = int(np.argmax(np.abs(rates))), [k for k in range(len(self.means)) if k != oval]

        def still(sums: Array) -> Array:
            return np.delete(sums - sums[:, [grows]] * (rates / rates[grows]), grows, axis=1)

        rest = OvalAngles(still(self.means[others]), tuple(still(self.waves[k]) for k in others))

        def late(phases: Array) -> Array:
            angles = np.insert(rest._at(phases[:, others]), oval, 2 * np.pi * phases[:, oval], axis=1)
            return (self.sums(angles)[0] - 2 * np.pi * phases @ self.means)[:, grows] / rates[grows]

        return self._in_parts(late, phases)

    def _in_parts(self, function: Callable[[Array], Array], phases: Array) -> Array:
        size = max(1, SINES // max(1, *map(len, self.waves)))
        return np.concatenate([function(phases[begin : begin + size]) for begin in range(0, len(phases), size)])

    def _at(self, phases: Array) -> Array:
        angles, left = 2 * np.pi * phases, np.arange(len(phases))
        gaps, slopes = self._gaps(angles, phases)
        for _ in range(MOST_STEPS):
            wanted = gaps[left] @ (2 * np.pi * self.means)
            steps = np.linalg.solve(slopes[left], wanted[:, :, None])[:, :, 0]
            angles[left] -= steps
            far = np.abs(steps).max(axis=1, initial=0) >= LAST
            left, steps = left[far], steps[far]
            if not len(left):
                return angles
            size, worse = np.maximum(np.abs(gaps[left]).max(axis=1), ROUNDED), np.arange(len(left))
            for _ in range(MOST_HALVINGS):
                rows = left[worse]
                gaps[rows], slopes[rows] = self._gaps(angles[rows], phases[rows])
                worse = worse[np.abs(gaps[rows]).max(axis=1) > size[worse]]
                if not len(worse):
                    break
                steps[worse] /= 2
                angles[left[worse]] += steps[worse]
        raise PrecisionLoss("the angles of the points at these phases were not found in floats")

    def _gaps(self, angles: Array, phases: Array) -> tuple[Array, Array]:
        sums, slopes = self.sums(angles)
        return self.phases_of(sums) - phases, slopes

    def phases_of(self, sums: Array) -> Array:
        """The phases in turns, (N, g), from the sums, (N, g)."""
        return np.linalg.solve(2 * np.pi * self.means.T, sums.T).T

    def phases_at(self, angles: Array) -> Array:
        """The phases in turns, (N, g), at angles φ, (N, g)."""
        return self._in_parts(lambda x: self.phases_of(self.sums(x)[0]), angles)

    def sums(self, angles: Array) -> tuple[Array, Array]:
        """The sums, (N, forms), and their derivatives with respect to the angles, (N, forms, ovals)."""
        sums, slopes = angles @ self.means, np.repeat(self.means.T[None], len(angles), axis=0)
        for k, waves in enumerate(self.waves):
            count = len(waves)
            modes = np.cumprod(np.repeat(np.exp(1j * angles[:, k : k + 1]), count, axis=1), axis=1)
            sums += modes.imag @ waves
            slopes[:, :, k] += modes.real @ (np.arange(1, count + 1)[:, None] * waves)
        return sums, slopes
