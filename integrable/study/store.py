"""The folder of a study: one complete JSON file per finished row, and a lock for each row in progress.

Locks are those of the operating system (:mod:`filelock`), which releases them if their process dies.
"""

from __future__ import annotations

import json
import subprocess
from functools import lru_cache
from hashlib import sha256
from pathlib import Path
from typing import Any

from filelock import FileLock, Timeout

from integrable.scene.output import OutputFolder, as_json

__all__ = ["SCHEMA", "Store", "code_stamp", "commit"]

SCHEMA = 2
"""Version of the layout of a row's file; increased when a reader of the old layout would misread the new one."""
_SHOWN_ONLY = (
    "__main__.py", "doctor.py", "interrupts.py", "owner.py", "scene/tables.py", "study/claims.py", "study/columns.py",
    "study/figures.py", "study/findings.py", "study/page.py", "study/plot.py", "view/__init__.py", "view/ovals.py",
    "view/page.py", "view/shown.py",
)  # fmt: skip
"""Files of a package that a row does not depend on, by their path in the package; a test checks that they exist."""


class Store:
    """Rows of a study in a folder. A row has a key, which names its file, and a stamp of everything it depends on."""

    def __init__(self, folder: str | Path) -> None:
        self.path = Path(folder)
        self._rows, self._locks = self.path / "rows", self.path / "locks"
        for part in (self._rows, self._locks):
            with OutputFolder(part):
                pass

    def read(self, key: str, stamp: str) -> dict[str, Any] | None:
        """The finished row with that key, or None if it is missing or its stamp differs (older code, another scene).

        A damaged file (cut short by a full disk, edited) counts as missing.
        """
        try:
            content = json.loads((self._rows / f"{key}.json").read_text(encoding="utf-8"))
        except (OSError, ValueError):
            return None
        if not isinstance(content, dict) or content.get("stamp") != stamp or content.get("schema") != SCHEMA:
            return None
        return content

    def write(self, key: str, stamp: str, content: dict[str, Any]) -> dict[str, Any]:
        """Stores a row and returns it. A file of that row is replaced as a whole."""
        kept = {"schema": SCHEMA, "stamp": stamp, **content}
        with OutputFolder(self._rows) as folder:
            folder.write_text(f"{key}.json", as_json(kept))
        return kept

    def claim(self, key: str) -> FileLock | None:
        """The lock of a row, or None if another process holds it. It is held until it is released, or is no longer
        referenced.
        """
        lock = FileLock(self._locks / f"{key}.lock", mode=0o666)
        try:
            lock.acquire(blocking=False)
        except Timeout:
            return None
        return lock


@lru_cache(maxsize=1)
def commit() -> str | None:
    """The commit of these sources, with "+" if they have been changed; None without git."""
    here = Path(__file__).parents[2]
    if not (here / ".git").exists():
        return None
    git = ["git", "-C", str(here)]
    try:
        name = subprocess.run([*git, "rev-parse", "--short=12", "HEAD"], capture_output=True, text=True, check=True)
        changed = subprocess.run([*git, "status", "--porcelain", "-uno"], capture_output=True, text=True, check=True)
    except (OSError, subprocess.CalledProcessError):
        return None
    return name.stdout.strip() + ("+" if changed.stdout.strip() else "")


@lru_cache(maxsize=1)
def code_stamp() -> str:
    """A hash of the sources of both packages, except those that only show results."""
    import integrable
    import jacobian

    digest = sha256()
    for package in (integrable, jacobian):
        root = Path(str(package.__file__)).parent
        for path in sorted(root.rglob("*.py")):
            name = path.relative_to(root).as_posix()
            if name not in _SHOWN_ONLY:
                digest.update(name.encode())
                digest.update(path.read_bytes())
    return digest.hexdigest()[:16]
