"""``integrable report``: rows that survive kills, share work and state why they failed; errors that are correct."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from contextlib import contextmanager, suppress
from dataclasses import fields, replace
from datetime import datetime
from fractions import Fraction
from functools import partial
from importlib.util import module_from_spec, spec_from_file_location
from math import inf
from pathlib import Path

import pytest
from numpy import format_float_positional

from integrable.__main__ import main
from integrable.oracles.method import Spent
from integrable.oracles.methods import METHODS, time_scale
from integrable.oracles.reference import Solution
from integrable.scene.doubles import in_doubles
from integrable.scene.file import load_scene
from integrable.series.kinds import Kind
from integrable.series.steps import FINE, FINEST, WIDE
from integrable.study import plan, rivals, runner
from integrable.study.claims import claims
from integrable.study.command import planned, report_data, study_of
from integrable.study.findings import Study, fitted_slope, gather, study_from
from integrable.study.measure import measured
from integrable.study.page import answer, in_one_minute, page
from integrable.study.plan import FLOW, LIMITS, STRONG, Task, first_answer_tasks, tasks_of
from integrable.study.runner import run_tasks
from integrable.study.store import Store, code_stamp
from integrable.study.timing import interleaved
from integrable.study.truth import INTEGRATED, Truth, compute, moved_by
from jacobian import MP
from jacobian.errors import ArgumentError
from tests.integrable.scene_texts import EXACT, ORBIT, TOP

ROOT = Path(__file__).parents[3]
PARTS = ("machine", "system", "setup", "evaluation")
# the rows of the fixture `rows`, run in a separate process that prints each key after writing it
SCRIPT = """
import sys
from integrable.scene.file import load_scene
from integrable.study.command import planned
from integrable.study.runner import run_tasks
from integrable.study.store import Store

class Saying(Store):
    def write(self, key, stamp, content):
        kept = super().write(key, stamp, content)
        print(key, flush=True)
        return kept

if __name__ == "__main__":
    source, folder = sys.argv[1:]
    every = planned([load_scene(source)], [source], "quick")
    rows = [r for r in every if r.kind in ("truth", "floor") or r.setting == "floats" or r.method == "SciPy DOP853"]
    run_tasks(rows, Saying(folder), 1)
