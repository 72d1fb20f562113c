"""Races: errors and times are as stated, failures stay in the race, and the page needs no other file."""

import json
import re
from pathlib import Path

import numpy as np
import pytest

from integrable.__main__ import main
from integrable.problems import problem
from integrable.races import entrants as entrants_of_races
from integrable.races.entrants import entrants, loaded
from integrable.races.race import MOST_TIMES, pieces_of_race, race
from jacobian import ArgumentError
from tests.integrable.races import own_solvers

HERE = Path(own_solvers.__file__)


def short(name="t_handle", *times):
    one = problem(name)
    one.times = times or (0.0, 1.0, 2.5, 5.0)
    return one


@pytest.fixture(scope="module")
def run():
    labels = []
    given = {"mine": own_solvers.runge_kutta, "failing": own_solvers.failing, "wrong": own_solvers.wrong_shape}
    found = race([short()], given, rivals=("SciPy DOP853",), limit=0.5, tick=labels.append)
    return found, labels


def rows(found, name):
    return [one for one in found.courses[0].runs if one.method == name]


def test_errors_are_those_of_what_a_function_returns(run) -> None:
    found, _ = run
    one = short()
    times = np.array(found.courses[0].times)
    assert times.tolist() == [1.0, 2.5, 5.0]
    truth = one.truth(times)
    mine = rows(found, "mine")
    for row in mine[:2]:
        expected = one.error(own_solvers.runge_kutta(one, times, row.setting), truth).max()
        assert row.error == pytest.approx(expected, rel=1e-9)
        assert row.seconds > 0
        assert row.runs >= 1
    # of order four, with h in proportion to the fourth root of the tolerance
    assert 20 < mine[0].error / mine[1].error < 500
    assert 0 < found.courses[0].radius < 1e-15
    assert 1e-16 < found.courses[0].floor < 1e-12


def test_rivals_and_the_package_itself_run_too(run) -> None:
    found, labels = run
    assert next(one.setting for one in rows(found, "SciPy DOP853")) == 1e-4
    (own,) = rows(found, "divisor flow")
    assert own.error < 1e-14
    assert len(labels) == pieces_of_race([None], ("SciPy DOP853",))


def test_a_function_that_fails_keeps_its_line_and_is_not_tried_again(run) -> None:
    found, _ = run
    notes = [one.note for one in rows(found, "failing")]
    assert notes == ["", "a state is not finite, but no error was raised"]
    (wrong,) = rows(found, "wrong")
    assert "shape (6,); (1, 6) is needed" in wrong.note
    assert wrong.error is None
    assert "wrong, tolerance 1e-04: ArgumentError" in found.table()


def test_what_is_spent_before_the_first_run_is_not_its_run_time(monkeypatch) -> None:
    own_solvers.CALLS.clear()
    monkeypatch.setattr(entrants_of_races, "perf_counter", own_solvers.clock)
    found = race([short()], {"compiling": own_solvers.compiling}, rivals=(), limit=1.0)
    first, *others = rows(found, "compiling")
    assert first.first > 0.45
    assert first.seconds < 0.45
    assert all(one.first < 0.45 for one in others)


def test_a_run_that_would_take_too_long_is_not_made() -> None:
    found = race([short("million_turns", 1e7)], {"mine": own_solvers.runge_kutta}, rivals=(), limit=0.2)
    (mine,) = rows(found, "mine")
    assert mine.note.startswith(("not run: it would take about", "not run: a trial took more"))
    assert rows(found, "divisor flow")[0].error < 1e-8


@pytest.mark.slow
@pytest.mark.parametrize("name", ["neumann", "kdv_two_gaps", "tilted_ball", "toda_5"])
def test_every_rival_takes_doubles_of_any_length(name) -> None:
    """The start is not exactly a unit vector, and the methods receive it unchanged: with tight tolerances they come
    near the solution.
    """
    one = problem(name)
    other = one.another(np.random.default_rng(3))
    times = np.array([0.5, 2.0]) * other.time_scale
    truth = other.truth(times)
    for entrant in entrants(other, {}, ("SciPy DOP853", "Taylor, compiled", "Gauss-Legendre 16, adaptive", "heyoka")):
        _, y = entrant.run(other, times, entrant.settings[-1])
        assert other.error(y, truth).max() < 1e-11, entrant.name


def test_the_files_stand_alone(run, tmp_path) -> None:
    found, _ = run
    names = [path.name for path in found.write(tmp_path)]
    assert names == ["race.json", "race.txt", "race.html"]
    content = json.loads((tmp_path / "race.json").read_text(encoding="utf-8"))
    assert content["courses"][0]["runs"][0]["error"] == found.courses[0].runs[0].error
    assert content["machine"]["cores"] >= 1
    page = (tmp_path / "race.html").read_text(encoding="utf-8")
    assert not re.search(r"(?:src|href)\s*=|@import|url\(", page)
    assert page.count("<svg viewBox") == 1 + len({one.method for one in found.courses[0].runs})
    for words in ("error (relative)", "run time", "rounding of the inputs", "the truth's radius", "SciPy DOP853"):
        assert words in page
    # one mark for each run with figures, and no mark outside the diagram
    drawn = [one for one in found.courses[0].runs if one.error is not None]
    assert page.count("<title>") == 1 + len(drawn)
    for points in re.findall(r'<polyline points="([^"]*)"', page):
        for pair in points.split():
            x, y = map(float, pair.split(","))
            assert 0 <= x <= 680
            assert 0 <= y <= 440


def test_a_function_is_named_by_module_or_file(monkeypatch) -> None:
    name, solve = loaded(f"{HERE}:runge_kutta")
    assert name == "runge_kutta"
    assert solve.__doc__ == own_solvers.runge_kutta.__doc__
    assert loaded("tests.integrable.races.own_solvers:failing")[1] is own_solvers.failing


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: loaded("mymodule"), "give module:function"),
        (lambda: loaded("no_such_module_here:solve"), "cannot be imported"),
        (lambda: loaded(f"{HERE}:solv"), "has no solv"),
        (lambda: loaded(f"{HERE}:NOT_A_FUNCTION"), "is no function"),
        (lambda: loaded("nowhere.py:solve"), "cannot be imported"),
        (lambda: race(["t_handle"], rivals=("RK45",)), "rivals"),
        (lambda: race(["t_handle"], limit=0), "limit = 0"),
        (lambda: race(["t_hande"]), "no such scene"),
    ],
)
def test_bad_calls_name_the_argument(call, words) -> None:
    with pytest.raises(ArgumentError, match=re.escape(words)):
        call()


def test_the_command(tmp_path, monkeypatch, capsys) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "mine.py").write_text(HERE.read_text(encoding="utf-8"), encoding="utf-8")
    words = ["race", "mine.py:runge_kutta", "--problem", "henon_heiles_bounded", "--rival", "SciPy LSODA"]
    assert main([*words, "--limit", "0.1"]) == 0
    out = capsys.readouterr().out
    assert "runge_kutta" in out
    assert "additions" in out
    assert sorted(path.name for path in Path("runs/race").iterdir()) == ["race.html", "race.json", "race.txt"]
    assert main([*words, "--limit", "0.1", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["courses"][0]["name"] == "henon_heiles_bounded"
    assert main(["race", "mine.py:nothing"]) == 2
    assert "has no nothing" in capsys.readouterr().err


def test_no_more_times_than_are_needed_are_asked_for() -> None:
    found = race([short("t_handle", *np.linspace(0, 1, 101))], rivals=())
    assert len(found.courses[0].times) == MOST_TIMES
    assert found.courses[0].times[-1] == 1.0
