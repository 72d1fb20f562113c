"""The suites themselves: a few cases of each every day, many of them (slow), and that they detect errors."""

import json
from random import Random

import numpy as np
import pytest

from integrable.motion.flow import Flow
from integrable.motion.trajectory import Trajectory
from integrable.mumford.flow import MumfordFlow, Path
from jacobian.group import Jacobian
from jacobian.law.divisor import Divisor
from tests.fuzz.__main__ import SUITES, main, suite_of
from tests.fuzz.case import RAW, SLOW, WRONG, Case, Complaint, run
from tests.fuzz.inexact import Setting
from tests.fuzz.integrated import heyoka
from tests.fuzz.run import Plan, follow


@pytest.mark.parametrize("name", SUITES)
def test_the_same_seed_gives_the_same_cases(name):
    suite = suite_of(name)
    for kind in suite.kinds:
        first, second = (suite.case(7, kind, 3) for _ in range(2))
        assert (first.setup, first.call) == (second.setup, second.call)
        assert suite.case(8, kind, 3).setup + suite.case(8, kind, 3).call != first.setup + first.call


def test_a_curve_without_points_of_the_size_asked_for_has_others():
    """y² = 1 − x − 2x² − … has f < 0 for |x| from 16 to 64: drawing points must not loop for ever."""
    at = Setting("RR", 2, (1.0, -1.0, -2.0, -2.0, -2.0, 1e-3), Random(1))
    assert len(at.points(3, 4, 6)) == 3


def test_a_wrong_sign_is_noticed(monkeypatch, capsys):
    # warmed before the patch below
    suite_of("flow").warmed()
    right = Flow.at

    def wrong(self, times):
        found = right(self, times)
        rows = np.hstack([found.gamma, found.M])
        rows[-1, 1:3] *= -1
        return Trajectory(self, found.times, found.tau, rows, found.way)

    monkeypatch.setattr(Flow, "at", wrong)
    assert main(["flow", "--cases", "3", "--kind", "three equal", "--seed", "5"]) == 1
    said = capsys.readouterr().out
    assert "# python -m tests.fuzz flow --seed 5 --kind 'three equal' --case 0: wrong, off by" in said
    assert "3 wrong" in said
    _fails_until_undone(monkeypatch, _program(said))


def test_a_wrong_state_of_a_system_is_noticed(monkeypatch, capsys):
    right = MumfordFlow.at

    def wrong(self, times):
        found = right(self, times)
        return Path(found.times, np.hstack([found.q, found.p * (1 + 1e-6)]))

    monkeypatch.setattr(MumfordFlow, "at", wrong)
    assert main(["systems", "--cases", "2", "--kind", "pendulum", "--seed", "5"]) == 1
    said = capsys.readouterr().out
    _fails_until_undone(monkeypatch, _program(said))


def test_a_wrong_sum_is_noticed(monkeypatch, capsys):
    right = Jacobian.add
    monkeypatch.setattr(Jacobian, "add", lambda self, D, E: right(self, right(self, D, E), E))
    assert main(["engine", "--cases", "4", "--kind", "textbook sum", "--seed", "5"]) == 1
    said = capsys.readouterr().out
    assert "not the textbook's sum" in said
    _fails_until_undone(monkeypatch, _program(said))


def test_a_wrong_float_sum_is_noticed(monkeypatch, capsys):
    right = Jacobian.add

    def wrong(self, D, E):
        found = right(self, D, E)
        return Divisor(self, found.u, tuple(1.001 * c for c in found.v), found.n)

    monkeypatch.setattr(Jacobian, "add", wrong)
    assert main(["inexact", "--cases", "4", "--kind", "moderate", "--seed", "5"]) == 1
    said = capsys.readouterr().out
    _fails_until_undone(monkeypatch, _program(said))


def test_an_error_from_inside_is_noticed(monkeypatch, capsys):
    suite_of("flow").warmed()

    def raw(self, times):
        return [][0]

    monkeypatch.setattr(Flow, "at", raw)
    assert main(["flow", "--cases", "1", "--kind", "top", "--seed", "5"]) == 1
    said = capsys.readouterr().out
    assert "raw, IndexError: list index out of range" in said
    with pytest.raises(IndexError):
        exec(_program(said), {})


