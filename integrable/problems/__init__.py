"""Initial value problems whose solution is known at any time, for testing integrators: :func:`problem`.

    from integrable.problems import problem
    top = problem("t_handle")
    found = my_solver(top.rhs, top.y0, [1.0, 100.0])
    abs(found - top.truth([1.0, 100.0]).y)

A user of problems need not know the rest of the package. Problems are scenes (:mod:`integrable.scenes`): the twelve of
:func:`problem_names` have a reference, and any other scene of a motion of a body or of a system of
:mod:`integrable.classical` is a problem too.
"""

from integrable.problems.catalogue import problem, problem_names
from integrable.problems.statement import Problem, Truth

__all__ = ["Problem", "Truth", "problem", "problem_names"]
