"""The angles of points in their ovals at many given phases, in floats."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from jacobian.errors import PrecisionLoss

# largest numbers of Newton steps and of halvings of a step. After a step below LAST the error is about its square; a
# gap below ROUNDED may be rounding
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
        gaps, left = self._gaps(angles, phases), np.arange(len(phases))
        for _ in range(MOST_STEPS):
            wanted = gaps[left] @ (2 * np.pi * self.means)
            steps = np.linalg.solve(self.slopes(angles[left]), wanted[:, :, None])[:, :, 0]
            angles[left] -= steps
            far = np.abs(steps).max(axis=1) >= LAST
            left, steps = left[far], steps[far]
            if not len(left):
                return angles
            size, worse = np.maximum(np.abs(gaps[left]).max(axis=1), ROUNDED), np.arange(len(left))
            for _ in range(MOST_HALVINGS):
                rows = left[worse]
                gaps[rows] = self._gaps(angles[rows], phases[rows])
                worse = worse[np.abs(gaps[rows]).max(axis=1) > size[worse]]
                if not len(worse):
                    break
                steps[worse] /= 2
                angles[left[worse]] += steps[worse]
        raise PrecisionLoss("the angles of the points at these phases were not found in floats")

    def _gaps(self, angles: Array, phases: Array) -> Array:
        sums = angles @ self.means
        for phi, waves in zip(angles.T, self.waves, strict=True):
            sums += np.sin(np.outer(phi, np.arange(1, len(waves) + 1))) @ waves
        found: Array = np.linalg.solve(2 * np.pi * self.means.T, sums.T).T - phases
        return found

    def slopes(self, angles: Array) -> Array:
        """The derivatives of the sums by the angles, shape (N, forms, ovals)."""
        columns = []
        for phi, mean, waves in zip(angles.T, self.means, self.waves, strict=True):
            n = np.arange(1, len(waves) + 1)
            columns.append(mean + np.cos(np.outer(phi, n)) @ (n[:, None] * waves))
        return np.stack(columns, axis=2)
