"""What long computations say of themselves."""

import logging

from jacobian import progress


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
