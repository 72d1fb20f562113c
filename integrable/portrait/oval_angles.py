"""The angles of points in their ovals at given phases, many at once, in floats."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from jacobian.errors import PrecisionLoss

# largest number of Newton steps, and of halvings of one; a step below LAST has its square as error; a gap below ROUNDED
# may be rounding
MOST_STEPS, MOST_HALVINGS, LAST, ROUNDED = 60, 30, 1e-8, 1e-12

Array = np.ndarray


class OvalAngles(NamedTuple):
    """The sums of g forms over g points as functions of their angles: Σ_i(means[i]·φ_i + Σ_n waves[i][n]·sin nφ_i).

    ``means`` has the shape (g, g), for each oval and form; each of ``waves`` has the shape (n, g).
    """

    means: Array
    waves: tuple[Array, ...]

    def at(self, phases: Array) -> Array:
        """The angles φ, (N, g), at phases in turns, (N, g): Newton's method with steps halved while the gap grows.

        The sums map angles to phases one to one, with a derivative that is regular everywhere, so this converges.
        """
        angles = 2 * np.pi * phases
        gaps = self._gaps(angles, phases)
        for _ in range(MOST_STEPS):
            steps = np.linalg.solve(self.slopes(angles), (gaps @ (2 * np.pi * self.means))[:, :, None])[:, :, 0]
            if np.abs(steps).max(initial=0) < LAST:
                return angles - steps
            size = np.abs(gaps).max(axis=1)
            for _ in range(MOST_HALVINGS):
                found = self._gaps(angles - steps, phases)
                worse = np.abs(found).max(axis=1) > np.maximum(size, ROUNDED)
                if not worse.any():
                    break
                steps[worse] /= 2
            angles, gaps = angles - steps, found
        raise PrecisionLoss("the angles of the points at these phases were not found in floats")

    def _gaps(self, angles: Array, phases: Array) -> Array:
        sums = angles @ self.means
        for phi, waves in zip(angles.T, self.waves, strict=True):
            sums += np.sin(np.outer(phi, np.arange(1, len(waves) + 1))) @ waves
        found: Array = np.linalg.solve(2 * np.pi * self.means.T, sums.T).T - phases
        return found

    def slopes(self, angles: Array) -> Array:
        """The derivatives of the sums by the angles, (N, forms, ovals)."""
        columns = []
        for phi, mean, waves in zip(angles.T, self.means, self.waves, strict=True):
            n = np.arange(1, len(waves) + 1)
            columns.append(mean + np.cos(np.outer(phi, n)) @ (n[:, None] * waves))
        return np.stack(columns, axis=2)
