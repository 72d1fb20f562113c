"""Torque-free attitude at any epoch: the laboratory compared with Orekit's TorqueFree.

The body (1, 2, 3) starts from ω = (0.384, 0.64, −0.496). Errors of ω in the axes of the body are differences from a run
of 50 digits from the same floats. Orekit is measured through JPype, one epoch a call, where ``orekit_jpype`` and Java
are installed (``pip install orekit-jpype``). Times are processor times, the least of several.
"""

from __future__ import annotations

from collections.abc import Callable
from importlib.util import find_spec

import numpy as np

from benchmarks.curves import least_seconds
from integrable import RigidBody
from jacobian import MP

MOMENTS, OMEGA = (1.0, 2.0, 3.0), (0.384, 0.64, -0.496)
TIMES = (10.0, 1e3, 1e4, 1e6, 1e9, 1e12)


def run(smoke: bool) -> list[dict[str, object]]:
    """A row for each method, with the times of a set-up and of an epoch among many, and the errors."""
    repeats, count = (1, 10) if smoke else (20, 2000)
    times = TIMES[:3] if smoke else TIMES
    truth = RigidBody(MOMENTS, field=MP(50)).motion(np.eye(3), OMEGA).at(times).omega_body.astype(float)
    rows = [_row("laboratory", _laboratory, times, truth, repeats, count)]
    if find_spec("orekit_jpype") is not None:
        rows.append(_row("Orekit", _orekit(), times, truth, repeats, count))
    return rows


def _row(
    name: str,
    make: Callable[[], Callable[[np.ndarray], np.ndarray]],
    times: tuple[float, ...],
    truth: np.ndarray,
    repeats: int,
    count: int,
) -> dict[str, object]:
    near, far = np.array([1.0]), np.linspace(0, 1e4, count)
    propagate = make()
    found = propagate(np.array(times))
    errors = np.abs(found - truth).max(axis=1)
    row: dict[str, object] = {
        "way": name,
        "set-up and one epoch, ms": 1e3 * least_seconds(lambda: make()(near), repeats),
        "set-up and far, ms": 1e3 * least_seconds(lambda: make()(far[-1:]), repeats),
        "µs an epoch": 1e6 * least_seconds(lambda: propagate(far), 3) / count,
    }
    return row | {f"error at {t:.0e}": float(e) for t, e in zip(times, errors, strict=True)}


def _laboratory() -> Callable[[np.ndarray], np.ndarray]:
    motion = RigidBody(MOMENTS).motion(np.eye(3), OMEGA)
    return lambda times: motion.at(times).omega_body


def _orekit() -> Callable[[], Callable[[np.ndarray], np.ndarray]]:
    import orekit_jpype

    orekit_jpype.initVM()
    from org.hipparchus.geometry.euclidean.threed import Rotation, Vector3D
    from org.orekit.attitudes import Attitude, Inertia, InertiaAxis, TorqueFree
    from org.orekit.frames import FramesFactory
    from org.orekit.time import AbsoluteDate

    epoch, frame = AbsoluteDate.ARBITRARY_EPOCH, FramesFactory.getGCRF()
    axes = (Vector3D.PLUS_I, Vector3D.PLUS_J, Vector3D.PLUS_K)

    def make() -> Callable[[np.ndarray], np.ndarray]:
        start = Attitude(epoch, frame, Rotation.IDENTITY, Vector3D(*OMEGA), Vector3D.ZERO)
        free = TorqueFree(start, Inertia(*(InertiaAxis(i, axis) for i, axis in zip(MOMENTS, axes, strict=True))))

        def propagate(times: np.ndarray) -> np.ndarray:
            spins = (free.getAttitude(None, epoch.shiftedBy(t), frame).getSpin() for t in times.tolist())
            return np.array([[spin.getX(), spin.getY(), spin.getZ()] for spin in spins])

        return propagate

    return make