"""


@pytest.fixture
def source(tmp_path):
    path = tmp_path / "top.toml"
    path.write_text(TOP, encoding="utf-8")
    return str(path)


@pytest.fixture
def rows(source):
    every = planned([load_scene(source)], [source], "quick")
    return [r for r in every if r.kind in ("truth", "floor") or r.setting == "floats" or r.method == "SciPy DOP853"]


@pytest.fixture(scope="module")
def done(tmp_path_factory):
    """The rows of one study of a few methods, finished, with their contents and the store."""
    folder = tmp_path_factory.mktemp("study")
    source = folder / "top.toml"
    source.write_text(TOP, encoding="utf-8")
    scene = load_scene(source)
    kept = ("SciPy DOP853", "Gauss-Legendre 6", "implicit midpoint", "closed elliptic form", FLOW, "Bäcklund steps")
    every = [r for r in planned([scene], [str(source)], "quick") if r.method in kept or r.kind in ("truth", "floor")]
    rows = [r for r in every if r.kind not in ("first answer", "horizon") and r.setting != "compiled"]
    # the tests are about results, not about the speed of this machine
    rows = [replace(r, limits=replace(r.limits, run=60.0)) for r in rows]
    store = Store(folder / "out")
    return rows, run_tasks(rows, store, 2), store


def start(tmp_path, source, folder):
    script = tmp_path / "script.py"
    script.write_text(SCRIPT, encoding="utf-8")
    command = [sys.executable, str(script), source, str(folder)]
    return subprocess.Popen(command, stdout=subprocess.PIPE, text=True, cwd=os.getcwd())


def numbers(folder):
    """The results in the rows of a folder, without times that were measured."""
    clocked, found = ("seconds", *PARTS, "total", "flow", "mad", "runs", "check"), {}
    for path in sorted((folder / "rows").glob("*.json")):
        content = json.loads(path.read_text(encoding="utf-8"))
        assert not content["error"], path.name
        result = content["result"]
        found[path.name] = {key: value for key, value in result.items() if key not in clocked}
    return found


@pytest.mark.slow
def test_a_killed_study_goes_on_and_two_at_once_share_the_work(rows, source, tmp_path):
    whole, broken = tmp_path / "whole", tmp_path / "broken"
    # two processes on one folder: each row is measured by one of them
    both = [start(tmp_path, source, whole) for _ in range(2)]
    written = [process.communicate(timeout=300)[0].split() for process in both]
    assert [process.returncode for process in both] == [0, 0]
    assert sorted(written[0] + written[1]) == sorted(row.key for row in rows)
    # one process, killed after its second row
    process = start(tmp_path, source, broken)
    with process.stdout:
        kept = [process.stdout.readline().strip() for _ in range(2)]
        process.send_signal(signal.SIGKILL)
    process.wait()
    before = {key: (broken / "rows" / f"{key}.json").stat().st_mtime_ns for key in kept}
    again, _ = start(tmp_path, source, broken).communicate(timeout=300)
    assert not set(again.split()) & set(kept)
    assert {key: (broken / "rows" / f"{key}.json").stat().st_mtime_ns for key in kept} == before
    assert numbers(broken) == numbers(whole)
    assert len(numbers(whole)) == len(rows)
    assert not list((broken / "rows").glob(".*")), "no file cut short"


def test_errors_are_what_theory_says(done):
    rows, contents, _ = done
    results = {(row.method, row.setting): contents[row.key]["result"] for row in rows}
    assert [contents[row.key]["error"] for row in rows] == [""] * len(rows)
    floor = next(contents[row.key]["result"] for row in rows if row.kind == "floor")
    truth = next(contents[row.key]["result"] for row in rows if row.kind == "truth")
    assert truth["digits"] == 40
    assert max(truth["check"]["error_gamma"], truth["check"]["error_M"]) < 1e-28
    assert 1 < floor["conditioning_gamma"] < 100
    flow = results[FLOW, "floats"]
    assert flow["error_gamma"] < 100 * floor["floor_gamma"]
    assert flow["error_M"] < 100 * floor["floor_M"]
    assert set(flow["drift"]) == {"C1", "C2", "H1", "H2"}
    assert max(flow["drift"].values()) < 1e-13
    for (method, setting), result in results.items():
        if method == "SciPy DOP853":
            tolerance = float(setting.split()[1])
            assert result["error_gamma"] < 100 * tolerance + 1e-13
    midpoint = [r for (method, _), r in results.items() if method == "implicit midpoint"]
    assert all(1e-6 < result["error_gamma"] < 1 for result in midpoint)
    assert all(result["drift"]["C1"] < 1e-12 for result in midpoint)
    coarse, fine = (results["Bäcklund steps", f"{n} steps"]["error_gamma"] for n in (30, 100))
    assert 9 < coarse / fine < 14, "second order"
    assert results["closed elliptic form", "digits 30"]["error_gamma"] < 1e-28


def test_what_is_kept_is_read_and_what_is_stale_is_measured_again(done, monkeypatch, tmp_path):
    rows, contents, store = done
    monkeypatch.setattr(runner._Worker, "take", None)  # no row is left to do
    assert run_tasks(rows, store, 1) == contents
    row = next(row for row in rows if row.kind == "flow")
    assert store.read(row.key, row.stamp) == contents[row.key]
    changed = replace(row, scene=replace(row.scene, times=replace(row.scene.times, given=row.scene.times.given[:1])))
    monkeypatch.setattr(plan, "code_stamp", lambda: "other code")
    for stale in (changed, replace(row, value=1.0), replace(row, limits=LIMITS["full"]), replace(row)):
        assert stale.key == row.key
        assert store.read(stale.key, stale.stamp) is None
    monkeypatch.undo()
    other = Store(tmp_path)
    other.write("a", "stamp", {"status": "done"})
    assert other.read("a", "stamp")["status"] == "done"
    (tmp_path / "rows" / "a.json").write_text("{half a file", encoding="utf-8")
    assert other.read("a", "stamp") is None


def test_the_stamp_of_the_code_is_that_of_its_sources():
    assert len(code_stamp()) == 16
    found = subprocess.run(
        [sys.executable, "-c", "from integrable.study.store import code_stamp; print(code_stamp())"],
        capture_output=True,
        text=True,
        check=True,
    )
    assert found.stdout.strip() == code_stamp()


@contextmanager
def claimed(store, key):
    """Whether a row could be claimed; the claim ends with the block."""
    lock = store.claim(key)
    try:
        yield lock is not None
    finally:
        if lock is not None:
            lock.release()


def test_a_claim_is_for_one_and_ends_with_its_process(tmp_path):
    store = Store(tmp_path)
    with claimed(store, "a") as mine, claimed(store, "a") as theirs, claimed(store, "b") as other:
        assert (mine, theirs, other) == (True, False, True)
    code = (
        "import sys, time; from integrable.study.store import Store; "
        "lock = Store(sys.argv[1]).claim('a'); print('held', flush=True); time.sleep(600)"
    )
    process = subprocess.Popen([sys.executable, "-c", code, str(tmp_path)], stdout=subprocess.PIPE, text=True)
    with process.stdout:
        assert process.stdout.readline().strip() == "held"
        with claimed(store, "a") as mine:
            assert not mine
        process.kill()
        process.wait()
    with claimed(store, "a") as mine:
        assert mine


def test_failures_are_rows_that_say_why(rows, done, tmp_path):
    truth = next(row for row in rows if row.kind == "truth")
    scene, source = truth.scene, truth.source

    def comparator(method, value, **needs):
        return Task(scene, source, "comparator", method, f"step {value}", value, LIMITS["quick"], truth.key, **needs)

    wild = comparator("implicit midpoint", 1000.0)
    endless = comparator("implicit midpoint", 1e-5)  # its trial may take a tenth of the limit
    kept = done[1][truth.key] | {"stamp": truth.stamp}
    store = Store(tmp_path)
    store.write(truth.key, truth.stamp, kept)
    contents = run_tasks([truth, wild, endless], store, 1)
    assert contents[wild.key]["status"] == contents[endless.key]["status"] == "failed"
    assert contents[wild.key]["error"].startswith("PrecisionLoss: step = ")
    # predicted from a short trial; on a busy machine the trial itself may be too long
    assert contents[endless.key]["error"].startswith(("not run: a whole run would take", "not run: a trial took more"))
    assert (contents[endless.key]["stopped"], contents[wild.key]["stopped"]) == (True, False)
    assert json.loads((tmp_path / "rows" / f"{wild.key}.json").read_text(encoding="utf-8"))["result"] is None
    # a row that exceeds its limit is given up, and more expensive settings are not tried
    slow = comparator("Gauss-Legendre 6", 0.001)
    slower = comparator("Gauss-Legendre 6", 0.0001, cheaper=slow.key)
    contents = run_tasks([truth, replace(slow, limits=replace(LIMITS["quick"], task=0.0))], store, 1)
    assert (contents[slow.key]["error"], contents[slow.key]["stopped"]) == ("stopped after 0 s", True)
    store.write(slow.key, slow.stamp, contents[slow.key] | {"stamp": slow.stamp})
    contents = run_tasks([truth, slow, slower], store, 1)
    assert contents[slower.key]["error"] == "not run: a cheaper setting takes too long"


def test_a_worker_that_dies_costs_its_row_alone(rows, tmp_path):
    store, row = Store(tmp_path), next(row for row in rows if row.kind == "truth")
    worker = runner._Worker()
    try:
        assert worker.take(row, store, {})
        os.kill(worker._process.pid, signal.SIGKILL)
        until = time.monotonic() + 60
        while (content := worker.finished()) is None and time.monotonic() < until:
            time.sleep(0.05)
        assert content["error"] == "the process died with exit code -9"
    finally:
        worker.stop()
        worker.let_go()


@pytest.mark.skipif(not os.path.isdir("/proc/self"), reason="processes are looked up in /proc")
def test_what_a_stopped_worker_has_started_ends_with_it(source, tmp_path):
    def started() -> int:
        found = 0
        for number in filter(str.isdigit, os.listdir("/proc")):
            with suppress(OSError), open(f"/proc/{number}/cmdline", "rb") as command:
                found += source.encode() in command.read()
        return found

    store = Store(tmp_path)
    row = next(row for row in planned([load_scene(source)], [source], "quick") if row.kind == "first answer")
    worker = runner._Worker()
    try:
        assert worker.take(row, store, {})
        until = time.monotonic() + 60
        while not started() and time.monotonic() < until:
            time.sleep(0.01)
        assert started()
    finally:
        worker.stop()
        worker.let_go()
    until = time.monotonic() + 60
    while started() and time.monotonic() < until:
        time.sleep(0.01)
    assert not started()


def test_a_scene_in_doubles_has_doubles_and_in_more_digits_its_constraints():
    for name in ("chaplygin", "tilted_ball", "tilde_potential", "gyroscopic", "near_torsion"):
        given = load_scene(name)
        scene = in_doubles(given)
        system, state = scene.start(15)
        usual, begun = given.start(15)
        assert (system.body, state) == (usual.body, begun)
        wide, restored = scene.start(60)
        K = wide.field
        assert abs(K.dot(restored.gamma, restored.gamma) - 1) < 1e-58
        if not given.tilted:
            assert abs(K.dot(restored.gamma, restored.M)) < 1e-58
        for ours, doubles in ((restored.gamma, state.gamma), (restored.M, state.M)):
            assert max(abs(x - y) for x, y in zip(ours, doubles, strict=True)) < 1e-15
        assert list(wide.body.inertia) == list(system.body.inertia)
        assert wide.body.d == system.body.d
        assert in_doubles(scene) is scene
    (argument,) = in_doubles(load_scene("near_torsion")).steps.maps[0].arguments[0][1]
    assert argument == Fraction(float(argument)) != Fraction("1.4285714286714285714285714285714285714")
    assert in_doubles(load_scene("finite_field")) == load_scene("finite_field")


def test_special_positions_are_kept_in_doubles():
    """Scenes about an exact special position keep it when γ and M are rounded and γ is normalized again."""

    def started(name):
        system, state = in_doubles(load_scene(name)).start(50)
        _, _, h1, h2 = system.integrals(state)
        return system, state, system.divisor(state), h1 / h2

    for name in ("separatrix", "double_root"):
        system, _, _, middle = started(name)
        assert abs(middle - system.a[1]) < 1e-48
    _, _, D, middle = started("double_root")
    assert abs(D.u[1] ** 2 - 4 * D.u[0]) < 1e-48
    assert abs(D.v[0] + D.v[1] * middle) < 1e-48
    _, _, D, turning = started("branch_point")
    assert abs(D.u[0] + turning * (D.u[1] + turning)) < 1e-48
    assert abs(D.v[0] + D.v[1] * turning) < 1e-48
    assert abs(turning - Fraction(5, 9)) < 1e-48
    assert started("gamma_zero")[1].gamma[1] == 0
    for name, off in (("near_separatrix_4", 1.7e-5), ("near_separatrix_8", 1.7e-9), ("near_separatrix_14", 1.7e-15)):
        system, _, _, middle = started(name)
        assert middle - system.a[1] == pytest.approx(off, rel=0.02)
    system, *_ = started("almost_equal_moments")
    assert system.inertia[1] - system.inertia[0] == pytest.approx(1.00009e-12, rel=1e-5)


def test_a_ball_of_mass_and_radius_has_in_doubles_the_d_of_doubles():
    given = replace(load_scene("chaplygin"), d=None, mass=Fraction("0.3"), radius=Fraction("0.7"))
    assert in_doubles(given).start(30)[0].d == given.start(15)[0].d


@pytest.mark.parametrize("name", [pytest.param("chaplygin", marks=pytest.mark.slow), "euler_top"])
def test_the_truth_and_every_comparator_begin_from_the_same_numbers(name, monkeypatch):
    """These are the doubles unchanged or, in more digits, the same doubles with the constraints restored."""
    scene = load_scene(name)
    scene = replace(scene, times=replace(scene.times, given=(Fraction("0.1"),), count=0))
    rows = tasks_of(scene, name, "quick")
    assert all(row.scene == rows[0].scene for row in rows)
    kept = compute(rows[0].scene, 0.01)
    truth = Truth(rows[0].scene, kept)
    doubles = [float(x) for v in (scene.inertia, scene.gamma, scene.M) for x in v]
    exact = [*truth.system.inertia, *truth.state.gamma, *truth.state.M]
    assert max(abs(x - y) for x, y in zip(doubles, exact, strict=True)) < 1e-15
    begun = {}

    def recording(method):
        class Recording(type(method)):
            def build(self, kind, setting):
                built = super().build(kind, setting)

                def of_system(given):
                    def started(start):
                        begun[self.name] = [*given.constants[:3], *start]
                        return built(given)(start)

                    return started

                return of_system

        return Recording(**{field.name: getattr(method, field.name) for field in fields(method)})

    for method in list(METHODS.values()):
        monkeypatch.setitem(METHODS, method.name, recording(method))
    for row in rows:
        if row.kind != "comparator" or row.method in begun:
            continue
        measured(row, kept)
        digits = METHODS[row.method].digits(row.value)
        if digits == 15:
            assert begun[row.method] == doubles, row.method
        else:
            bound = 10.0 ** (2 - min(digits, truth.digits))
            assert max(abs(x - y) for x, y in zip(begun[row.method], exact, strict=True)) < bound, row.method
    assert {method.name for method in METHODS.values() if method.takes(truth.system)} == set(begun)


def test_the_flow_in_floats_solves_the_problem_of_the_truth():
    scene = load_scene("chaplygin")
    scene = in_doubles(replace(scene, times=replace(scene.times, given=(Fraction(1000),), count=0)))
    system, state = scene.start(15)
    trajectory = system.flow(state).at([1000.0])
    judged = Truth(scene, compute(scene, 0.01)).judge(trajectory.gamma, trajectory.M)
    assert max(judged["error_gamma"], judged["error_M"]) < 1e-15


def test_a_long_double_keeps_its_digits():
    pytest.importorskip("heyoka")
    from integrable.oracles.heyoka_taylor import _long_double

    third = MP(30).coerce(1) / 3
    assert _long_double(1 / 3) == 1 / 3
    assert abs(MP(30).coerce(format_float_positional(_long_double(third))) - third) < 1e-19


def test_a_truth_judges_a_known_displacement():
    scene = load_scene("gamma_zero")
    scene = replace(scene, times=replace(scene.times, given=(scene.times.until * 0,), count=0))
    truth = Truth(scene, compute(replace(scene, times=replace(scene.times, given=(1,))), 0.01) | {
        "gamma": [["0.6", "0", "0.8"]], "M": [["0.8", "0.5", "-0.6"]], "tau": ["0"],
    })  # fmt: skip
    found = truth.judge([[0.6, 0.0, 0.8 + 2.0**-20]], [[0.8, 0.5, -0.6]])
    assert found["error_gamma"] == pytest.approx(2.0**-20, rel=1e-9)
    assert found["error_M"] < 1e-16
    assert found["drift"]["C1"] == pytest.approx(1.6 * 2.0**-20, rel=1e-5)
    with pytest.raises(ArithmeticError, match="not finite, and said nothing"):
        truth.judge([[0.6, float("nan"), 0.8]], [[0.8, 0.5, -0.6]])


def test_where_the_flow_refuses_a_motion_the_series_is_the_truth_and_says_so(source, monkeypatch):
    from integrable.systems.system import System

    scene = load_scene(source)
    usual = compute(scene, 0.01)

    def refused(self, state):
        raise ArgumentError("no line on a torus")

    monkeypatch.setattr(System, "motion_through", refused)
    found = compute(scene, 0.01)
    assert (found["check"], found["way"], found["refusal"]) == (None, "Taylor series", "no line on a torus")
    judged = Truth(scene, usual).judge(*(Truth(scene, found).__dict__[name] for name in ("gamma", "M")))
    assert judged["error_gamma"] < 1e-30
    assert judged["error_M"] < 1e-30


def test_a_truth_that_its_check_does_not_confirm_is_doubtful(done):
    found = studied(done).findings[0]
    growth = max(found.floor["conditioning_gamma"], found.floor["conditioning_M"])

    def doubtful(difference):
        check = found.truth["check"] | {"error_gamma": difference, "digits": 30}
        return replace(found, truth=found.truth | {"check": check}).doubtful

    assert not doubtful(1e-30 * growth)
    assert doubtful(20e-30 * growth)
    assert replace(found, truth=found.truth | {"check": None}).doubtful


def test_slopes_leave_the_plateau_out():
    steps = [2.0**-k for k in range(10)]
    errors = [max(3 * h**4, 1e-15) for h in steps[:7]] + [2e-15, 4e-15, 3e-15]
    assert fitted_slope(steps, [h**6 * 1e-3 + 1e-16 for h in steps]) == pytest.approx(6, abs=0.1)
    assert fitted_slope(steps, errors) == pytest.approx(4, abs=1e-9)
    assert fitted_slope(steps[:2], errors[:2]) is None


def studied(done, **changes):
    rows, contents, _ = done
    scene = rows[0].scene
    study = Study(gather([scene], [contents[row.key] for row in rows]), "quick", "integrable report", {"python": "3"},
                  {"processor": "p", "cores": 2, "system": "s"}, ["2026-01-01"], ["abc"], 1.0, {}, 1.0)  # fmt: skip
    return replace(study, **changes)


def test_a_row_and_the_flow_are_compared_by_run_times_in_turn(done):
    """The machine may have been slower when the flow's own row was measured."""
    scene = replace(studied(done).findings[0])
    every = [row for row in scene.comparators if row["row"]["method"] == "SciPy DOP853"]
    assert all(row["result"]["flow"] > 0 for row in every)
    alone = next(row["result"] for row in scene.flow if row["row"]["setting"] == "floats")
    row = every[-1] | {"result": every[-1]["result"] | {"total": 2 * alone["total"], "error_gamma": 1.0}}
    for in_turn, count in ((0.5 * alone["total"], 0), (4 * alone["total"], 1)):
        row["result"]["flow"] = in_turn
        assert len(replace(scene, flow=scene.flow[:1], comparators=[row]).behind()) == count


