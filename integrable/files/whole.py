"""Files that are either complete or absent. They are written under another name in the same folder, then renamed."""

from __future__ import annotations

import errno
import io
import secrets
import shutil
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from jacobian.element import File
from jacobian.errors import ArgumentError, names_a_file, shown

__all__ = ["Patient", "discarded", "reason", "replacing", "said", "target_of", "whole_file"]

FULL = {
    errno.ENOSPC: "the disk is full",
    errno.EDQUOT: "the quota of the disk is used up",
    errno.EFBIG: "the file would be larger than the limit that the system sets (ulimit -f)",
}
"""The meanings of the system's errors for lack of disk space."""
# seconds before each attempt to remove a folder; a write of zarr's that is under way takes milliseconds
PAUSES = (0.0, 0.05, 0.2)


def target_of(path: File, wanted: str, argument: str = "path") -> Path:
    """``path`` as a Path. ArgumentError if it names no file (the message asks for ``wanted``), or if its folder is
    missing.
    """
    if not names_a_file(path):
        raise ArgumentError(f"{argument} = {shown(path)}: give {wanted}")
    target = Path(path)
    with said(target, argument):
        # the result is not used; the call raises an OSError if the name is too long for the file system
        target.exists()
        there = target.parent.is_dir()
    if not there:
        raise ArgumentError(
            f"{argument} = {shown(str(path))}: give a file in a folder that exists; {shown(str(target.parent))} does "
            "not"
        )
    return target


@contextmanager
def replacing(target: Path, folder: Path | None = None) -> Iterator[Path]:
    """A temporary name with the suffix of ``target``, in its folder or in another ``folder`` on the same disk.

    When the block ends, the file or folder of that name becomes ``target``. If the block raises an exception, the file
    or folder is removed instead.
    """
    temporary = (folder or target.parent) / f".{target.stem}.{secrets.token_hex(4)}{target.suffix}"
    try:
        yield temporary
        if target.is_dir() and temporary.is_dir():
            aside = target.with_name(f"{temporary.name}.old")
            target.replace(aside)
            temporary.replace(target)
            shutil.rmtree(aside, ignore_errors=True)
        else:
            temporary.replace(target)
    finally:
        if temporary.is_dir():
            discarded(temporary)
        else:
            temporary.unlink(missing_ok=True)


def discarded(folder: Path) -> None:
    """Removes a folder in which writing has failed. After an error zarr's other threads may still write, and would make
    the folder again, so it is removed repeatedly.
    """
    for pause in PAUSES:
        time.sleep(pause)
        shutil.rmtree(folder, ignore_errors=True)


@contextmanager
def whole_file(path: File, wanted: str) -> Iterator[Path]:
    """:func:`replacing` for a file named by the user. System errors become an ArgumentError of one line."""
    target = target_of(path, wanted)
    if target.is_dir():
        raise ArgumentError(f"path = {shown(path)}: give {wanted}")
    with said(target), replacing(target) as temporary:
        yield temporary


@contextmanager
def said(target: Path, argument: str = "path") -> Iterator[None]:
    """Turns an OSError in the block (full disk, read-only folder) into an ArgumentError of one line."""
    try:
        yield
    except OSError as error:
        raise ArgumentError(f"{argument} = {str(target)!r} cannot be written: {reason(error)}") from error


def reason(error: OSError) -> str:
    """The reason of an OSError, in one line, which names a full disk, quota or limit."""
    why = error.strerror or " ".join(str(error).split())
    return f"{why}: {FULL[error.errno]}" if error.errno in FULL else why


class Patient(io.FileIO):
    """A file whose ``write`` never fails, for libraries such as HDF5 that crash when a write fails.

    The first system error is stored in ``error``; from then on nothing is written.
    """

    def __init__(self, path: Path) -> None:
        super().__init__(path, "w+")
        self.error: BaseException | None = None

    def write(self, content: Any) -> int:
        view, begin = memoryview(content).cast("B"), self.tell()
        self._try(lambda: self._write_all(view))
        self.seek(begin + len(view))
        return len(view)

    def readinto(self, place: Any) -> int:
        view, begin = memoryview(place).cast("B"), self.tell()
        found = super().readinto(view) or 0
        view[found:] = bytes(len(view) - found)
        self.seek(begin + len(view))
        return len(view)

    def truncate(self, size: int | None = None) -> int:
        wanted = self.tell() if size is None else size
        self._try(lambda: super(Patient, self).truncate(wanted))
        return wanted

    def _write_all(self, view: memoryview) -> None:
        while len(view):
            # the system writes fewer bytes than requested if space runs out
            view = view[super().write(view) :]

    def _try(self, act: Callable[[], object]) -> None:
        if self.error is None:
            try:
                act()
            except (OSError, KeyboardInterrupt) as error:
                self.error = error
