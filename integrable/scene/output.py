"""The output folder of a run, and the JSON of a result.

The folder is tested before the run, and never holds a partial file.
"""

from __future__ import annotations

import json
import os
import platform
import tempfile
from pathlib import Path
from typing import Any

from integrable.extras import version_of
from integrable.files.whole import FULL, reason, replacing
from integrable.scene.data import Scene, plain
from jacobian.errors import ArgumentError

__all__ = ["SCHEMA", "OutputFolder", "as_json", "machine", "portable", "result", "versions"]

SCHEMA = 1
"""Version of the layout of ``result.json``; increased when a reader of the old layout would misread the new one."""


class OutputFolder:
    """A context manager for an output folder, to which each file is written completely or not at all.

    On entry it makes the folder and tries to write in it; ArgumentError if that fails. If an exception leaves the
    block, the folders it made are removed, unless something was written there.
    """

    def __init__(self, path: str | Path) -> None:
        self.path = Path(path)
        self._made: list[Path] = []

    def __enter__(self) -> OutputFolder:
        try:
            missing = [folder for folder in (self.path, *self.path.parents) if not folder.exists()]
            for folder in reversed(missing):
                folder.mkdir(exist_ok=True)
                self._made.append(folder)
            with tempfile.TemporaryFile(dir=self.path):
                pass
        except OSError as error:
            self._remove_made()
            raise _unwritable(self.path, error) from None
        return self

    def __exit__(self, kind: type[BaseException] | None, *_: object) -> None:
        if kind is not None:
            self._remove_made()

    def _remove_made(self) -> None:
        for folder in reversed(self._made):
            try:
                folder.rmdir()
            except OSError:  # not empty: it holds files of the user
                return

    def write_text(self, name: str, text: str) -> Path:
        """Writes a UTF-8 text file, completely or not at all."""
        # the text may contain a file name whose undecodable bytes are surrogates
        return self.write_bytes(name, text.encode(errors="surrogateescape").decode(errors="replace").encode())

    def write_bytes(self, name: str, content: bytes) -> Path:
        """Writes a file under a temporary name in the same folder, then renames it to ``name``."""
        try:
            with replacing(self.path / name) as temporary:
                temporary.write_bytes(content)
        except OSError as error:
            raise _unwritable(self.path / name, error) from error
        return self.path / name


def portable(name: str) -> str:
    """A file or folder name that every operating system accepts. A name that already is one stays unchanged.

    Windows has the strictest rules.
    """
    safe = "".join("_" if c in '<>:"/\\|?*' or ord(c) < 32 else c for c in name).rstrip(". ")
    return f"_{safe}" if safe.partition(".")[0].strip().lower() in _RESERVED else safe


_RESERVED = {"", "con", "prn", "aux", "nul", *(f"{port}{n}" for port in ("com", "lpt") for n in range(10))}


def _unwritable(path: Path, error: OSError) -> ArgumentError:
    hint = "" if error.errno in FULL else "; a folder to write in is needed"
    return ArgumentError(f'out: "{path}" cannot be written: {reason(error)}{hint}')


def result(scene: Scene, digits: int, trajectory: Any, curve: Any) -> dict[str, Any]:
    """The result of a run, ready for JSON: the trajectory, the report, the drawn curve, and the machine.

    Floats stay numbers; multiprecision numbers are decimal strings.
    """
    names = ("q", "p") if scene.classical else ("gamma", "M")
    return {
        "schema": SCHEMA,
        "scene": scene.describe(),
        "versions": versions(),
        "machine": machine(),
        "digits": digits,
        "trajectory": _arrays(trajectory, ("times" if scene.steps is None else "steps", *names)),
        "report": trajectory.report.as_dict() if trajectory.report is not None else None,
        "sphere": _arrays(curve, ("times", names[0])) if curve is not None and scene.steps is None else None,
    }


def as_json(content: dict[str, Any]) -> str:
    """``content`` as JSON, one line for each top-level key; NaN and infinities are refused with ValueError."""
    entries = (
        f"{json.dumps(key)}: {json.dumps(value, ensure_ascii=False, allow_nan=False)}" for key, value in content.items()
    )
    return "{\n" + ",\n".join(entries) + "\n}\n"


def _arrays(trajectory: Any, names: tuple[str, ...]) -> dict[str, Any]:
    return {name: plain(getattr(trajectory, name)) for name in names}


def versions() -> dict[str, str | None]:
    """The versions of Python, of this package and of the libraries that may affect a result; None for a library that is
    not installed.
    """
    names = "jacobian-integrable", "numpy", "numba", "scipy", "mpmath", "matplotlib", "gmpy2", "python-flint", "heyoka"
    return {"python": platform.python_version()} | {name: version_of(name) for name in names}


def machine() -> dict[str, Any]:
    """Operating system, processor and number of cores."""
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        lines = []
    models = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
    model = models[0] if models else platform.processor()
    return {"system": platform.platform(), "processor": model, "cores": os.cpu_count()}