def _fails_until_undone(monkeypatch, program):
    with pytest.raises(AssertionError):
        exec(program, {})
    monkeypatch.undo()
    exec(program, {})


def _program(said):
    """The reproducer: from the first header to the line of counts."""
    lines = said.splitlines()
    return "\n".join(lines[: next(i for i, line in enumerate(lines) if " cases in " in line)])


def test_words_for_every_ending():
    right = lambda names: None  # noqa: E731
    assert run(Case("x = 2", "x + 1", right)).word == "right"
    assert run(Case("import time", "time.sleep(0)", right)).word == "right"
    assert run(Case("x = 2", "x + y", right)).word == RAW
    assert run(Case("", "1", lambda names: Complaint("why", "2", "got == expected"))).program.endswith(
        "got = 1\nexpected = 2\nassert got == expected, got"
    )
    refused = run(Case("from jacobian import GF", "GF(4)", right))
    assert (refused.word, refused.why.split(":")[0]) == ("refused", "ArgumentError")
    assert run(Case("from jacobian import GF", "GF(4)", right, message=lambda error: "bad")).word == WRONG


def test_a_call_without_end_is_stopped():
    outcome = run(Case("", "max(i for i in iter(int, 1))", lambda names: None, limit=0.1))
    assert outcome.word == SLOW
    assert "stopped" in outcome.why


def test_counts_go_to_a_file(tmp_path, capsys):
    file = tmp_path / "counts.json"
    assert main(["engine", "--cases", "2", "--kind", "counted", "--seed", "9", "--json", str(file)]) == 0
    found = json.loads(file.read_text())["suites"]["engine"]
    assert found["totals"]["right"] + found["totals"]["refused"] == 2
    assert capsys.readouterr().out.startswith("engine, seed 9: 2 cases in ")


def test_one_case_alone(capsys):
    assert main(["flow", "--seed", "5", "--kind", "three equal", "--case", "4"]) == 0
    assert capsys.readouterr().out.startswith("# flow, three equal: right")


def test_processes_share_the_cases(capsys):
    assert main(["engine", "--cases", "3", "--kind", "counted", "--seed", "9", "--jobs", "2"]) == 0
    assert "3 cases" in capsys.readouterr().out


def test_an_unknown_kind_is_named(capsys):
    with pytest.raises(SystemExit):
        main(["flow", "--kind", "nonsense"])
    assert "argument --kind: ['nonsense'] not among" in capsys.readouterr().err


# a few seconds, with compiled code in the cache
EVERYDAY = {
    "flow": ("three equal", "attitude", "translation"),
    "systems": ("neumann", "pendulum", "toda", "far lagrange"),
    "engine": ("textbook sum", "axioms", "counted"),
    "inexact": ("moderate",),
    "calls": ("operator",),
    "command": ("run", "view", "sweep", "report", "other"),
    "outside": ("stamp",),
}


@pytest.mark.parametrize("name", EVERYDAY)
def test_a_few_cases(name):
    suite = suite_of(name)
    # a case of "calls" tries an argument with some sixty values
    tally = follow(Plan(suite, "everyday 1", EVERYDAY[name], cases=2 if name == "calls" else 6))
    assert not tally.failures, tally.failures[0]


# suites and the number of cases that takes about 40 seconds; --cases runs any number
MANY = {"engine": 150, "flow": 240, "systems": 36, "inexact": 180, "calls": 3600, "command": 1200, "outside": 72}


# kinds whose oracle is a formula; the other oracles take minutes without heyoka
FORMULAS = (
    "symmetric top", "symmetric ball", "three equal", "top", "close top", "far", "multiprecision", "straight contact",
    "translation", "keyless", "multiplication", "tilted step", "far tilde", "far check", "far hat",
)  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize("name", MANY)
def test_many_cases(name):
    kinds = FORMULAS if name == "flow" and heyoka() is None else ()
    tally = follow(Plan(suite_of(name), 1, kinds, cases=MANY[name], patience=10))
    assert not tally.failures, tally.failures[0]
    assert tally.of("unjudged") < MANY[name] / 10
