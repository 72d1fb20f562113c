"""A rolling ball and a free rigid body in SI units, from tensors in any axes.

Let J = Q diag(I) Qᵀ be the tensor, R₀ the orientation at time 0, z the upward vertical, and ω the angular velocity
along the principal axes. Then γ = QᵀR₀ᵀz and M = (I + d)ω − d(γ, ω)γ with d = mr². Let R be the rotation
from the principal axes to the laboratory. Then R M is constant: it is the angular momentum about the point of contact
of a rolling body, or about the centre of mass of a free one. So the states of the flow give the orientation without an
integration (:mod:`integrable.phase.attitude`). The contact path of the flow, rotated into the laboratory, is the path
in metres.
"""

from __future__ import annotations

import warnings
from collections.abc import Iterable
from math import ceil, log10
from typing import Any

import numpy as np

from integrable.laboratory.motion import LaboratoryMotion
from integrable.laboratory.tensor import Orientation, cross, matrix, principal, rotation
from integrable.laboratory.vertical import Vertical
from integrable.laboratory.ways import Along, Uniform, WideFlow, numbers
from integrable.phase.body import Body, elements, say_unphysical, triple, unwarned
from integrable.phase.made import Made
from integrable.phase.precisions import ROUNDED_TO_FLOATS, SET_UP_DIGITS
from integrable.phase.state import State
from integrable.systems.chaplygin_ball import ChaplyginBall
from integrable.systems.euler_top import EulerTop
from jacobian import MP, RR
from jacobian.element import Real, Table, Value
from jacobian.errors import ArgumentError, shown
from jacobian.fields.protocol import Field

# over MP(digits) a set-up has GUARD digits more than the results, and a flow INNER digits more than the results
GUARD, INNER = 15, 5
# M counts as vertical if its horizontal part is below VERTICAL rounding units of |M|; if the part is below NEARLY·|M|,
# a flow in floats would lose digits
VERTICAL, NEARLY = 64, 1e-2


