"""The progress reports of long computations."""

import logging

import pytest

from jacobian import GF, HyperellipticCurve, progress
from jacobian.fields.irreducible import first_irreducible


def test_a_long_rest_is_a_warning_at_first(caplog, monkeypatch):
    for name in ("FIRST", "LONG", "SAID_AGAIN"):
        monkeypatch.setattr(progress, name, 0.0)
    going = progress.Progress("a sum", 4, (1, 2))
    with caplog.at_level(logging.INFO, "jacobian.progress"):
        going.add(1)
        going.add(3)
    assert [record.levelno for record in caplog.records] == [logging.WARNING, logging.INFO]
    assert caplog.records[0].getMessage().startswith("a sum: 62 % done, about ")
    assert caplog.records[1].getMessage() == "a sum: 100 % done, about 0 s left"


def test_a_short_rest_says_nothing(caplog):
    going = progress.Progress("a sum", 2)
    going.add(1), going.add(1)
    assert not caplog.records


def test_what_takes_longer_than_it_seemed_is_a_warning_too(caplog, monkeypatch):
    """A search whose end always seemed near used to run without any message."""
    monkeypatch.setattr(progress, "perf_counter", iter([0.0, 1.0, 7.0, 20.0]).__next__)
    going = progress.Progress("a search", 10)
    with caplog.at_level(logging.INFO, "jacobian.progress"):
        for _ in range(3):
            going.add(3)
    assert [record.levelno for record in caplog.records] == [logging.INFO, logging.WARNING, logging.INFO]


LONG = {
    "an irreducible polynomial of degree 61 over GF(3): ": lambda: first_irreducible(GF(3), 61),
    "the classes of y^2 = x^5 + 1 over GF(7): ": lambda: list(
        HyperellipticCurve(GF(7), [1, 0, 0, 0, 0, 1]).jacobian().points()
    ),
    "the points of y^2 = x^5 + 1 over GF(7): ": lambda: list(HyperellipticCurve(GF(7), [1, 0, 0, 0, 0, 1]).points()),
}


@pytest.mark.parametrize("name", LONG)
def test_long_calls_say_how_long(name, caplog, monkeypatch):
    for constant in ("FIRST", "LONG", "SAID_AGAIN"):
        monkeypatch.setattr(progress, constant, 0.0)
    LONG[name]()
    assert caplog.records[0].getMessage().startswith(name)
    assert caplog.records[0].getMessage().endswith(" s left")
