"""The work of a sweep's worker: it computes the states of one chunk's members. Everything here can be pickled."""

from __future__ import annotations

import dataclasses
from fractions import Fraction
from typing import Any, NamedTuple

import numpy as np

from integrable.ensembles.bodies import COLUMNS, computed_singly
from integrable.ensembles.computing import Outcome, statuses
from integrable.ensembles.members import Starts
from integrable.motion.trajectory import Motion
from integrable.phase.precisions import FLOAT_DIGITS
from integrable.scene.data import Scene
from integrable.sweeps.grid import INERTIA, POTENTIAL, C, D, M

__all__ = ["EnsembleJob", "Part", "SceneJob", "done"]


class EnsembleJob(NamedTuple):
    """Members of an ensemble, or of a scene with a ball or top."""

    many: Starts[Any, Any]
    times: np.ndarray


class SceneJob(NamedTuple):
    """Members of a scene with a deformation, and for each member the numbers that replace the scene's
    (:meth:`integrable.sweeps.grid.Grid.rows`).
    """

    scene: Scene
    rows: np.ndarray
    times: np.ndarray


class Part(NamedTuple):
    """The states of k members at N times, of shape (k, N, C), and each row's status of shape (k, N).

    ``ways``, shape (k,), is the way of each member; ``reasons`` say why rows were refused.
    """

    rows: np.ndarray
    status: np.ndarray
    ways: np.ndarray
    reasons: tuple[str, ...]


def done(job: EnsembleJob | SceneJob) -> Part:
    """The states of a job, computed on one thread, since other workers compute other chunks."""
    if isinstance(job, EnsembleJob):
        out = np.empty((len(job.many), len(job.times), job.many._columns))
        return _part(out, job.many._computed(job.times[None], out, most=1))
    out = np.empty((len(job.rows), len(job.times), COLUMNS))
    return _part(out, computed_singly(lambda k: _motion(job.scene, job.rows[k]), job.times[None], out))


def _part(out: np.ndarray, found: Outcome) -> Part:
    status = statuses(found.status, found.partial, out.shape[1]).astype(np.int32)
    return Part(out, status, found.ways, found.reasons)


def _motion(scene: Scene, row: np.ndarray) -> Motion:
    """The motion of one member; raises an error if the member is refused."""
    exact: list[Any] = [None if np.isnan(x) else Fraction(float(x)) for x in row]
    own: Any = dataclasses.replace(
        scene,
        inertia=tuple(exact[INERTIA]),
        d=exact[D] if scene.d is not None or exact[D] else None,
        gamma=tuple(exact[4:7]),
        M=tuple(exact[M]),
        c=exact[C],
        potential=tuple(exact[POTENTIAL]) if scene.potential is not None else None,
    )
    system, state = own.start(FLOAT_DIGITS)
    motion: Motion = system.motion_through(state)
    return motion