def test_timed_rows_are_of_one_run(done, source, tmp_path):
    """No page is made from rows of another machine, commit or day, and rows of another day are measured again."""
    rows, contents, _ = done
    every = [contents[row.key] for row in rows]
    timed = next(row for row in rows if row.kind == "comparator")
    other = contents[timed.key]
    for changed, said in (
        ({"machine": {"system": "Linux", "processor": "another", "cores": 4}}, "rows of 2 machines: their run times"),
        ({"commit": "another"}, "rows of 2 commits: their run times are no ratios"),
        ({"date": "2020-01-02T00:00:00+00:00"}, "rows of 2020-01-02 and of .*: these are two runs"),
    ):
        with pytest.raises(RuntimeError, match=said):
            report_data([*every, other | changed], [source], True)
    store = Store(tmp_path)
    store.write(timed.key, timed.stamp, other)
    assert runner._kept(timed, store)["result"] == other["result"]
    store.write(timed.key, timed.stamp, other | {"date": "2020-01-02T00:00:00+00:00"})
    assert runner._kept(timed, store) is None


def test_rows_for_which_there_is_no_time_are_named(rows, done, source, tmp_path):
    """They are not stored, the page has all other rows, and a run without a limit measures them."""
    store = Store(tmp_path / "out")
    first = [row for row in rows if row.kind == "truth"]
    kept = {row.key: store.write(row.key, row.stamp, done[1][row.key] | {"stamp": row.stamp}) for row in first}
    contents = run_tasks(rows, store, 1, seconds=0)
    assert contents[first[0].key] == kept[first[0].key]
    left = [content for content in contents.values() if content["status"] == "not measured"]
    assert len(left) == len(rows) - 1
    data = json.loads(json.dumps(report_data([contents[row.key] for row in rows], [source], True, 2.5)))
    assert data["command"].endswith(" --quick --minutes 2.5")
    study = study_from(data, [rows[0].scene])
    assert f"SciPy DOP853: {sum(row.method == 'SciPy DOP853' for row in rows)}" in page(study)
    assert not study.findings[0].failures
    for wrong in (-1, "x"):
        with pytest.raises(ArgumentError, match=f"minutes: {wrong!r} given"):
            study_of([source], out=tmp_path, minutes=wrong)
        with pytest.raises(ArgumentError, match=f"jobs: {wrong!r} given"):
            study_of([source], out=tmp_path, jobs=wrong)
    assert [path.stem for path in (tmp_path / "out" / "rows").glob("*.json")] == [first[0].key]


