"""Many cases one after the other: counts, the first failure, several processes."""

from __future__ import annotations

import time
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from contextlib import chdir
from dataclasses import dataclass, field, replace
from functools import cache
from itertools import count, islice
from random import Random
from tempfile import TemporaryDirectory
from traceback import format_exception
from typing import Any, Protocol

from tests.fuzz.case import FAILURES, RAW, REFUSED, RIGHT, SLOW, UNJUDGED, WRONG, Case, Outcome, run

WORDS = (RIGHT, REFUSED, UNJUDGED, WRONG, RAW, SLOW)
# largest number of reasons listed per kind; a run of the suite "calls" has thousands
REASONS = 8
SHOWN = {REFUSED: "refused by name", RAW: "raw exceptions", SLOW: "over the time limit"}


class Maker(Protocol):
    """A function that makes a case of one kind from random numbers."""

    def __call__(self, rng: Random) -> Case: ...


@dataclass(frozen=True)
class Suite:
    """``kinds``: the makers by kind; ``shares``: how many cases of a kind a round has, 1 by default. ``warm``: lines
    that are run once, without a time limit, before the cases of a kind ("" stands for every kind); compiled code is
    made or loaded there, since an alarm during compilation would leave numba in an inconsistent state.
    """

    name: str
    kinds: Mapping[str, Maker]
    shares: Mapping[str, int] = field(default_factory=dict)
    warm: Mapping[str, str] = field(default_factory=dict)

    def warmed(self, kinds: Sequence[str] = ()) -> None:
        """Runs the ``warm`` lines of these kinds, or of all, once per process."""
        for kind, text in self.warm.items():
            if not kind or not kinds or kind in kinds:
                _warm(text)

    def kind_of(self, index: int, kinds: Sequence[str]) -> str:
        """The kind of a case: cases come in rounds of all kinds, or of the chosen ones, in which each has its share."""
        order = _round(tuple((kind, self.shares.get(kind, 1)) for kind in self.kinds if not kinds or kind in kinds))
        return order[index % len(order)]

    def case(self, seed: Any, kind: str, index: int) -> Case:
        """Case ``index`` of a kind: a function of its arguments alone, on every machine."""
        return self.kinds[kind](Random(f"{self.name} {seed} {kind} {index}"))


@cache
def _round(shares: tuple[tuple[str, int], ...]) -> list[str]:
    """Each kind as often as its share, evenly mixed."""
    order = [kind for kind, share in shares for _ in range(share)]
    return Random(0).sample(order, len(order))


@cache
def _warm(text: str) -> None:
    exec(compile(text, "<warm-up>", "exec"), {})


@dataclass
class Tally:
    """How the cases of a run ended, by kind and by reason, and the failures."""

    counts: Counter[tuple[str, str]] = field(default_factory=Counter)
    reasons: Counter[tuple[str, str, str]] = field(default_factory=Counter)
    failures: list[str] = field(default_factory=list)
    slowest: float = 0.0
    seconds: float = 0.0

    def take(self, kind: str, outcome: Outcome, header: str) -> None:
        self.counts[kind, outcome.word] += 1
        self.slowest = max(self.slowest, outcome.seconds)
        if outcome.word != RIGHT:
            self.reasons[kind, outcome.word, outcome.why] += outcome.word in (REFUSED, UNJUDGED)
        if outcome.word in FAILURES:
            self.failures.append(f"# {header}: {outcome.word}, {outcome.why}\n{outcome.program}")

    def add(self, other: Tally) -> None:
        self.counts += other.counts
        self.reasons += other.reasons
        self.failures += other.failures
        self.slowest = max(self.slowest, other.slowest)

    def of(self, word: str, kind: str | None = None) -> int:
        """The number of cases (of a kind) with this outcome."""
        return sum(n for (k, w), n in self.counts.items() if w == word and kind in (None, k))

    @property
    def failed(self) -> bool:
        return any(self.of(word) for word in FAILURES)

    def line(self) -> str:
        """All counts in one line: the sums, then the kinds, each with the first reasons for cases that were not judged;
        data() has all reasons.
        """
        total = sum(self.counts.values())
        sums = ", ".join(f"{self.of(word)} {SHOWN.get(word, word)}" for word in WORDS)
        kinds = dict.fromkeys(kind for kind, _ in self.counts)
        parts = [f"{total} cases in {self.seconds:.0f} s, the slowest {self.slowest:.2f} s: {sums}"]
        return " | ".join([*parts, *(self._of_kind(kind) for kind in kinds)])

    def _of_kind(self, kind: str) -> str:
        words = [f"{self.of(word, kind)} {word}" for word in WORDS if self.of(word, kind)]
        reasons = [f"{n} {why}" for (k, _, why), n in self.reasons.most_common() if k == kind and n]
        reasons[REASONS:] = [f"{len(reasons) - REASONS} more reasons"] if len(reasons) > REASONS else []
        return f"{kind}: {', '.join(words)}" + (f" ({'; '.join(reasons)})" if reasons else "")

    def data(self) -> dict[str, Any]:
        """The same counts for a JSON file."""
        kinds = dict.fromkeys(kind for kind, _ in self.counts)
        return {
            "cases": sum(self.counts.values()),
            "seconds": round(self.seconds, 1),
            "slowest": round(self.slowest, 3),
            "totals": {word: self.of(word) for word in WORDS},
            "kinds": {
                kind: {
                    **{word: self.of(word, kind) for word in WORDS},
                    "reasons": {f"{w}: {why}": n for (k, w, why), n in self.reasons.most_common() if k == kind and n},
                }
                for kind in kinds
            },
            "failures": self.failures,
        }


@dataclass(frozen=True)
class Plan:
    """What to run: cases ``start``, ``start + stride``, … of a suite, up to a number of them or of seconds."""

    suite: Suite
    seed: Any
    kinds: tuple[str, ...] = ()
    cases: int | None = None
    until: float | None = None
    start: int = 0
    stride: int = 1
    # factor on every time limit: these tests do not measure speed
    patience: float = 1.0

    def indices(self) -> Iterator[int]:
        return islice(count(self.start, self.stride), None if self.cases is None else max(0, self._mine()))

    def _mine(self) -> int:
        assert self.cases is not None
        return (self.cases - self.start + self.stride - 1) // self.stride

    def header(self, kind: str, index: int) -> str:
        return f"python -m tests.fuzz {self.suite.name} --seed {self.seed} --kind {kind!r} --case {index}"


def follow(plan: Plan, report: Any = None) -> Tally:
    """Run a plan; ``report`` is called with every failure when it happens. Files that calls write are thrown away."""
    tally, began = Tally(), time.perf_counter()
    plan.suite.warmed(plan.kinds)
    with TemporaryDirectory() as folder, chdir(folder):
        _follow(plan, tally, report)
    tally.seconds = time.perf_counter() - began
    return tally


def _follow(plan: Plan, tally: Tally, report: Any) -> None:
    for index in plan.indices():
        if plan.until is not None and time.time() >= plan.until:
            break
        kind = plan.suite.kind_of(index, plan.kinds)
        known = len(tally.failures)
        tally.take(kind, _outcome(plan, kind, index), plan.header(kind, index))
        if report and len(tally.failures) > known:
            report(tally.failures[-1])


def _outcome(plan: Plan, kind: str, index: int) -> Outcome:
    try:
        case = plan.suite.case(plan.seed, kind, index)
    except Exception as error:
        return Outcome(
            RAW, f"{type(error).__name__} while the case was made: {error}", "".join(format_exception(error))
        )
    return run(replace(case, limit=case.limit * plan.patience))
