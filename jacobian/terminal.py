"""Output to a terminal, with replacements for characters that its encoding lacks.

Greek letters and mathematical signs are part of the output, but a terminal or a redirected file may know ASCII or
cp1252 only (Windows, LC_ALL=C). Files that the commands write themselves are always UTF-8.
"""

from __future__ import annotations

import codecs
import sys
import unicodedata
from typing import Any

__all__ = ["write_anything"]

# characters of tables have one character each: columns are aligned by counting them
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
    """Let this process print every text, whatever the encoding of its output; a command calls it first."""
    codecs.register_error("jacobian.plain", _plain)
    for stream in (sys.stdout, sys.stderr):
        # an error handler that the user chose (PYTHONIOENCODING=ascii:replace) stays
        if getattr(stream, "errors", None) in ("strict", "surrogateescape", "backslashreplace"):
            _reconfigure(stream)


def _reconfigure(stream: Any) -> None:
    if hasattr(stream, "reconfigure"):
        stream.reconfigure(errors="jacobian.plain")


def _plain(error: UnicodeError) -> tuple[str, int]:
    if not isinstance(error, UnicodeEncodeError):
        raise error
    return "".join(map(_letter, error.object[error.start : error.end])), error.end


def _letter(letter: str) -> str:
    """ASCII for a letter: its name in :data:`_PLAIN`, the letter without accents, or a question mark."""
    if letter in _PLAIN:
        return _PLAIN[letter]
    return unicodedata.normalize("NFKD", letter).encode("ascii", "ignore").decode() or "?"