def test_every_scene_has_its_flow_and_rivals_before_any_ladder():
    names = ["neumann", "chaplygin", "finite_field"]
    for mode in ("quick", "full"):
        kinds = [(row.kind, row.setting) for row in planned([load_scene(name) for name in names], names, mode)]
        places = {kind: [i for i, (each, _) in enumerate(kinds) if each == kind] for kind, _ in kinds}
        assert kinds.index(("flow", "30 digits")) > max(places["comparator"])
        for before, after in (("truth", "floor"), ("floor", "horizon"), ("horizon", "orbit"), ("orbit", "comparator"),
                              ("first answer", "comparator"), ("comparator", "backlund")):  # fmt: skip
            assert max(places[before]) < min(places[after])


def test_behind_is_what_no_row_of_the_flow_beats(done):
    scene = studied(done).findings[0]
    flow, other = scene.flow[0], scene.comparators[0]

    def behind(total, error):
        row = {**other, "result": {**other["result"], "total": total, "error_gamma": error, "flow": 1.0}}
        found = replace(scene, comparators=[row], flow=[flow | {"result": flow["result"] | {"total": 1.0}}]).behind()
        return [(b.flow_error, b.first["total"], b.overtaken, b.cheaper) for b in found]

    error = flow["result"]["error_gamma"]
    assert behind(2.0, 2 * error) == []
    assert behind(2.0, error / 2) == [(error, 1.0, None, False)]
    assert behind(0.5, 2 * error) == [(None, 1.0, 1.0, True)]


def test_of_rows_in_doubles_three_in_a_hundred_may_be_lost(done):
    study = studied(done)
    scene = study.findings[0]
    flow, other = scene.flow[0], scene.comparators[0]
    mine = {**flow, "result": flow["result"] | {"total": 1.0}}

    def row(method, total):
        result = other["result"] | {"total": total, "error_gamma": 1.0, "flow": 1.0}
        return {**other, "row": other["row"] | {"method": method}, "result": result}

    def claim(lost, *more):
        rows = [row("SciPy DOP853", 0.5 if k < lost else 2.0) for k in range(100)]
        found = replace(scene, comparators=[*rows, *more], flow=[mine])
        line = next(line for line in claims(replace(study, findings=[found])) if "methods in doubles" in line[0])
        return line[1].split(";")[0], line[2]

    finer = row("heyoka, long double", 0.5), row("Taylor, multiprecision", 0.5)
    assert claim(0) == ("100 of 100 rows on 1 scenes", "holds")
    assert claim(3, *finer) == ("97 of 100 rows on 1 scenes", "holds")
    assert claim(4, *finer) == ("96 of 100 rows on 1 scenes", "does not hold")


