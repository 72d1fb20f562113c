"""The methods of a race: a user's own function, those of :mod:`integrable.oracles`, the package itself."""

from __future__ import annotations

import importlib
import importlib.util
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from time import perf_counter
from typing import Any, NamedTuple

import numpy as np

from integrable.oracles.method import Spent, problem_of, timed_run
from integrable.oracles.methods import METHODS
from integrable.phase.precisions import FLOAT_DIGITS
from integrable.phase.state import State
from integrable.problems.statement import Problem
from integrable.study.timing import Timed
from jacobian.errors import ArgumentError, shown

__all__ = ["RIVALS", "TOLERANCES", "Entrant", "entrants", "loaded"]

Solve = Callable[[Problem, np.ndarray, float], Any]

TOLERANCES = (1e-4, 1e-6, 1e-8, 1e-10, 1e-12, 1e-14)
"""The tolerances passed to a user's own method."""
RIVALS = (
    "SciPy DOP853", "SciPy DOP853, compiled", "SciPy LSODA", "SciPy Radau", "Gauss-Legendre 16, adaptive",
    "Taylor, compiled", "heyoka",
)  # fmt: skip


class Entrant(NamedTuple):
    """A method of a race: its settings from loose to tight, and a function for a timed run at one of them. ``word``
    says what a setting is: "tolerance", "step" or "digits".
    """

    name: str
    settings: tuple[float, ...]
    run: Callable[[Problem, np.ndarray, float], Timed]
    word: str = "tolerance"


def entrants(problem: Problem, own: dict[str, Solve], rivals: Sequence[str]) -> list[Entrant]:
    """The entrants on a problem. Methods that are not installed, or that refuse the problem's system, are left out."""
    system, _ = _given(problem)
    found = [Entrant(name, TOLERANCES, _own(solve)) for name, solve in own.items()]
    for method in map(METHODS.__getitem__, rivals):
        if method.takes(system):
            found.append(Entrant(method.name, method.settings, _method(method), method.parameter))
    itself = "divisor flow" if problem.scene.rolls_or_spins else "additions"
    return [*found, Entrant(itself, (FLOAT_DIGITS,), _package, "digits")]


def loaded(word: str) -> tuple[str, Solve]:
    """The name and the function that ``module:function`` or ``file.py:function`` refers to; else ArgumentError."""
    module, found, function = word.rpartition(":")
    if not (found and module and function.isidentifier()):
        raise ArgumentError(f"{shown(word)}: give module:function or file.py:function, such as mymodule:solve")
    try:
        solve = getattr(_file(Path(module)) if module.endswith(".py") else _module(module), function)
    except (ImportError, OSError) as error:
        raise ArgumentError(f"{shown(word)}: {module} cannot be imported: {error}") from error
    except AttributeError:
        raise ArgumentError(f"{shown(word)}: {module} has no {function}") from None
    if not callable(solve):
        raise ArgumentError(f"{shown(word)}: {function} is no function solve(problem, times, tolerance)")
    return function if function != "solve" else Path(module).stem.rpartition(".")[2], solve


def _module(name: str) -> Any:
    if (here := str(Path.cwd())) not in sys.path:
        sys.path.insert(0, here)
    return importlib.import_module(name)


def _file(path: Path) -> Any:
    specification = importlib.util.spec_from_file_location(path.stem, path)
    if specification is None or specification.loader is None:
        raise ImportError("it is no Python file")
    module = importlib.util.module_from_spec(specification)
    sys.modules[path.stem] = module
    specification.loader.exec_module(module)
    return module


def _given(problem: Problem) -> tuple[Any, State]:
    """A problem's system in floats, and its start, which is already in doubles."""
    q, p = np.split(problem.y0, 2)
    return problem.system, State(tuple(q.tolist()), tuple(p.tolist()), tilted=True)


def _method(method: Any) -> Callable[[Problem, np.ndarray, float], Timed]:
    def run(problem: Problem, times: np.ndarray, setting: float) -> Timed:
        value = setting * problem.time_scale if method.parameter == "step" else setting
        spent, solution = timed_run(method, problem_of(*_given(problem)), times.tolist(), value)
        return spent, np.hstack([solution.gamma, solution.M])

    return run


def _own(solve: Solve) -> Callable[[Problem, np.ndarray, float], Timed]:
    def run(problem: Problem, times: np.ndarray, tolerance: float) -> Timed:
        begun = perf_counter()
        found = np.asarray(solve(problem, times.copy(), tolerance), dtype=float)
        spent = Spent(0.0, 0.0, 0.0, perf_counter() - begun)
        if found.shape != (len(times), len(problem.y0)):
            raise ArgumentError(
                f"the function returned an array of shape {found.shape}; {(len(times), len(problem.y0))} is needed, a "
                "state for each time"
            )
        return spent, found

    return run


def _package(problem: Problem, times: np.ndarray, _: float) -> Timed:
    """Runs the package's own flow in floats, and returns the seconds spent and the states."""
    begun = perf_counter()
    moving = problem.motion
    made = perf_counter()
    rows = moving.rows(times.tolist(), FLOAT_DIGITS)
    return Spent(0.0, made - begun, 0.0, perf_counter() - made), np.array(rows, dtype=float)