class RigidBody(Made):
    """A free rigid body: no torque acts about its centre of mass or, if a point of it is fixed, about that point.

    ``inertia`` is its tensor about the centre of mass or the fixed point in any axes, or three moments in its principal
    axes, in kg·m². ``field`` is RR or MP(digits). ``moments`` (3,) are the principal moments; the columns of ``axes``
    (3, 3) are the principal axes, in the axes of the tensor.
    """

    mass: Real | None = None
    radius: Real | None = None

    def __init__(self, inertia: Table, *, field: Field = RR) -> None:
        self._wide = _wide_field(field)
        K: Any = field
        self.field, eps = K, K.eps
        self._tensor = matrix(self._wide, inertia, "inertia", "three moments or a 3×3 tensor", moments=True)
        self._principal = principal(self._wide, self._tensor, eps)
        say_unphysical([float(x) for x in self._principal.moments], RR)
        self.moments = tuple(field.coerce(x) for x in self._principal.moments)
        self._d = self._wide.zero
        # the moments of a free body that turns like this one; for a ball with vertical momentum they are I + d
        self._free_moments = self._principal.moments

    @property
    def axes(self) -> np.ndarray:
        """The principal axes in the axes of the tensor, as columns, shape (3, 3)."""
        return numbers(self.field, self._principal.axes)

    def motion(self, orientation: Orientation, omega: Iterable[Value]) -> LaboratoryMotion:
        """The motion from an orientation and an angular velocity.

        ``orientation`` takes vectors in the axes of the tensor to the laboratory: a 3×3 matrix or SciPy's Rotation.
        ``omega`` is in rad/s in the axes of the laboratory. An ArgumentError names the wrong argument.
        """
        return LaboratoryMotion(self, *self._start(orientation, omega), None)

    def _way(self, start: np.ndarray, spin: np.ndarray) -> Any:
        """The method for a motion. At time 0 the columns of ``start`` are the principal axes in the laboratory, and
        ``spin`` is ω along these axes.
        """
        moments, K = self._principal.moments, self._wide
        if _uniform(moments, spin, self.field.eps):
            return Uniform(self.field, start, spin, None)
        # any vector fixed in space can serve as γ; with one orthogonal to M no digits are lost
        M = np.array([x * w for x, w in zip(moments, spin, strict=True)], dtype=object)
        gamma, along = _across(K, M), M / K.sqrt(M @ M)
        frame = start @ np.stack([along, cross(gamma, along), gamma], axis=1)
        return Along(self._free_flow(gamma, M), frame)

    def _free_flow(self, gamma: np.ndarray, M: np.ndarray) -> WideFlow:
        """The flow of the free body with the moments ``_free_moments``; γ may be any vector fixed in space."""
        inner = _inner(self.field, 0)
        with unwarned():
            system = EulerTop([inner.coerce(x) for x in self._free_moments], field=inner)
        return self._flow(system, gamma, M, False)

    def _start(self, orientation: Any, omega: Any) -> tuple[Any, Any]:
        """The matrix from principal axes to the laboratory, and ω along these axes, in wide numbers."""
        K = self._wide
        start = rotation(K, orientation) @ self._principal.axes
        space = np.array(triple(K, omega, "omega"), dtype=object)
        return start, start.T @ space

    def _flow(self, system: Any, gamma: np.ndarray, M: np.ndarray, tilted: bool) -> WideFlow:
        K, coerce = self._wide, system.field.coerce
        body = Body(self._principal.moments, self._d, K) if system.d else Body(self._free_moments, K.zero, K)
        wide = State(tuple(gamma), tuple(M), tilted=tilted)
        near = State(tuple(map(coerce, gamma)), tuple(map(coerce, M)), tilted=tilted)
        return WideFlow(system, near, body, wide)

    def _value(self) -> tuple[object, ...]:
        moments, axes = self._principal
        return self.field, moments, tuple(axes.ravel().tolist())

    def _repr_html_(self) -> str:
        from jacobian.notebook import named

        facts = [("principal moments, kg·m²", self.moments), ("field", self.field.name)]
        given = (("mass, kg", self.mass), ("radius, m", self.radius))
        return named(type(self).__name__, [*facts, *(x for x in given if x[1] is not None)])

    @property
    def arguments(self) -> dict[str, object]:
        tensor = self._tensor
        diagonal = not tensor[~np.eye(3, dtype=bool)].any()
        return {"inertia": tuple(np.diagonal(tensor)) if diagonal else tuple(map(tuple, tensor))}