def test_steps_that_would_take_too_long_are_given_up_soon(rows, done, monkeypatch):
    from integrable.study import measure

    kept = done[1][next(row for row in rows if row.kind == "truth").key]["result"]
    row = next(row for row in done[0] if row.kind == "backlund")
    monkeypatch.setattr(measure, "TRIAL", 0.001)
    row = replace(row, limits=replace(row.limits, run=0.002))
    with pytest.raises(rivals.TooLong, match="not run: a whole run would take about"):
        measured(row, kept)


def test_a_miss_of_the_floor_is_told_with_its_cause_and_silent_errors_are_found(done):
    scene = studied(done).findings[0]
    flow, floor = scene.flow[0]["result"], scene.floor

    def judged(error, drift):
        changed = flow | {"error_gamma": error, "error_M": 0.0, "drift": dict.fromkeys(flow["drift"], drift)}
        found = replace(scene, flow=[scene.flow[0] | {"result": changed}])
        return found.over_floor, found.silently_wrong, found.cause

    assert judged(5 * floor["floor_gamma"], 0.0)[:2] == (pytest.approx(5), False)
    by_momentum = flow | {"error_gamma": 0.0, "error_M": 5 * floor["floor_M"]}
    assert replace(scene, flow=[scene.flow[0] | {"result": by_momentum}]).over_floor == pytest.approx(5)
    over, silent, cause = judged(1e-3, 1e-3)
    assert over > 1e9
    assert silent
    assert cause == "additions leave the level set of the integrals"
    assert judged(1e-3, 1e-6)[2].startswith("on the level set, in the phase")


def test_at_one_time_the_fastest_that_is_near_enough_stands_beside_the_flow(done, monkeypatch):
    """Multiprecision is accurate enough but slow, and the midpoint rule never accurate enough."""
    row = replace(done[0][0], kind="horizon", method=FLOW, setting="T = 10", value=10)
    for names, peer in (
        (("implicit midpoint", "closed elliptic form"), "closed elliptic form"),
        (("implicit midpoint",), None),
    ):
        monkeypatch.setattr(rivals, "METHODS", {name: METHODS[name] for name in names})
        found = measured(row, None)
        assert found["flow"]["total"] == pytest.approx(found["flow"]["setup"] + found["flow"]["evaluation"])
        assert set(found["tried"]) == set(names)
        assert found["time"] == 10 * time_scale(*row.scene.start(15))
        assert found["flow"]["error_gamma"] < 100 * found["floor_gamma"]
        if peer is None:
            assert found["peer"] is None
        else:
            assert found["peer"]["method"] == peer
            assert found["peer"]["error_gamma"] <= max(found["flow"]["error_gamma"], found["floor_gamma"])


@pytest.mark.parametrize(
    ("errors", "chosen", "tried"),
    [
        ((1e-3, 1e-9, 1e-13, 2e-14), 2, 3),
        ((1e-3, 1e-9, 5e-13, 2e-12), 2, 3),  # at the smallest steps rounding accumulates
        ((1e-3, 1e-9, 3e-12, 2e-12), None, 2),
        ((1e-3, 1e-9, 3e-10, 1e-9), None, 1),  # no cheaper setting is accurate enough
    ],
)
def test_the_cheapest_setting_that_is_near_enough_is_found_from_the_most_accurate(
    done, monkeypatch, errors, chosen, tried
):
    task = replace(done[0][0], method="DOP853 of the test")
    method = replace(METHODS["SciPy DOP853"], name=task.method, settings=(1e-4, 1e-6, 1e-8, 1e-10))
    runs, found, told = fake(monkeypatch, task, method, dict(zip(method.settings, errors, strict=True)), {})
    assert len(runs) == tried
    assert found == (None if chosen is None else (method.settings[chosen], 1.0))
    assert told["error_gamma"] == min(errors[::-1][:tried])


def fake(monkeypatch, task, method, errors, seconds, fastest=inf):
    """The result of a method with given errors and costs, and the settings that were run."""
    runs = []

    class Judge:
        def errors(self, setting, _):
            return {"error_gamma": errors.get(setting, 0.0)}

    def once(scene, method, value):
        def run():
            runs.append(value)
            return Spent(9.0, 9.0, 0.0, seconds.get(value, 1.0)), Solution(value, value, 0)

        return None, run

    monkeypatch.setattr(rivals, "METHODS", {task.method: method})
    monkeypatch.setattr(rivals, "method_once", once)
    monkeypatch.setattr(rivals, "pilot", lambda row: seconds.get(row.value, 0.5))
    return runs, *rivals.near_enough(task, Judge(), 1e-12, fastest)


def test_settings_slower_than_the_fastest_so_far_are_not_run(done, monkeypatch):
    task = replace(done[0][0], method="DOP853 of the test")
    method = replace(METHODS["SciPy DOP853"], name=task.method, settings=(1e-4, 1e-6, 1e-8, 1e-10))
    seconds = dict(zip(method.settings, (0.1, 0.3, 0.9, 1.5), strict=True))
    runs, found, _ = fake(monkeypatch, task, method, {}, seconds, fastest=0.5)
    assert runs == [1e-8, 1e-6, 1e-4]  # 1e-10 would take three times as long as the fastest
    assert found == (1e-4, 0.1)
    assert fake(monkeypatch, task, method, {}, seconds, fastest=0.04)[1:] == (None, {"slower": 0.08})


def test_multiprecision_is_tried_only_where_nothing_else_is_near_enough(done, monkeypatch):
    row, tried = replace(done[0][0], kind="horizon", method=FLOW, setting="T = 10", value=10), []

    def near(task, *_):
        tried.append(task.method)
        return ((1e-12, 1.0), {"error_gamma": 0.0}) if task.method == near_enough else (None, {"slower": 1.0})

    monkeypatch.setattr(rivals, "near_enough", near)
    for near_enough in ("SciPy DOP853", None):
        tried.clear()
        measured(row, None)
        last = [name for name in tried if METHODS[name].multiprecision]
        assert last == ([] if near_enough else ["Taylor, multiprecision", "mpmath odefun"])
        assert tried[len(tried) - len(last) :] == last


