"""Kowalevski's top compared with an integration: its divisors run along a straight line."""

import pytest

from integrable.classical.kowalevski import KowalevskiTop
from jacobian import MP, NotRepresentable
from tests.integrable.classical.rows import integrated
from tests.integrable.ways import constrained, inside


def test_divisors_run_along_a_straight_line() -> None:
    """The pair of the integrated state is the sum of the first pair and T(t)."""
    system = KowalevskiTop(MP(36))
    start = system.state(("12/25", "3/5", "16/25"), ("1/2", "3/4", "-5/4"))
    (found,) = system.line(start, 0.75)
    expected = system.spectral(system.state(*integrated(system, start, 0.75, 24, 14)))
    for a, b in zip(found, expected, strict=True):
        assert max(abs(x - y) for x, y in zip(a, b, strict=True)) < 1e-28 * max(abs(x) for x in b)


def test_floats_are_right_far_away() -> None:
    start = (0.48, 0.6, 0.64), (0.5, 0.75, -1.25)
    rough, fine = (KowalevskiTop(*K).line(KowalevskiTop(*K).state(*s), [1e6, -3.5]) for K, s in states(start))
    for a, b in zip(rough, fine, strict=True):
        for x, y in ((a.u, b.u), (a.v, b.v)):
            assert max(abs(c - float(d)) for c, d in zip(x, y, strict=True)) <= 4e-16 * max(abs(float(d)) for d in y)


def states(start):
    """The same floats over RR and, on the sphere to all digits, over MP."""
    fine = KowalevskiTop(MP(40))
    inner = constrained(fine, inside(fine, KowalevskiTop().state(*start)))
    return ((), start), ((fine.field,), inner)


def test_what_is_not_there_is_refused() -> None:
    system = KowalevskiTop()
    with pytest.raises(NotRepresentable, match="line\\(state, times\\)"):
        system.flow(system.state((1, 0, 0), (0, 1, 0)))
    with pytest.raises(NotRepresentable, match="q = 0"):
        system.divisor(system.state((1, 0, 0), (1, 0, 0)))
