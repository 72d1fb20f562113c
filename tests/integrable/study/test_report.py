"""The report: its numbers compared with independent ones, its table, its JSON."""

from __future__ import annotations

import json
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest

from integrable.oracles.reference import Solution, dop853
from integrable.scene.data import Comparison, Times
from integrable.scene.file import load_scene
from integrable.scene.tables import aligned, duration
from integrable.study.motions import measure, pieces_of_work
from integrable.study.report import Report, Row, TruthCheck
from integrable.study.run import run

ASKED = Comparison(
    digits=(15, 20),
    tolerances=(Fraction("1e-5"), Fraction("1e-11")),
    truth_digits=32,
    check_time=Fraction(1, 2),
    repeat=2,
    steps=(10, 100),
)


def short(name="chaplygin"):
    times = Times(given=(Fraction(3), Fraction(0), Fraction("7.5")))
    return replace(load_scene(name), times=times, report=ASKED, pictures=("work_precision",), sphere=None)


@pytest.fixture(scope="module", params=["chaplygin", "euler_top"])
def measured(request):
    labels = []
    scene = short(request.param)
    report, trajectory = measure(scene, 15, labels.append)
    return scene, report, trajectory, labels


def test_rows_are_what_was_asked_for(measured):
    scene, report, _, labels = measured
    assert [(row.method, row.setting) for row in report.rows] == [
        ("divisor flow", "floats"),
        ("divisor flow", "first use"),
        ("divisor flow", "20 digits"),
        ("SciPy DOP853", "tol 1e-5"),
        ("SciPy DOP853", "tol 1e-11"),
    ]
    assert len(labels) == pieces_of_work(scene, 15)
    assert report.times == (0.0, 7.5, 3)


def test_errors_and_drifts_are_of_the_size_they_should_be(measured):
    _, report, _, _ = measured
    floats, _, precise, loose, tight = report.rows
    # from the same doubles, so that only the method's own error remains
    assert floats.error_gamma < 1e-15 * (1 + 7.5)
    assert floats.error_M < 1e-15 * (1 + 7.5)
    assert max(floats.drift.values()) < 1e-15
    assert max(precise.error_gamma, precise.error_M, *precise.drift.values()) < 1e-18
    assert 1e-16 < report.floor[0] < 1e-13
    assert f"eps·conditioning: {report.floor[0]:.1e} in γ" in report.table()
    assert 1e-8 < loose.error_gamma < 1e-2
    assert tight.error_gamma < 1e-4 * loose.error_gamma
    assert list(floats.drift) == ["C1", "C2", "H1", "H2"]


def test_the_figures_of_dop853_are_its_own(measured):
    scene, report, trajectory, _ = measured
    body, state = scene.start(15)
    solution = dop853(body, state, scene.times.floats(), rtol=1e-5, atol=1e-5)
    row = report.rows[3]
    assert row.error_gamma == pytest.approx(np.abs(solution.gamma - trajectory.gamma).max(), rel=1e-6)
    M = np.abs(solution.M - trajectory.M).max() / np.linalg.norm(trajectory.M[1])
    assert row.error_M == pytest.approx(M, rel=1e-6)
    assert row.drift["C1"] == pytest.approx(np.abs((solution.gamma**2).sum(axis=1) - 1).max(), rel=1e-6)
    H2 = (solution.M**2).sum(axis=1)
    assert row.drift["H2"] == pytest.approx(np.abs(H2 / H2[1] - 1).max(), rel=1e-6)
    a = 1 / (np.array(body.inertia) + body.d)
    n = (solution.gamma * a * solution.M).sum(axis=1) / (solution.gamma**2 * a * body.inertia).sum(axis=1)
    H1 = (a * solution.M**2).sum(axis=1) + body.d * n * (a * solution.gamma * solution.M).sum(axis=1)
    assert row.drift["H1"] == pytest.approx(np.abs(H1 / H1[1] - 1).max(), rel=1e-6)
    assert row.evaluations == solution.evaluations


def test_run_times_are_there_and_add_up(measured):
    _, report, _, _ = measured
    rows = [row for row in report.rows if row.setting != "first use"]
    for row in rows:
        assert row.total > 0
        assert row.runs >= 1
        if row.setup is not None:
            assert row.setup + row.evaluation == pytest.approx(row.total, rel=1e-9)


def test_the_truth_is_held_against_the_taylor_series(measured):
    _, report, _, _ = measured
    assert report.truth.agrees
    assert max(report.truth.error_gamma, report.truth.error_M) < 1e-28
    assert (report.truth.digits, report.truth.time) == (32, 0.5)


def test_residual_growth_is_what_the_flow_says(measured):
    scene, report, _, _ = measured
    body, state = scene.start(15)
    assert [steps for steps, _ in report.residual_growth] == [10, 100]
    assert list(report.residual_growth) == [tuple(pair) for pair in body.flow(state).residual_growth([10, 100])]


def test_digits_of_the_run_are_measured_even_if_not_listed():
    asked = replace(ASKED, tolerances=(), steps=(), repeat=1)
    report, trajectory = measure(replace(short("euler_top"), report=asked), 25, lambda _: None)
    assert [row.setting for row in report.rows] == ["25 digits", "floats", "first use", "20 digits"]
    assert report.truth.digits == 35
    assert trajectory.gamma.dtype == object