@pytest.mark.skipif(not hasattr(signal, "setitimer"), reason="no alarms on this system")
def test_a_trial_that_goes_on_for_ever_is_ended(done, monkeypatch):
    """LSODA with a coarse tolerance makes its steps smaller and smaller near a pole."""

    class Endless(type(METHODS["SciPy LSODA"])):
        def build(self, kind, setting):
            return lambda given: lambda start: endless

    def endless(*_):
        while True:
            pass

    method = Endless("endless", "a test", "tolerance", (1e-4,))
    monkeypatch.setattr(rivals, "METHODS", {"endless": method})
    monkeypatch.setattr(rivals, "FIRST", 0.05)
    before = signal.getsignal(signal.SIGALRM)
    row = replace(done[0][0], kind="comparator", method="endless", value=1e-4)
    with pytest.raises(rivals.TooLong, match=r"not run: a trial took more than 0\.05 s"):
        rivals.pilot(replace(row, limits=replace(row.limits, run=0.01)))
    assert signal.getsignal(signal.SIGALRM) == before
    assert signal.getitimer(signal.ITIMER_REAL) == (0.0, 0.0)


def horizon(scene, T, ratio, tried=None, mad=0.0):
    flow = {"total": 0.5, "error_gamma": 1e-15}
    once = {"machine": 1.0, "system": 0.1, "mad": mad}
    flow |= {"machine": 2.0, "system": 0.2}
    peer = ratio and {
        "total": 0.5 * ratio,
        "error_gamma": 1e-14,
        "method": "SciPy DOP853",
        "setting": "tolerance 1e-12",
        **once,
    }
    row = {"scene": scene.name, "kind": "horizon", "method": FLOW, "setting": f"T = {T}", "value": T}
    tried = {"heyoka": tried or {"error_gamma": 1.0}}
    result = {"time": 1.0, "flow": flow, "floor_gamma": 1e-13, "peer": peer, "tried": tried, "strong": ["heyoka"]}
    return {"row": row, "result": result}


def test_standings_say_how_many_times_the_flows_time_another_takes(done):
    study = studied(done)
    (found,) = study.findings
    told = [(100, None), (1, 0.25), (10, 3), (1000, None, {"slower": 2.0}), (None, None, {"refused": "a pole"})]
    found = replace(found, horizons=[horizon(found.scene, *one) for one in told])
    assert [standing.ratio for standing in found.standings[:3]] == [0.25, 3, inf]
    outcomes = [standing.outcome for standing in found.standings]
    assert outcomes == ["met", "met", "none", "slower", "stopped"]
    text = page(replace(study, findings=[found]))
    assert "| scene | T = 1 | T = 10 | T = 100 | T = 1000 | all its times | flow, once a system | comp" in text
    assert "| top | 0.25 | 3 | none | >4 | stopped | 200 ms | 100 ms | 2 s | 1 s |" in text
    cells = "125 ms | 1.0e-14 | 500 ms | 1.0e-15 | 0.25 | 1 s | 100 ms | 2 s | 200 ms |"
    assert f"| top | T = 1 | SciPy DOP853, tolerance 1e-12 | {cells}" in text
    assert "**No other method is as accurate** on top (T = 100). " in text
    assert text.index("**Others are faster** in 1 of these cases") < text.index("## How it was measured")


def test_run_times_that_scatter_are_marked(done):
    study = studied(done)
    (found,) = study.findings
    wild = replace(found, horizons=[horizon(found.scene, 1, 0.25, mad=0.2), horizon(found.scene, 10, 3)])
    text = page(replace(study, findings=[wild]))
    assert "| top | 0.25 ± | 3 | 200 ms | 100 ms |" in text
    assert "| 125 ms ± | 1.0e-14 | 500 ms |" in text
    row = found.comparators[0]
    wild = replace(found, comparators=[row | {"result": row["result"] | {"mad": 0.2, "total": 0.5}}])
    assert " | 500 ms ± | " in page(replace(study, findings=[wild]))


def test_what_is_timed_runs_alone(rows, tmp_path, monkeypatch):
    """Truths and floors are computed in parallel, but nothing runs during a timing."""
    together, begin = [], runner._Worker.take

    def take(self, task, store, finished):
        taken = begin(self, task, store, finished)
        if taken:
            busy = [worker.task for worker in workers if worker.task]
            together.append([task.timed for task in busy])
        return taken

    workers, made = [], runner._Worker.__init__

    def init(self):
        made(self)
        workers.append(self)

    monkeypatch.setattr(runner._Worker, "take", take)
    monkeypatch.setattr(runner._Worker, "__init__", init)
    contents = run_tasks(rows, Store(tmp_path), 2)
    assert any(together)
    assert all(timed == [True] for timed in together if any(timed))
    for row in rows:
        assert datetime.fromisoformat(contents[row.key]["date"]).tzinfo is not None
        assert contents[row.key]["machine"]["processor"]
        if row.timed:
            assert contents[row.key]["result"]["mad"] >= 0
            assert set(PARTS) <= set(contents[row.key]["result"])


def test_what_scatters_is_measured_again_and_machines_costs_are_no_part_of_a_ratio():
    """One row includes a compilation that takes a second; the run times of starts scatter at first."""
    clock = iter([1.0, 9.0, 4.0, *[2.0] * 20])

    def once():
        return Spent(machine=1.0, system=0.5, start=0.25, evaluation=next(clock)), "found"

    timing = interleaved({"": once}, 3, inf)[""]
    assert timing.runs > 3
    assert timing.mad <= 0.1
    assert timing.total == 2.25
    assert timing.as_dict() == {"machine": 1.0, "system": 0.5, "setup": 0.25, "evaluation": 2.0, "total": 2.25,
                                "mad": timing.mad, "runs": timing.runs}  # fmt: skip


def test_what_the_flow_costs_once_a_machine_is_what_its_first_use_had(done, monkeypatch):
    """Later rows of the process show the same figure, not the cost in a warm process."""
    spent = iter([Spent(0.0, 2.0, 1.0, 4.0), *[Spent(0.0, 0.5, 0.25, 0.5)] * 100])
    rows = done[0]
    monkeypatch.setattr(rivals, "_KEPT", {})
    monkeypatch.setattr(rivals, "flow_once", lambda *_, **__: lambda: (next(spent), None))
    monkeypatch.setattr(rivals, "perf_counter", lambda: 0.0)
    flow = next(row for row in rows if row.kind == "flow")
    assert rivals.first_use(flow) == (7 - 1.25, 5)
    assert rivals.first_use(replace(flow, kind="comparator")) == (7 - 1.25, 5)
    assert next(spent) == Spent(0.0, 0.5, 0.25, 0.5)


def test_the_walks_of_the_flow_are_compiled_before_it_is_timed(monkeypatch):
    """Compiling is no part of a run. Balls and tops used to compile their walks in the first run near the start."""
    asked = []
    monkeypatch.setattr(Kind, "walk", lambda kind, orders: asked.append((kind.name, orders)))
    for name in ("chaplygin", "euler_top", "garnier", "tilde", "gyroscopic"):
        rivals._compile_walks(load_scene(name))
    assert [(name.split("_")[1], *rest) for name, *rest in asked] == [
        ("chaplyginball", WIDE),
        ("chaplyginball", FINE.orders),
        ("eulertop", WIDE),
        ("eulertop", FINE.orders),
        ("garnier", WIDE),
        ("garnier", FINE.orders),
        ("tilde", WIDE),
        ("gyroscopic", WIDE),
        ("gyroscopic", FINEST.orders),
    ]


