"""Which distribution owns the package ``jacobian``: PyPI has another one with a package of this name.

If both are installed into one folder, the later installation overwrites files of the earlier one.
"""

from __future__ import annotations

import os

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Iterator

__all__ = ["REMEDY", "ForeignFiles", "beside", "installed", "say"]

OWN, PACKAGE = "jacobian-integrable", "jacobian"
REMEDY = f"pip uninstall {PACKAGE}, then pip install --force-reinstall --no-deps {OWN}"


class ForeignFiles(UserWarning):
    """Another distribution has a package ``jacobian`` in the same folder: one has overwritten files of the other."""


def say() -> None:
    """Warns in one line where another distribution is in the folder of this package."""
    for other in beside(os.path.dirname(os.path.dirname(__file__))):
        import warnings

        text = (
            f"{other} has a package {PACKAGE} in the same folder as {OWN}: files of one overwrite the other's; {REMEDY}"
        )
        warnings.warn(text, ForeignFiles, stacklevel=3)


def beside(folder: str) -> Iterator[str]:
    """Yields the name and the version of each distribution of the name ``jacobian`` in a folder, from file names."""
    try:
        names = os.listdir(folder)
    except OSError:
        return
    for name in names:
        if name.startswith(f"{PACKAGE}-") and name.endswith((".dist-info", ".egg-info")):
            yield " ".join(name.rpartition(".")[0].split("-")[:2])


def installed() -> list[str]:
    """The name, the version and the folder of each other distribution that has a package ``jacobian``."""
    from importlib import metadata

    found = set()
    for one in metadata.distributions():
        name = one.metadata["Name"] or ""
        roots = {str(file).partition("/")[0] for file in one.files or ()}
        roots |= set((one.read_text("top_level.txt") or "").split())
        if name.lower().replace("_", "-") != OWN and (PACKAGE in roots or name.lower() == PACKAGE):
            found.add(f"{name} {one.version} in {one.locate_file('')}")
    return sorted(found)
