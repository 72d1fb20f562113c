"""Files that are complete or not there: written under another name in the same folder, then moved."""

from __future__ import annotations

import os
import secrets
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from jacobian.errors import ArgumentError, shown

__all__ = ["replacing", "said", "target_of", "whole_file"]


def target_of(path: Any, wanted: str, argument: str = "path") -> Path:
    """``path`` as a Path of a file in a folder that exists; ArgumentError says what is ``wanted``."""
    if not isinstance(path, (str, os.PathLike)) or not _is_a_name(path) or not Path(path).name:
        raise ArgumentError(f"{argument} = {shown(path)}: give {wanted}")
    target = Path(path)
    with said(target, argument):
        # refused here: a name too long for the file system
        target.exists()
        there = target.parent.is_dir()
    if not there:
        raise ArgumentError(
            f"{argument} = {str(path)!r}: give a file in a folder that exists; {str(target.parent)!r} does not"
        )
    return target


@contextmanager
def replacing(target: Path) -> Iterator[Path]:
    """A name beside ``target``, with its suffix, for a file or folder that becomes ``target`` when the block ends, and
    goes when it is left by an exception.
    """
    temporary = target.with_name(f".{target.stem}.{secrets.token_hex(4)}{target.suffix}")
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
            shutil.rmtree(temporary, ignore_errors=True)
        else:
            temporary.unlink(missing_ok=True)


@contextmanager
def whole_file(path: Any, wanted: str) -> Iterator[Path]:
    """:func:`replacing` for a file that a user has named; what the system refuses is one line, an ArgumentError."""
    target = target_of(path, wanted)
    if target.is_dir():
        raise ArgumentError(f"path = {shown(path)}: give {wanted}")
    with said(target), replacing(target) as temporary:
        yield temporary


@contextmanager
def said(target: Path, argument: str = "path") -> Iterator[None]:
    """What the system refuses (a full disk, a folder that cannot be written to), as one line."""
    try:
        yield
    except OSError as error:
        why = error.strerror or " ".join(str(error).split())
        raise ArgumentError(f"{argument} = {str(target)!r} cannot be written: {why}") from error


def _is_a_name(path: Any) -> bool:
    """Whether the file system can hold such a name: no lone surrogates, no NUL."""
    try:
        return b"\0" not in os.fsencode(path)
    except UnicodeEncodeError:
        return False
