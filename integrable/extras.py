"""Optional libraries, and the extras that install them."""

from __future__ import annotations

import warnings
from collections.abc import Mapping
from importlib import metadata
from importlib.util import find_spec

from jacobian.errors import ArgumentError

__all__ = ["MissingExtraWarning", "command", "installed", "needed", "version_of", "without"]


class MissingExtraWarning(UserWarning):
    """Warns that a library is not installed, and that the work which needs it is left out."""


def installed(module: str) -> bool:
    """Whether a library is installed. The check does not import it."""
    return find_spec(module) is not None


def version_of(library: str) -> str | None:
    """The version of an installed library; None for one that is not installed."""
    try:
        return metadata.version(library)
    except metadata.PackageNotFoundError:
        return None


def command(extra: str = "app") -> str:
    """The command that installs the libraries of an extra."""
    return f"pip install 'jacobian-integrable[{extra}]'"


def needed(module: str, what: str, extra: str = "app") -> None:
    """Raises ArgumentError if ``what`` needs a library that is not installed."""
    if not installed(module):
        raise ArgumentError(f"{what} needs {module}, which is not installed: {command(extra)}")


def without(uses: Mapping[str, str]) -> set[str]:
    """The missing libraries of the extra ``app``. One warning names them all, so call this before the work.

    ``uses`` maps each library to a description of the work that is left out without it.
    """
    missing = [module for module in uses if not installed(module)]
    if missing:
        left_out = ", ".join(f"{uses[module]} ({module})" for module in missing)
        warnings.warn(f"not installed, so left out: {left_out}; {command()}", MissingExtraWarning, stacklevel=3)
    return set(missing)