def test_two_in_a_ratio_run_in_turn():
    order = []

    def once(name):
        order.append(name)
        return Spent(0.0, 0.0, 0.0, 1.0), None

    interleaved({name: partial(once, name) for name in "ab"}, 3, inf)
    assert "".join(order) == "ababab"


def test_the_sites_pages_are_made_of_the_report_alone(done, tmp_path):
    """report.json suffices for the overview, the lost rows and a page for each scene."""
    spec = spec_from_file_location("measured_pages", ROOT / "docs" / "site" / "measured.py")
    pages = module_from_spec(spec)
    spec.loader.exec_module(pages)
    rows, contents, _ = done
    scene = rows[0].scene
    same = {key: contents[rows[0].key][key] for key in ("machine", "commit", "date", "load")}
    more = {"status": "done", "error": "", "stopped": False, "seconds": 1.0, **same}
    every = [contents[row.key] for row in rows] + [horizon(scene, 1, 0.25) | more, horizon(scene, 10, None) | more]
    data = json.loads(json.dumps(report_data(every, [rows[0].source], True)))
    assert data["machine"] == every[0]["machine"]
    assert {row["machine"] for row in data["rows"]} == {data["rows"][0]["machine"]}
    theirs = {"system": "Linux", "processor": "another", "cores": 4}
    with pytest.raises(RuntimeError, match="rows of 2 machines: their run times are no ratios"):
        report_data([*every, {**every[-1], "machine": theirs}], [rows[0].source], True)
    assert not any("gamma" in row["result"] for row in data["rows"]), "states of truths are left out"
    assert pages.write(tmp_path, data)["top"].floor is not None
    chart = (tmp_path / "measured" / "index.md").read_text(encoding="utf-8")
    assert '<td class="behind" title="SciPy DOP853, tolerance 1e-12: 125 ms, error 1.0e-14; the flow: 500 ms' in chart
    assert '<td class="unmatched"' in chart
    assert '<a href="top.html"' in chart
    assert "| The truth agrees with an independent integrator. | 1 of 1 scenes | holds |" in chart
    for name in ("rows", "top"):
        text = (tmp_path / "measured" / f"{name}.md").read_text(encoding="utf-8")
        assert text.startswith("# ")
        assert "{div} sortable" in text


def test_the_page_lists_rows_behind_before_scenes(done):
    study = studied(done)
    text, said = page(study), answer(study)
    assert text.index("## Claims") < text.index("## Rows where the divisor flow is not ahead")
    assert text.index("## Rows where") < text.index("## The flow's error and the floor") < text.index("## top: A short")
    assert "| The truth agrees with an independent integrator. | 1 of 1 scenes | holds |" in text
    assert said.index("not ahead" if study.behind else "is ahead") < said.index("over floor")
    assert not study.findings[0].long
    assert not study.findings[0].doubtful


def test_figures_have_axes_units_a_legend_and_the_floor(done):
    from integrable.study.figures import as_bytes, error_against_run_time, floors

    study = studied(done)
    for drawing, words in (
        (error_against_run_time(study.findings[0]), ("run time of a start, seconds", "largest error of γ over the run",
         "lower left is better", "what rounding the", "inputs does", "SciPy DOP853", FLOW)),
        (floors(study.findings), ("error of the flow in floats / floor", "top")),
    ):  # fmt: skip
        text = as_bytes(drawing, "svg").decode()
        assert [word for word in words if word not in text] == []
        assert as_bytes(drawing, "png").startswith(b"\x89PNG")


def test_no_title_of_a_figure_reaches_the_legend(done):
    from integrable.scene.file import scene_names
    from integrable.study.figures import error_against_run_time

    found = studied(done).findings[0]
    longest = max((load_scene(name).title for name in scene_names()), key=len)
    drawing = error_against_run_time(replace(found, scene=replace(found.scene, title=longest)))
    drawing.canvas.draw()
    ends = drawing.axes[0].get_title(loc="left"), drawing.axes[0]._left_title.get_window_extent().x1
    assert " ".join(ends[0].split("\n")[:-1]) == longest
    assert ends[1] < drawing.legends[0].get_window_extent().x0


def test_a_figure_of_one_report_is_the_same_file_each_time(done):
    """Else every figure changes with ``docs/publish.py --again``."""
    from integrable.study.figures import as_bytes, drawings

    first, second = (drawings(studied(done).findings)["top"] for _ in range(2))
    assert as_bytes(first, "svg") == as_bytes(second, "svg")


def test_runs_of_the_flow_at_one_place_are_all_seen():
    """The mark of compiled floats is drawn last, as a ring that leaves the dot of floats visible."""
    from integrable.study.figures import _look

    dot, ring = (_look(FLOW, setting, 7.0) for setting in ("floats", "compiled"))
    assert ring["markerfacecolor"] == "none"
    assert ring["markersize"] > 1.3 * dot["markersize"]


def test_arguments_that_are_wrong_are_named(tmp_path, source, capsys):
    with pytest.raises(ArgumentError, match="jobs: 0 given; at least one process"):
        study_of([source], out=tmp_path, jobs=0)
    with pytest.raises(ArgumentError, match='"top" given 2 times'):
        study_of([source, source], out=tmp_path)
    assert main(["report", "no_such_scene", "--out", str(tmp_path)]) == 2
    assert "no such scene" in capsys.readouterr().err


def test_tasks_of_every_shipped_scene_have_keys_of_their_own():
    from integrable.scene.file import scene_names

    scenes = {name: load_scene(name) for name in scene_names()}
    for mode in ("quick", "full"):
        every = [row for name, scene in scenes.items() for row in tasks_of(scene, name, mode)]
        keys = [row.key for row in every]
        assert len(set(keys)) == len(keys)
        assert all(row.truth in keys for row in every if row.kind in ("flow", "comparator", "backlund"))


def test_first_answers_are_those_of_one_system_of_each_sort():
    names = ["neumann", "chaplygin", "euler_top", "toda", "tilde", "check", "finite_field"]
    tasks = first_answer_tasks([load_scene(name) for name in names], names)
    assert {task.scene.name for task in tasks} == {"neumann", "chaplygin", "tilde"}
    assert {task.method for task in tasks} - set(STRONG) == {FLOW}


