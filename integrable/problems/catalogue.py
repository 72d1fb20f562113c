"""The problems by name: scenes, read as initial value problems."""

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
    """The problem of that name.

    One of :func:`problem_names`; any scene, or path of one, that is a motion of a ball, a top or a system of
    :mod:`integrable.classical`; or a ball or top of :func:`certified_names`. ArgumentError for another scene, or one
    whose start in doubles does not meet the system's constraints exactly.
    """
    if isinstance(name, Scene):
        return Problem(name)
    if isinstance(name, str) and name not in scene_names() and name in certified_names():
        return Problem(certified(name).scene())
    return Problem(load_scene(name))
