"""Roots of polynomials whose coefficients determine them to fewer digits than the numbers have."""

from __future__ import annotations

from typing import Any

import pytest

from jacobian import MP
from jacobian.periods import roots
from jacobian.periods.quadrature import working_numbers


@pytest.mark.parametrize("distances", ["even", "pairs"])
def test_the_search_ends_where_changes_are_rounding_errors(distances: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """It ran for 500 rounds, as rounding errors exceeded the tolerance: 3 s for a Toda lattice of eight particles."""
    numbers, horner, count = working_numbers(MP(50)), roots.horner, 0
    true = [numbers.convert(k if distances == "even" else k // 2 + k % 2 * 1e-3) for k in range(2, 12)]
    a: list[Any] = [numbers.convert(1)]
    for e in true:
        a = [low - e * x for low, x in zip([0, *a], [*a, 0], strict=True)]

    def counted(a: Any, z: Any) -> Any:
        nonlocal count
        count += 1
        return horner(a, z)

    monkeypatch.setattr(roots, "horner", counted)
    found = sorted(roots.simple_roots(numbers, a), key=lambda x: x.real)
    assert max(abs(x - e) for x, e in zip(found, true, strict=True)) < 1e-15
    assert count < 2 * 10 * 100