def test_an_exact_orbit_has_error_zero(tmp_path):
    path = tmp_path / "orbit.toml"
    path.write_text(EXACT, encoding="utf-8")
    study = study_of([str(path)], out=tmp_path / "out", quick=True, formats=(), jobs=1)
    (found,) = study.findings
    assert found.orbit["rows"][0]["error_gamma"] == 0
    assert found.orbit["jump"] == 0
    assert not any(found.orbit["rows"][0]["drift"].values())
    assert "Orbits over finite fields are exact. | 1 of 1 orbits" in (tmp_path / "out" / "report.md").read_text("utf-8")


def test_the_report_goes_to_stdout_as_the_schema_says(tmp_path, capsys):
    jsonschema = pytest.importorskip("jsonschema")
    schema = json.loads((ROOT / "integrable" / "schemas" / "report.json").read_text(encoding="utf-8"))
    jsonschema.Draft202012Validator.check_schema(schema)
    valid = jsonschema.Draft202012Validator(schema).is_valid
    path, out = tmp_path / "orbit.toml", tmp_path / "out"
    path.write_text(EXACT, encoding="utf-8")
    assert main(["report", str(path), "--quick", "--json", "--no-plots", "--jobs", "1", "--out", str(out)]) == 0
    captured = capsys.readouterr()
    content = json.loads(captured.out)
    assert captured.err == ""
    assert captured.out == (out / "report.json").read_text(encoding="utf-8")
    published = json.loads((ROOT / "docs" / "error_against_run_time.json").read_text(encoding="utf-8"))
    assert valid(content)
    assert valid(published)
    timed = next(r for r in published["rows"] if r["row"]["kind"] == "comparator" and r["status"] == "done")
    for wrong in ({**content, "schema": 1}, {**content, "rows": [{}]},
                  {**published, "rows": [{**timed, "result": {"total": "long"}}]}):  # fmt: skip
        assert not valid(wrong)


def test_an_orbit_over_the_reals_is_held_against_its_floor(tmp_path):
    """The page of an orbit that keeps its integrals could not be written: unlike the rows of a motion, its rows have no
    method.
    """
    path = tmp_path / "orbit.toml"
    path.write_text(ORBIT.replace("count = 12", "count = 4"), encoding="utf-8")
    study = study_of([str(path)], out=tmp_path / "out", quick=True, formats=(), jobs=1)
    (found,) = study.findings
    row = found.judged
    row["drift"] = dict.fromkeys(row["drift"], 0.0)
    for factor, said in (
        (5, "1 of 1 scenes | holds"),
        (20, "0 of 1 scenes; orbit: 20 times, on the level set, in the phase | does not hold"),
    ):
        found.floor |= {f"floor_{part}": row[f"error_{part}"] / factor for part in ("gamma", "M")}
        assert f"within 10 times the floor on every scene. | {said} |" in page(study)


@pytest.mark.slow
def test_the_command_from_end_to_end(source, tmp_path, capsys):
    out = tmp_path / "out"
    assert main(["report", source, "--quick", "--out", str(out), "--format", "both"]) == 0
    said = capsys.readouterr().out
    assert "over floor" in said
    text = (out / "report.md").read_text(encoding="utf-8")
    for section in ("The first answer, cold and warm", "The flow's error and the floor"):
        assert f"## {section}" in text
    assert {path.name for path in (out / "figures" / "report").iterdir()} == {
        f"{name}.{suffix}" for name in ("top", "floors") for suffix in ("png", "svg")
    }
    for link in ("figures/report/top", "figures/report/floors"):
        assert f"]({link}." in text


def test_additions_near_a_divisor_keep_their_digits_and_near_its_opposite_lose_them_by_one_over_the_distance():
    from tests.integrable.study.near_additions import near_additions

    rows = near_additions(load_scene("chaplygin"))["rows"]
    assert [row["distance"] for row in rows] == [1.0, 1e-3, 1e-6, 1e-9, 1e-12]
    assert all(row["doubling"] < 1e-13 for row in rows)
    for row in rows[:-1]:
        assert row["opposite"] < 1e-12 / row["distance"]
    assert rows[2]["opposite"] > 1e-12
    assert rows[-1]["opposite"].startswith("PrecisionLoss")


@pytest.mark.parametrize(
    ("name", "adds"), [("tilde_poles", True), ("hat", True), ("tilde_potential", False), ("gyroscopic", False)]
)
def test_what_adds_on_two_elliptic_curves_is_a_divisor_flow(name, adds) -> None:
    """Also in repelling poles, where they used to be labelled as integrated."""
    scene = load_scene(name)
    assert (moved_by(scene.start(16)[0]) != INTEGRATED) is adds
    methods = {row.method for row in tasks_of(scene, name, "quick") if row.kind == "flow"}
    assert methods == {FLOW if adds else "integrated"}


def publisher():
    spec = spec_from_file_location("publish", ROOT / "docs" / "publish.py")
    module = module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_a_report_is_published_by_one_command(tmp_path):
    docs, folder = tmp_path / "docs", tmp_path / "report"
    old, new = docs / "figures" / "report" / "old.svg", folder / "figures" / "report" / "chaplygin.svg"
    for path in (old, new):
        path.parent.mkdir(parents=True)
        path.write_text("<svg/>", encoding="utf-8")
    text = (ROOT / "docs" / "peers.md").read_text(encoding="utf-8")
    (docs / "peers.md").write_text(text.replace("| T = 1 |", "| T = 2 |"), encoding="utf-8")
    published = (ROOT / "docs" / "error_against_run_time.json").read_bytes()
    (folder / "report.json").write_bytes(published)
    publisher().publish(folder, docs)
    assert (docs / "peers.md").read_text(encoding="utf-8") == text
    made = (docs / "error_against_run_time.md").read_text(encoding="utf-8")
    assert made.count("(figures/report/") == made.count("(figures/report/chaplygin.svg)") == 1
    assert (docs / "error_against_run_time.json").read_bytes() == published
    assert [path.name for path in old.parent.iterdir()] == ["chaplygin.svg"]


def test_what_is_published_is_of_one_report():
    """This code makes the published page from the JSON, peers.md has the same table, and both say where others are
    faster.
    """
    docs = ROOT / "docs"
    data = json.loads((docs / "error_against_run_time.json").read_text(encoding="utf-8"))
    study = study_from(data, [load_scene(name) for name in data["scenes"]])
    table = [line for line in in_one_minute(study).splitlines() if line.startswith("|")]
    lost = [standing for f in study.motions for standing in f.standings if standing.ratio < 1]
    assert len(table) > 3
    for name in ("error_against_run_time.md", "peers.md"):
        text = (docs / name).read_text(encoding="utf-8")
        assert "\n".join(table) in text, name
        assert ("**Others are faster**" in text) == bool(lost), name
    assert (docs / "error_against_run_time.md").read_text(encoding="utf-8") == publisher().page_of(data)
    assert {row["machine"] for row in data["rows"] if row["row"]["kind"] not in ("truth", "floor")} == {
        "{processor}, {cores} cores, {system}".format(**data["machine"])
    }
