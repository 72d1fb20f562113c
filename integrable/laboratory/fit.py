"""The motion of a free body fitted to measured orientations: ratios of its moments, its start, their covariance.

SciPy's least squares (Levenberg 1944, Marquardt 1963) minimizes the rotations from the computed orientations to the
measured ones. The derivatives of these rotations follow from the derivatives of γ and M, which are both fixed in space
(:mod:`integrable.portrait.sensitivity`). A turn ψ of the body in its own axes changes γ by γ × ψ and M by M × ψ;
changes of ω and I change the momentum of the start.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np

from integrable.extras import needed
from integrable.laboratory.tensor import matrices_of
from jacobian import RR
from jacobian.element import Numbers
from jacobian.errors import ArgumentError, floats, shown, written
from jacobian.immutable import Record

LEAST_COUNT = 3
# allowed deviation of R Rᵀ from 1 for a measured rotation
MEASURED = 1e-3
UNDETERMINED = "no body fits them best from this guess; give a nearer guess, or orientations at more and later times"
NAMES = ("turn1", "turn2", "turn3", "omega1", "omega2", "omega3", "log ratio1", "log ratio2")


class OrientationFit(Record):
    """The result of :meth:`integrable.laboratory.motion.LaboratoryMotion.fitted`.

    ``motion`` is the fitted motion. ``ratios`` (2,) are the first two principal moments divided by the third.
    ``omega`` (3,) is ω of the start in the laboratory, in rad/s, ``rms`` the root mean square of the residual angles,
    in rad. ``covariance`` (8, 8) is that of the parameters :data:`NAMES`, estimated from these angles. The parameters
    are a turn of the start in the laboratory, ω of the start along the principal axes, and the logarithms of the
    ratios.
    """

    def __init__(self, motion: Any, ratios: np.ndarray, rms: float, covariance: np.ndarray) -> None:
        self.motion, self.ratios, self.rms, self.covariance = motion, ratios, rms, covariance

    @property
    def omega(self) -> Any:
        """The angular velocity of the start in the laboratory, rad/s."""
        return self.motion.at([0.0]).omega[0]

    def _repr_html_(self) -> str:
        from jacobian.notebook import named

        errors = np.sqrt(np.diag(self.covariance))
        facts: list[tuple[str, Any]] = [
            ("ratios", tuple(self.ratios.tolist())),
            ("relative errors of the ratios", tuple(errors[6:].tolist())),
        ]
        facts += [("ω of the start, rad/s", tuple(self.omega.tolist())), ("rms, rad", self.rms)]
        return named("motion nearest to orientations", facts)

    def __repr__(self) -> str:
        first, second = self.ratios.tolist()
        return f"<OrientationFit: ratios {first:.8g} and {second:.8g}, rms {self.rms:.2g} rad>"


def fitted(guess: Any, times: Numbers, orientations: Iterable[object]) -> OrientationFit:
    """The motion nearest to measured orientations, found from a ``guess``; see ``LaboratoryMotion.fitted``."""
    needed("scipy", "fitted")
    from scipy.optimize import least_squares

    body = guess.body
    if body.field is not RR or body.mass is not None:
        raise ArgumentError(f"fitted: of {body!r}; it takes a free body over RR")
    instants = guess.at(times).times
    if len(instants) < LEAST_COUNT:
        raise ArgumentError(f"times = {shown(times)}: give a sequence of {LEAST_COUNT} times or more")
    problem = _Problem(guess, instants, _rotations(orientations, len(instants)))
    found = least_squares(problem.residuals, np.zeros(8), problem.slopes, method="lm", x_scale="jac")
    sizes = np.linalg.norm(found.jac, axis=0)
    if not found.success or np.linalg.matrix_rank(found.jac / np.where(sizes > 0, sizes, 1)) < len(NAMES):
        raise ArgumentError(f"orientations: {UNDETERMINED}")
    left = found.fun.reshape(-1, 3)
    free = max(1, left.size - 8)
    covariance = np.linalg.inv(found.jac.T @ found.jac) * (2 * found.cost / free)
    moments = problem.moments(found.x)
    rms = float(np.sqrt(np.mean(np.sum(left**2, axis=1))))
    return OrientationFit(problem.result(found.x), moments[:2] / moments[2], rms, covariance)


def _rotations(orientations: Any, count: int) -> np.ndarray:
    """Measured orientations as matrices, shape (count, 3, 3), or an ArgumentError."""
    wanted = f"give 3×3 matrices, or SciPy's Rotation, of {count} times"
    found: np.ndarray = floats(matrices_of(orientations), "orientations", wanted)
    if found.shape != (count, 3, 3):
        raise ArgumentError(
            f"orientations have the shape {found.shape}: give a rotation for each of {written(count)} times"
        )
    # NaN and infinities become 2, which is no entry of a rotation, so that the check below finds them
    safe = np.where(np.isfinite(found), found, 2)
    off = abs(safe @ safe.transpose(0, 2, 1) - np.eye(3)).max(axis=(1, 2))
    wrong = (off > MEASURED) | (np.linalg.det(safe) < 0)
    if wrong.any():
        i = int(np.argmax(wrong))
        raise ArgumentError(f"orientations[{i}] = {shown(found[i].tolist())} is no rotation: give a matrix of one")
    return found


class _Problem:
    """Residuals and their derivatives with respect to eight parameters.

    The parameters are 0 at the guess. They are a turn of the start in the laboratory, changes of ω along the principal
    axes, and changes of the logarithms of the first two moments.
    """

    def __init__(self, guess: Any, times: np.ndarray, orientations: np.ndarray) -> None:
        body = guess.body
        self._body, self._times = body, times
        self._axes = np.array(body.axes, dtype=float)
        self._measured = orientations @ self._axes
        start = guess.at([0.0])
        self._start, self._omega = start.matrices[0] @ self._axes, self._axes.T @ start.omega_body[0]
        self._moments = np.array(body.moments, dtype=float)
        self._known: tuple[bytes, Any] = (b"", None)

    def moments(self, x: np.ndarray) -> np.ndarray:
        # an overflow gives an impossible body, which is refused
        with np.errstate(over="ignore"):
            found: np.ndarray = self._moments * np.exp([x[6], x[7], 0.0])
        return found

    def result(self, x: np.ndarray) -> Any:
        """The fitted motion at the parameters ``x``, in the axes of the guess's tensor."""
        moments, turned = self.moments(x), _rotation(x[:3]) @ self._start
        tensor = self._axes @ np.diag(moments) @ self._axes.T
        return type(self._body)(tensor).motion(turned @ self._axes.T, turned @ (self._omega + x[3:6]))

    def _motion(self, x: np.ndarray) -> Any:
        key = x.tobytes()
        if self._known[0] != key:
            turned = _rotation(x[:3]) @ self._start
            try:
                motion = type(self._body)(self.moments(x)).motion(turned, turned @ (self._omega + x[3:6]))
            except ArgumentError as error:
                # a step of the least-squares method has led to an impossible body
                raise ArgumentError(f"orientations: {UNDETERMINED} ({error})") from None
            self._known = key, motion
        return self._known[1]

    def residuals(self, x: np.ndarray) -> np.ndarray:
        """The rotation vectors, in the laboratory, from computed to measured orientations, shape (3N,)."""
        from scipy.spatial.transform import Rotation

        there = self._motion(x).at(self._times).matrices
        found: np.ndarray = Rotation.from_matrix(self._measured @ there.transpose(0, 2, 1)).as_rotvec().ravel()
        return found

    def slopes(self, x: np.ndarray) -> np.ndarray:
        """The derivatives of the residuals, shape (3N, 8), up to terms of the size of the residuals."""
        motion = self._motion(x)
        if motion.flow is None:
            raise ArgumentError(
                "fitted: ω is constant in the guess and does not depend on the moments; guess another ω"
            )
        flow, matrices = motion.flow, motion.at(self._times).matrices
        run, moments, omega = flow.at(self._times), self.moments(x), self._omega + x[3:6]
        S = flow.sensitivity(self._times).matrix
        # ``by_start`` has the derivatives of the start's M = Iω with respect to ω and log I
        by_start = np.hstack([np.diag(moments), np.diag(moments * omega)[:, :2]])
        change = S[:, :, 3:6] @ by_start
        change[:, :, 3:] += S[:, :, 6:8] * moments[:2]
        start = motion.at([0.0]).matrices[0]
        carried = matrices.transpose(0, 2, 1) @ start @ by_start
        psi = _turns(run.gamma, run.M, change[:, :3], change[:, 3:] - carried)
        out = np.empty((len(self._times), 3, 8))
        out[:, :, :3] = -_left(x[:3])
        out[:, :, 3:] = -matrices @ psi
        return out.reshape(-1, 8)