def test_the_own_result_is_there_before_truth_and_rivals():
    """The row of the package comes first, with its trajectory for pictures; then every line of the table in order."""
    labels, said = [], []
    says = lambda what: said.append((what, list(labels)))  # noqa: E731
    asked = replace(ASKED, digits=(15, 25), truth_digits=40)
    report, trajectory = measure(replace(short(), report=asked), 15, labels.append, says, says)
    lines = [line for line, _ in said if isinstance(line, str)]
    assert "\n".join(lines) == report.table()
    own = next(done for line, done in said if isinstance(line, str) and line.startswith("divisor flow"))
    pictures = next(done for run, done in said if run is trajectory)
    assert set(pictures) == {"floats"}
    assert set(own) == {"floats", "25 digits"}
    first = next(done for line, done in said if isinstance(line, str) and line.startswith("SciPy"))
    assert "DOP853 at 1e-11" not in first


def test_an_error_is_against_the_motion_of_the_doubles_the_method_got():
    """It used to be relative to the motion from decimal fractions, which the method never received: 1.5e-14 instead of
    5.7e-17.
    """
    scene = replace(short(), times=Times(given=(Fraction(1000),)))
    report, _ = measure(replace(scene, report=replace(ASKED, tolerances=(), steps=(), repeat=1)), 15, lambda _: None)
    assert report.rows[0].error_gamma < 1e-15
    assert report.floor[0] > 1e-13
    # with more digits a run starts from the scene's own fractions, and is compared with the motion from these
    fine, trajectory = measure(
        replace(scene, report=replace(ASKED, tolerances=(), steps=(), repeat=1)), 25, lambda _: None
    )
    system, state = scene.start(40)
    true = system.motion_through(state).at([system.field.coerce(1000)])
    assert abs(trajectory.gamma[0][0] - true.gamma[0][0]) < 1e-22
    assert fine.rows[0].error_gamma < 1e-22
    assert fine.rows[1].error_gamma < 1e-15


def test_the_table_fits_and_says_what_it_must(measured):
    _, report, _, _ = measured
    table = report.table()
    lines = table.splitlines()
    assert max(map(len, lines)) <= 100
    assert all(word in table for word in ("error γ", "ΔH1", "SciPy DOP853", "tol 1e-11", "Taylor", "residual"))
    assert "DISAGREE" not in table


def test_a_truth_that_is_wrong_is_said_so():
    wrong = Report("A ball", (0.0, 1.0, 2), 3, (), TruthCheck(40, 1.0, 1e-3, 1e-40, 0.1), ())
    assert not wrong.truth.agrees
    assert "THEY DISAGREE" in wrong.table()


def test_a_method_that_gives_up_keeps_its_line():
    row = Row("SciPy DOP853", "tol 1e-3", note="step size too small")
    report = Report("A ball", (0.0, 1.0, 2), 3, (row,), TruthCheck(40, 1.0, 0.0, 0.0, 0.1), ())
    assert "SciPy DOP853, tol 1e-3: step size too small" in report.table()


def test_a_method_that_returns_no_number_is_said_to(monkeypatch):
    """It used to be compared with the truth, and its error was written as NaN."""
    nothing = Solution(np.full((3, 3), np.nan), np.full((3, 3), np.nan), 7)
    monkeypatch.setattr("integrable.study.measure.dop853", lambda *_, **__: nothing)
    asked = replace(ASKED, digits=(15,), tolerances=(Fraction("1e-5"),), steps=(), repeat=1)
    report, _ = measure(replace(short("euler_top"), report=asked), 15, lambda _: None)
    assert "SciPy DOP853, tol 1e-5: the method returned a number that is not finite" in report.table()


def test_run_writes_the_report_and_the_picture(tmp_path):
    trajectory = run(short("euler_top"), out=tmp_path, formats=("png", "svg"))
    assert sorted(path.name for path in tmp_path.iterdir()) == [
        "report.txt",
        "result.json",
        "work_precision.png",
        "work_precision.svg",
    ]
    assert (tmp_path / "report.txt").read_text(encoding="utf-8") == trajectory.report.table() + "\n"
    result = json.loads((tmp_path / "result.json").read_text(encoding="utf-8"))
    assert {"python", "numpy", "numba", "scipy", "mpmath"} <= set(result["versions"])
    assert result["machine"]["cores"] >= 1
    rows = result["report"]["rows"]
    assert [row["error_gamma"] for row in rows] == [row.error_gamma for row in trajectory.report.rows]
    assert result["report"]["truth_agrees"] is True
    assert result["trajectory"]["gamma"] == trajectory.gamma.tolist()
    assert result["scene"]["report"]["truth_digits"] == 32


def test_multiprecision_goes_into_json_as_strings(tmp_path):
    trajectory = run(replace(short("euler_top"), report=None, pictures=()), digits=40, out=tmp_path)
    stored = json.loads((tmp_path / "result.json").read_text(encoding="utf-8"))["trajectory"]["gamma"]
    assert len(stored[0][0]) > 35
    for row, written in zip(trajectory.gamma, stored, strict=True):
        for value, text in zip(row, written, strict=True):
            assert abs(value - type(value)(text)) < 1e-38


@pytest.mark.parametrize(
    ("seconds", "text"),
    [
        (None, "–"),
        (1.5, "1.5 s"),
        (0.0123, "12.3 ms"),
        (4.5e-6, "4.5 µs"),
        (0.9999, "1000 ms"),
        (3e-8, "30 ns"),
        (1234.0, "1234 s"),
    ],
)
def test_durations(seconds, text):
    assert duration(seconds) == text


def test_columns_line_up():
    assert aligned([("a", "1.0"), ("long", "10.25")]) == ["a       1.0", "long  10.25"]
