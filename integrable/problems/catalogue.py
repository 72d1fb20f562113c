"""The problems by name. They are scenes, read as initial value problems."""

from __future__ import annotations

from pathlib import Path

from integrable.problems.certified import certified, certified_names
from integrable.problems.statement import Problem
from integrable.scene.data import Scene
from integrable.scene.file import load_scene, scene_names

__all__ = ["problem", "problem_names"]


def problem_names() -> list[str]:
    """The names of the twelve problems with a reference, a standard set for every method."""
    return [name for name in scene_names() if load_scene(name).reference]


def problem(name: str | Path | Scene) -> Problem:
    """The initial value problem with the given name.

    ``name`` is one of :func:`problem_names`, a ball or top of :func:`certified_names`, or any scene or scene file that
    moves a ball, a top or a system of :mod:`integrable.classical`. Raises ArgumentError for other scenes, and where
    the start in doubles does not satisfy the system's constraints exactly.
    """
    if isinstance(name, Scene):
        return Problem(name)
    if isinstance(name, str) and name not in scene_names() and name in certified_names():
        return Problem(certified(name).scene())
    return Problem(load_scene(name))