class RollingBall(RigidBody):
    """A ball that rolls on a horizontal plane without slipping, and whose centre of mass is its centre.

    ``inertia`` is the tensor about the centre in any axes, or three moments in its principal axes, in kg·m². ``mass``
    is in kg, ``radius`` in m, and ``field`` is RR or MP(digits). ``moments`` and ``axes`` are those of a
    :class:`RigidBody`.
    """

    def __init__(self, inertia: Table, mass: Value, radius: Value, *, field: Field = RR) -> None:
        super().__init__(inertia, field=field)
        K = self._wide
        wide = []
        for name, value in (("mass", mass), ("radius", radius)):
            wide.append(K.coerce(value, name))
            if not wide[-1] > 0:
                raise ArgumentError(f"{name} = {shown(value)} is not positive: a rolling ball has a mass and a radius")
        self._mass, self._radius = wide
        self._d = self._mass * self._radius**2
        self._free_moments = tuple(x + self._d for x in self._principal.moments)
        self.mass, self.radius = field.coerce(mass), field.coerce(radius)
        if sum(self._principal.moments) > 2 * self._d * (1 + 8 * self.field.eps):
            warnings.warn(
                f"inertia: its moments add up to {float(sum(self._principal.moments))}, more than 2·mass·radius² = "
                f"{float(2 * self._d)}: some of the mass is outside the ball",
                stacklevel=2,
            )

    @property
    def arguments(self) -> dict[str, object]:
        return {**super().arguments, "mass": self._mass, "radius": self._radius}

    def _value(self) -> tuple[Real, ...]:
        return *super()._value(), self._mass, self._radius

    def motion(
        self, orientation: Orientation, omega: Iterable[Value], contact: Iterable[Value] = (0, 0)
    ) -> LaboratoryMotion:
        """The motion from an orientation, an angular velocity and a point of contact.

        ``orientation`` takes vectors in the axes of the tensor to the laboratory, whose z is up: a 3×3 matrix or
        SciPy's Rotation. ``omega`` is in rad/s in the axes of the laboratory, ``contact`` (x, y) in m. An
        ArgumentError names the wrong argument.
        """
        start, spin = self._start(orientation, omega)
        origin = elements(self._wide, contact, "contact", 2, "a sequence of two numbers, x and y,")
        return LaboratoryMotion(self, start, spin, origin)

    def _way(self, start: np.ndarray, spin: np.ndarray) -> Any:
        K, d, moments = self._wide, self._d, self._principal.moments
        if _uniform(moments, spin, self.field.eps):
            return Uniform(self.field, start, spin, self._radius)
        gamma = start[2]
        M = (
            np.array([(x + d) * w for x, w in zip(moments, spin, strict=True)], dtype=object)
            - d * (gamma @ spin) * gamma
        )
        c = gamma @ M
        flat = M - c * gamma
        length, size = K.sqrt(flat @ flat), K.sqrt(M @ M)
        if length <= VERTICAL * self.field.eps * size:
            return self._vertical(start, gamma, c + d * (gamma @ spin))
        # the horizontal part of M determines the axes of space; if it is small, the flow is computed with more digits
        lost = 0 if length >= NEARLY * size else ceil(log10(float(size / length)))
        inner = _inner(self.field, lost)
        with unwarned():
            system = ChaplyginBall(
                [inner.coerce(x) for x in moments],
                mass=inner.coerce(d / self._radius**2),
                radius=inner.coerce(self._radius),
                field=inner,
            )
        across = start @ flat / length
        frame = np.stack([across, cross(start @ gamma, across), start @ gamma], axis=1)
        return Along(self._flow(system, gamma, M, True), frame)

    def _vertical(self, start: np.ndarray, gamma: np.ndarray, rate: Real) -> Vertical:
        """The method for M ∥ γ, by the free body with the moments I + d and the momentum λγ, λ = ``rate``."""
        sign = 1 if rate > 0 else -1
        # the free body's attitude has x along its momentum, and z along its γ, which here is the laboratory's axis x
        frame = np.array([[0, 0, 1], [0, -sign, 0], [sign, 0, 0]], dtype=object) * self._wide.one
        return Vertical(self._free_flow(start[0], rate * gamma), frame, self._radius, sign)


def _wide_field(field: Field) -> Any:
    if field is RR:
        return MP(SET_UP_DIGITS)
    if type(field) is not type(MP(15)) or field.complex:
        raise ArgumentError(f"field = {shown(field)}: a body in the laboratory is over RR or MP(digits)")
    return MP(field.dps + GUARD)


def _inner(field: Any, lost: int) -> Any:
    """The field over which a flow is computed if its states lose ``lost`` digits in the conversion to orientations."""
    if field is RR:
        return MP(ROUNDED_TO_FLOATS + lost) if lost else RR
    return MP(field.dps + INNER + lost)


def _uniform(moments: Any, spin: Any, eps: Any) -> bool:
    """Whether the angular momentum is parallel to ω, so that ω is constant. If ω is nearly along the axis of an extreme
    moment, about which the rotation is stable, it suffices that they are parallel up to rounding.
    """
    size = max(map(abs, spin))
    if not size:
        return True
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        rest = [abs(spin[n]) for n in (j, k) if moments[n] != moments[i]]
        off = max(rest, default=0)
        extreme = (moments[i] - moments[j]) * (moments[i] - moments[k]) >= 0
        if off == 0 or (extreme and off <= eps * size):
            return True
    return False


def _across(K: Field, M: np.ndarray) -> Any:
    """A unit vector orthogonal to M."""
    axis = min(range(3), key=lambda i: abs(M[i]))
    unit = np.array([K.one * (i == axis) for i in range(3)], dtype=object)
    found = cross(M, unit)
    return found / K.sqrt(found @ found)
