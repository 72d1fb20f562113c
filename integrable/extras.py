"""Libraries that this package does without where they are not installed, and which extra installs them."""

from __future__ import annotations

import warnings
from collections.abc import Mapping
from importlib.util import find_spec

from jacobian.errors import ArgumentError

__all__ = ["APP", "MissingExtraWarning", "command", "installed", "needed", "without"]

APP = ("scipy", "matplotlib", "tqdm")
"""What the extra ``app`` installs."""


class MissingExtraWarning(UserWarning):
    """A library is not installed, and what it does is left out."""


def installed(module: str) -> bool:
    """Whether a library is installed; it is not imported."""
    return find_spec(module) is not None


def command(extra: str = "app") -> str:
    """What installs the libraries of an extra."""
    return f"pip install 'jacobian-integrable[{extra}]'"


def needed(module: str, what: str, extra: str = "app") -> None:
    """ArgumentError where a library of an extra is not installed that ``what`` cannot do without."""
    if not installed(module):
        raise ArgumentError(f"{what} needs {module}, which is not installed: {command(extra)}")


def without(uses: Mapping[str, str]) -> set[str]:
    """Which of these libraries of the extra ``app`` are not installed, said in one warning: call it before the work.

    ``uses`` says in words what is left out without each.
    """
    missing = [module for module in uses if not installed(module)]
    if missing:
        left_out = ", ".join(f"{uses[module]} ({module})" for module in missing)
        warnings.warn(f"not installed, so left out: {left_out}; {command()}", MissingExtraWarning, stacklevel=3)
    return set(missing)
