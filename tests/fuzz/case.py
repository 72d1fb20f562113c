"""One random case: a few lines of Python, an oracle that judges their result, and the outcome."""

from __future__ import annotations

import contextlib
import os
import re
import time
import traceback
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from math import inf
from typing import Any

from integrable.study.timing import at_most
from jacobian.errors import ArgumentError, JacobianError

RIGHT, REFUSED, UNJUDGED, WRONG, RAW, SLOW = "right", "refused", "unjudged", "wrong", "raw", "slow"
FAILURES = (WRONG, RAW, SLOW)
# a call is stopped after this multiple of its limit
PATIENCE = 3


class Undecided(Exception):
    """Raised by a judge whose oracle cannot decide, for example beyond its horizon."""


class TooLong(BaseException):
    """Raised by the alarm; not an Exception, so that tested code does not catch it."""


@dataclass(frozen=True)
class Complaint:
    """The objection of a judge to a value: ``expected`` and ``check`` are expressions; ``check``, in terms of got and
    expected, ought to be true.
    """

    why: str
    expected: str
    check: str


Judge = Callable[[dict[str, Any]], "Complaint | None"]


@dataclass(frozen=True)
class Case:
    """``setup`` and then ``call`` are the lines that a user would write; ``judge`` receives all names that are bound
    afterwards, with the value of the call as ``got``. ``refusals``: errors that the call may raise. ``limit``: seconds;
    ``misuse``: seconds within which an ArgumentError has to be raised, if fewer.

    ``given``: names that are bound already, instead of running ``setup``. ``message``: what is wrong about the message
    of a refusal, if anything. ``memory``: bytes that the call may take."""

    setup: str
    call: str
    judge: Judge
    refusals: tuple[type[Exception], ...] = (JacobianError,)
    limit: float = 1.0
    given: Mapping[str, Any] | None = None
    message: Callable[[Exception], str | None] = lambda error: None
    memory: int | None = None
    misuse: float = inf


@dataclass(frozen=True)
class Outcome:
    """The outcome of a case: one of the words above, the reason, and for a failure the program that reproduces it."""

    word: str
    why: str = ""
    program: str = ""
    seconds: float = field(default=0.0, compare=False)


def run(case: Case) -> Outcome:
    """Runs and judges a case. An answer that exceeds its limit is computed once more, since the first call may have
    compiled something.
    """
    outcome = _run(case)
    return _run(case) if outcome.word == SLOW and outcome.seconds < PATIENCE * case.limit else outcome


def _run(case: Case) -> Outcome:
    names, most = dict(case.given or {}), PATIENCE * case.limit
    wall, own = time.perf_counter(), time.process_time()

    def taken() -> float:
        return min(time.perf_counter() - wall, time.process_time() - own)

    try:
        # seconds of this process; where it only waits, twenty times as many
        with at_most(most, TooLong(), busy=True), at_most(20 * most, TooLong()), _bounded(case.memory):
            if case.given is None:
                exec(compile(case.setup, "<set-up>", "exec"), names)
            names["got"] = eval(compile(case.call, "<call>", "eval"), names)
    except TooLong:
        return Outcome(SLOW, f"stopped after {most:.0f} s", _program(case, "no answer"), taken())
    except case.refusals as error:
        if taken() > (min(case.misuse, case.limit) if isinstance(error, ArgumentError) else case.limit):
            return Outcome(SLOW, f"refused after {taken():.1f} s: {error}", _program(case, _first(error)), taken())
        if fault := case.message(error):
            return Outcome(WRONG, f"{type(error).__name__}, {fault}", _program(case, _first(error)), taken())
        return Outcome(REFUSED, reason(error), seconds=taken())
    except Exception as error:
        return Outcome(RAW, f"{reason(error)} in {_place(error)}", _program(case, _first(error)), taken())
    seconds = taken()
    if seconds > case.limit:
        return Outcome(SLOW, f"{seconds:.1f} s", _program(case, f"an answer after {seconds:.1f} s"), seconds)
    return _judged(case, names, seconds)


def _judged(case: Case, names: dict[str, Any], seconds: float) -> Outcome:
    try:
        complaint = case.judge(names)
    except Undecided as error:
        return Outcome(UNJUDGED, str(error), seconds=seconds)
    except Exception as error:
        complaint = Complaint(f"the judge failed: {_first(error)} in {_place(error)}", "None", "False")
    if complaint is None:
        return Outcome(RIGHT, seconds=seconds)
    lines = [
        case.setup.strip(),
        f"got = {case.call}",
        f"expected = {complaint.expected}",
        f"assert {complaint.check}, got",
    ]
    return Outcome(WRONG, complaint.why, "\n".join(lines), seconds)


@contextlib.contextmanager
def _bounded(memory: int | None) -> Iterator[None]:
    """MemoryError instead of a machine that swaps, where the platform has such limits (Linux)."""
    if memory is None or not os.path.exists("/proc/self/statm"):
        yield
        return
    import resource

    with open("/proc/self/statm") as file:
        used = int(file.read().split()[0]) * resource.getpagesize()
    before = resource.getrlimit(resource.RLIMIT_AS)
    resource.setrlimit(resource.RLIMIT_AS, (used + memory, before[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_AS, before)


def reason(error: BaseException) -> str:
    """The class and the first words of an error without its numbers, so that each kind of refusal has one text."""
    text = re.sub(r"[-−]?\d[\w.+-]*", "#", str(error).split("\n")[0])
    text = re.sub(r"(#[,; )]*\s*)+", "# ", text)
    return f"{type(error).__name__}: {' '.join(text.split()[:9])}"


def _program(case: Case, got: str) -> str:
    return f"{case.setup.strip()}\ngot = {case.call}\n# expected: an answer or a refusal by name, at once; got {got}"


def _first(error: BaseException) -> str:
    return f"{type(error).__name__}: {str(error).splitlines()[0][:150] if str(error) else ''}"


def _place(error: BaseException) -> str:
    frames = traceback.extract_tb(error.__traceback__)
    inside = [frame for frame in frames if not frame.filename.startswith("<")] or frames
    return f"{inside[-1].filename.rsplit('/', 1)[-1]}:{inside[-1].lineno}"
