"""Output to a terminal: replacements for characters that its encoding lacks, and usage lines that fit its width.

Greek letters and mathematical signs are part of the output, but a terminal or a redirected file may support ASCII or
cp1252 only (Windows, LC_ALL=C). Files that the commands write themselves are always UTF-8.
"""

from __future__ import annotations

import argparse
import codecs
import re
import sys
import unicodedata
from shutil import get_terminal_size
from typing import Any

__all__ = ["CommandParser", "write_anything"]

# characters used in tables are replaced by single characters, since columns are aligned by counting
_PLAIN = {
    **dict(zip("αγδηκλνστφωΓΔΣ", "agdeklnstfwGDS", strict=True)),
    **dict(zip("–—−·×∙“”„’‘│─", '---*x*"""\'\'|-', strict=True)),
    "µ": "u",
    "μ": "u",
    "π": "pi",
    "∞": "inf",
    "∝": "~",
    "≈": "~",
    "≤": "<=",
    "≥": ">=",
    "≠": "!=",
    "±": "+-",
    "√": "sqrt ",
    "∫": "integral ",
    "…": "...",
    "²": "^2",
    "³": "^3",
    "→": "->",
    "∥": "||",
    "½": "1/2",
    "ø": "o",
}


def write_anything() -> None:
    """Lets this process print every text, whatever the encoding of its output; a command calls it first."""
    codecs.register_error("jacobian.plain", _plain)
    stream: Any
    for stream in (sys.stdout, sys.stderr):
        # an error handler that the user chose (PYTHONIOENCODING=ascii:replace) is kept
        own = getattr(stream, "errors", None) in ("strict", "surrogateescape", "backslashreplace")
        if own and hasattr(stream, "reconfigure"):
            stream.reconfigure(errors="jacobian.plain")


def _plain(error: UnicodeError) -> tuple[str, int]:
    if not isinstance(error, UnicodeEncodeError):
        raise error
    return "".join(map(_letter, error.object[error.start : error.end])), error.end


def _letter(letter: str) -> str:
    """ASCII for a letter: its replacement in :data:`_PLAIN`, the letter without accents, or a question mark."""
    if letter in _PLAIN:
        return _PLAIN[letter]
    return unicodedata.normalize("NFKD", letter).encode("ascii", "ignore").decode() or "?"


class CommandParser(argparse.ArgumentParser):
    """An argument parser whose help fits a terminal of 40 columns."""

    def format_usage(self) -> str:
        return _shallow(super().format_usage())

    def format_help(self) -> str:
        usage, blank, rest = super().format_help().partition("\n\n")
        return _shallow(usage) + blank + rest


def _shallow(usage: str) -> str:
    """The usage; if it is wider than the terminal, all lines after the first are indented by four."""
    wide = max(map(len, usage.splitlines())) > get_terminal_size().columns
    return re.sub(r"\n +", "\n    ", usage) if wide else usage