def _turns(gamma: np.ndarray, M: np.ndarray, by_gamma: np.ndarray, by_M: np.ndarray) -> np.ndarray:
    """The turns ψ, shape (N, 3, m), for which γ × ψ = ``by_gamma`` and M × ψ = ``by_M``; γ and M have shape (N, 3)."""
    g, m = gamma[:, :, None], M[:, :, None]
    across = np.cross(by_gamma, g, axis=1)
    normal = np.cross(m, g, axis=1)
    rest = by_M - np.cross(m, across, axis=1)
    found: np.ndarray = across + g * (np.sum(rest * normal, axis=1) / np.sum(normal**2, axis=1))[:, None, :]
    return found


def _rotation(turn: np.ndarray) -> np.ndarray:
    from scipy.spatial.transform import Rotation

    found: np.ndarray = Rotation.from_rotvec(turn).as_matrix()
    return found


def _left(turn: np.ndarray) -> np.ndarray:
    """The left Jacobian (3, 3) of a rotation vector: the turn in space caused by a change of the vector."""
    angle = float(np.linalg.norm(turn))
    if angle < 1e-8:
        return np.eye(3)
    a = turn / angle
    skew = np.array([[0, -a[2], a[1]], [a[2], 0, -a[0]], [-a[1], a[0], 0]])
    part = np.sin(angle) / angle
    found: np.ndarray = part * np.eye(3) + (1 - part) * np.outer(a, a) + (1 - np.cos(angle)) / angle * skew
    return found
