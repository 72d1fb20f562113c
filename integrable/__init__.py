"""Rigid bodies whose motion is addition on a Jacobian: the Chaplygin ball, the Euler top and their relatives.

>>> from integrable import ChaplyginBall
>>> ball = ChaplyginBall(inertia=(1, 2, 3), d=0.7)
>>> flow = ball.flow(ball.state(gamma=(0.48, 0.6, 0.64), M=(0.384, 1.28, -1.488)))
>>> flow.at([1000.0]).gamma.round(6)
array([[-0.887809,  0.353736, -0.294391]])
"""

from __future__ import annotations

import jacobian

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, NoReturn

    from integrable.deformations.gyroscopic import Gyroscopic
    from integrable.deformations.isometric import Check, Hat
    from integrable.deformations.tilde import Tilde
    from integrable.ensembles.ensemble import ensemble
    from integrable.ensembles.laboratory import laboratory_ensemble
    from integrable.laboratory.bodies import RigidBody, RollingBall
    from integrable.motion.trajectory import Trajectory
    from integrable.scene.file import load_scene
    from integrable.study.run import run
    from integrable.sweeps.sweep import sweep
    from integrable.systems.chaplygin_ball import ChaplyginBall
    from integrable.systems.euler_top import EulerTop

_HOME = {
    "ChaplyginBall": "integrable.systems.chaplygin_ball",
    "Check": "integrable.deformations.isometric",
    "EulerTop": "integrable.systems.euler_top",
    "Gyroscopic": "integrable.deformations.gyroscopic",
    "Hat": "integrable.deformations.isometric",
    "RigidBody": "integrable.laboratory.bodies",
    "RollingBall": "integrable.laboratory.bodies",
    "Tilde": "integrable.deformations.tilde",
    "Trajectory": "integrable.motion.trajectory",
    "ensemble": "integrable.ensembles.ensemble",
    "laboratory_ensemble": "integrable.ensembles.laboratory",
    "load_scene": "integrable.scene.file",
    "run": "integrable.study.run",
    "sweep": "integrable.sweeps.sweep",
}

__all__ = [
    "ChaplyginBall", "Check", "EulerTop", "Gyroscopic", "Hat", "RigidBody", "RollingBall", "Tilde", "Trajectory",
    "ensemble", "laboratory_ensemble", "load_scene", "run", "sweep",
]  # fmt: skip


if getattr(jacobian, "__distribution__", "") != "jacobian-integrable":
    raise ImportError(
        f"{jacobian.__file__} is of another distribution than jacobian-integrable, which has its own package jacobian: "
        "pip uninstall jacobian, then pip install --force-reinstall --no-deps jacobian-integrable"
    )

if not TYPE_CHECKING:
    # __getattr__ is hidden from type checkers, which would otherwise accept any misspelt name

    def __getattr__(name: str) -> Any:
        # names are imported on first use: one step of a ball needs neither numpy nor scene files
        if name not in _HOME:
            raise AttributeError(f"module 'integrable' has no attribute {name!r}")
        from importlib import import_module

        return getattr(import_module(_HOME[name]), name)


def _command() -> NoReturn:
    """The entry point of the installed command ``integrable``, and of ``python -m integrable``."""
    from jacobian.interrupts import leave, stand

    stand("integrable")
    from importlib import import_module

    leave(import_module("integrable.__main__").main())


def __dir__() -> list[str]:
    return sorted([*globals(), *_HOME])
