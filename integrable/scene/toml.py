"""One table of a TOML file, read strictly: an undeclared key or a value of another type is an error.

Each message is one line of the form ``scene ball.toml: [body] d: -1 given; …``. It names the place, the key, the value
and what is accepted.
"""

from __future__ import annotations

import contextlib
import difflib
import re
from collections.abc import Iterable, Mapping, Sequence
from decimal import Decimal
from fractions import Fraction
from typing import Any

from jacobian.errors import ArgumentError, shortened, shown

__all__ = ["Table", "exact_number", "suggestion"]

_MISSING: Any = object()
LARGEST_INTEGER = 10**300
# exponents of more than three digits are refused, since the exact fraction would have over 1000 digits
_NUMBER = re.compile(r"[+-]?(\d+/\d+|(\d+\.?\d*|\.\d+)([eE][+-]?\d{1,3})?)")


def suggestion(word: str, known: Iterable[str]) -> str:
    """A hint for a misspelt word: ``did you mean "x"? `` if a known word is close, then the list of known words."""
    known = list(known)
    close = difflib.get_close_matches(word, known, n=1, cutoff=0.6)
    meant = f'did you mean "{close[0]}"? ' if close else ""
    return f"{meant}(known: {', '.join(known)})"


class Table:
    """A TOML table and its place in the file, for messages. A key that is not in ``known`` raises ArgumentError.

    ``place`` is the file and the table, such as ``scene ball.toml: [body]``. Numbers are returned as exact fractions,
    whether written as 0.7, "0.7" or "1/3" (parse floats with ``parse_float=Decimal``).
    """

    def __init__(self, place: str, content: Any, known: Iterable[str]) -> None:
        if not isinstance(content, Mapping):
            raise ArgumentError(f"{place}: {_shown(content)} given; a table is needed")
        self.place = place
        self.content = content
        self.known = list(known)
        for key in content:
            if key not in self.known:
                self.fail(key, f"unknown key; {suggestion(key, self.known)}")

    def __contains__(self, key: str) -> bool:
        return key in self.content

    def fail(self, key: str, why: str) -> Any:
        """Raise ArgumentError with the place and the key in front of ``why``."""
        raise ArgumentError(f"{self.place} {key}: {why}")

    def _get(self, key: str, default: Any, needed: str) -> Any:
        if default is _MISSING and key not in self.content:
            self.fail(key, f"missing; {needed} is needed")
        return self.content.get(key, default)

    def text(self, key: str, default: str) -> str:
        """The string under ``key``, ``default`` if the key is missing."""
        value = self.content.get(key, default)
        return value if isinstance(value, str) else self.fail(key, f"{_shown(value)} given; a string is needed")

    def flag(self, key: str) -> bool:
        """The Boolean under ``key``, False if the key is missing."""
        value = self.content.get(key, False)
        return value if isinstance(value, bool) else self.fail(key, f"{_shown(value)} given; true or false is needed")

    def choice(self, key: str, choices: Iterable[str], default: str = _MISSING) -> str:
        """The string under ``key``, one of ``choices``."""
        choices = list(choices)
        value = self._get(key, default, "one of " + ", ".join(choices))
        return value if value in choices else self._unknown(key, value, choices)

    def choices(self, key: str, choices: Sequence[str]) -> tuple[str, ...]:
        """The different strings in the list under ``key``, each one of ``choices``; () if the key is missing."""
        chosen = self._list(key, self.content.get(key, []))
        for item in chosen:
            if item not in choices:
                self._unknown(key, item, choices)
        if len(set(chosen)) != len(chosen):
            self.fail(key, f"{_shown(chosen)} given; an entry is repeated")
        return tuple(chosen)

    def _unknown(self, key: str, value: Any, choices: Iterable[str]) -> Any:
        given = _shown(value)
        near = suggestion(given.strip('"'), choices)
        return self.fail(key, f"{given} given; {near}")

    def integer(self, key: str, least: int | None, default: int = _MISSING) -> int:
        """The integer under ``key``, not below ``least`` if that is given."""
        value = self._get(key, default, _integer_wanted(least))
        return self._integer(key, value, least)

    def signs(self, key: str) -> tuple[int, ...]:
        """The list of 1 and -1 under ``key``."""
        chosen = self._list(key, self._get(key, _MISSING, "a list of signs"))
        if any(isinstance(item, bool) or item not in (1, -1) for item in chosen):
            self.fail(key, f"{_shown(chosen)} given; a list of signs 1 and -1 is needed")
        return tuple(int(item) for item in chosen)

    def integers(self, key: str, default: tuple[int, ...]) -> tuple[int, ...]:
        """The list under ``key`` of positive integers, ``default`` if the key is missing."""
        return tuple(self._integer(key, item, 1) for item in self._list(key, self.content.get(key, default)))

    def number(self, key: str, default: Fraction = _MISSING) -> Fraction:
        """The finite number under ``key``."""
        return self._number(key, self._get(key, default, "a number"))

    def numbers(
        self, key: str, length: int | None = None, default: tuple[Fraction, ...] = _MISSING
    ) -> tuple[Fraction, ...]:
        """The list of finite numbers under ``key``, of the given ``length`` unless it is None."""
        needed = "a list of numbers" if length is None else f"a list of {length} numbers"
        value = self._get(key, default, needed)
        if not isinstance(value, list | tuple) or (length is not None and len(value) != length):
            self.fail(key, f"{_shown(value)} given; {needed} is needed")
        return tuple(self._number(key, item) for item in value)

    def number_or_numbers(self, key: str) -> Fraction | tuple[Fraction, ...]:
        """The finite number, or the list of finite numbers, under ``key``."""
        value = self._get(key, _MISSING, "a number or a list of numbers")
        return self.numbers(key) if isinstance(value, list) else self.number(key)

    def table(self, key: str, known: Iterable[str]) -> Table:
        """The table under ``key``."""
        return Table(f"{self.place} {key}:", self._get(key, _MISSING, "a table"), known)

    def tables(self, key: str, known: Iterable[str]) -> list[Table]:
        """The list of tables under ``key``; it must not be empty."""
        known = list(known)
        content = self._list(key, self._get(key, _MISSING, "a list of tables"))
        if not content:
            self.fail(key, "[] given; at least one table is needed")
        return [Table(f"{self.place} {key}[{i}]:", item, known) for i, item in enumerate(content)]

    def _list(self, key: str, value: Any) -> list[Any]:
        if not isinstance(value, list | tuple):
            self.fail(key, f"{_shown(value)} given; a list is needed")
        return list(value)

    def _integer(self, key: str, value: Any, least: int | None) -> int:
        if isinstance(value, bool) or not isinstance(value, int) or (least is not None and value < least):
            self.fail(key, f"{_shown(value)} given; {_integer_wanted(least)} is needed")
        if abs(value) >= LARGEST_INTEGER:
            self.fail(key, f"{_shown(value)} given; an integer of 300 digits at most is needed")
        return int(value)

    def _number(self, key: str, value: Any) -> Fraction:
        if isinstance(value, int | str | Decimal | Fraction) and not isinstance(value, bool):
            with contextlib.suppress(ValueError):
                return exact_number(str(value))
        return self.fail(key, f'{_shown(value)} given; a finite number such as 2, 0.7, "0.7" or "1/3" is needed')


def exact_number(text: str) -> Fraction:
    """The number written as 2, 0.7, 7e-1 or 1/3; ValueError for anything else, and beyond 1e±300."""
    if _NUMBER.fullmatch(text):
        with contextlib.suppress(ZeroDivisionError):
            number = Fraction(text)
            if number == 0 or 1e-300 < abs(number) < 1e300:
                return number
    raise ValueError(text)


def _integer_wanted(least: int | None) -> str:
    return "an integer" if least is None else f"an integer ≥ {least}"


def _shown(value: Any) -> str:
    """A TOML value on one line, nearly as in the file."""
    if isinstance(value, list):
        return shortened(f"[{', '.join(_shown(item) for item in value)}]")
    if isinstance(value, str):
        return shortened(f'"{value}"'.replace("\n", "\\n"))
    if isinstance(value, bool):
        return str(value).lower()
    return shown(value) if isinstance(value, int) else shortened(str(value))
