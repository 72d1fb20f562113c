"""Scenes of systems of any genus: what is read, run, measured and drawn, and what is refused."""

from __future__ import annotations

import json
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest

import integrable
from integrable.__main__ import main
from integrable.classical.ellipsoid import Ellipsoid
from integrable.classical.henon_heiles import HenonHeiles
from integrable.classical.neumann import Neumann
from integrable.classical.toda import TodaLattice
from integrable.motion.conditioning import conditioning
from integrable.mumford.flow import Point
from integrable.oracles.methods import METHODS
from integrable.phase.state import State
from integrable.scene.classical import ClassicalSystem
from integrable.scene.data import SYSTEMS
from integrable.scene.doubles import in_doubles
from integrable.scene.file import load_scene
from integrable.study.figures import error_against_run_time
from integrable.study.findings import SceneFindings, Study
from integrable.study.measure import measured
from integrable.study.motions import measure, pieces_of_work
from integrable.study.page import scene_section
from integrable.study.plan import BACKLUND, FLOW, tasks_of
from integrable.study.run import run
from integrable.study.truth import Judge
from integrable.sweeps.sweep import sweep
from jacobian import MP
from jacobian.errors import ArgumentError

COMPILED = ("toda",)
CLASSICAL = [name for name, kind in SYSTEMS.items() if kind.room == "classical"]
SCENE = """
system = "neumann"
[body]
a = [1, 2, 4]
[start]
q = ["0.48", "0.6", "0.64"]
p = ["0.384", "1.28", "-1.488"]
[run]
times = [0, "1/3", 3]
[report]
tolerances = ["1e-9"]
check_time = "0.1"
truth_digits = 30
repeat = 1
[output]
pictures = ["work_precision", "coordinates"]
coordinates = { until = 2, count = 30 }
"""


def short(name, *times):
    """A shipped scene in doubles with two times."""
    scene = load_scene(name)
    return in_doubles(replace(scene, times=replace(scene.times, given=times, count=0), report=None))


@pytest.mark.parametrize("name", CLASSICAL)
def test_a_shipped_scene_runs_as_its_system_does(name):
    found = run(short(name, 0, 1, 2))
    system, state = load_scene(name).start(15)
    flow = system.system.flow(system.system.state(state.gamma, state.M))
    path = flow.at([0, 1, 2])
    assert found.q.tolist() == path.q.tolist()
    assert found.p.tolist() == path.p.tolist()
    assert found.report is None
    assert found.way == path.way


def test_a_run_says_what_has_computed_its_states() -> None:
    system = Neumann((1, 2, 4))
    flow = ClassicalSystem(system).motion_through(State((0.48, 0.6, 0.64), (0.8, 0, -0.6)))
    many = np.linspace(1e6, 2e6, 30)
    assert [flow.at(times).way for times in ([1], [1e6], [1e-3, 1e6])] == ["series", "torus", "series, torus"]
    assert [flow.at(times).way for times in (many, [1e-3, *many])] == ["torus", "series, torus"]
    precise = ClassicalSystem(Neumann((1, 2, 4), MP(30)))
    state = precise.state(("0.48", "0.6", "0.64"), ("0.8", 0, "-0.6"))
    assert precise.motion_through(state).at([1]).way == "additions"


def test_a_run_writes_its_report_pictures_and_numbers(write, tmp_path):
    assert main(["run", str(write(SCENE)), "--out", str(tmp_path / "out"), "--quiet"]) == 0
    content = json.loads((tmp_path / "out" / "result.json").read_text("utf-8"))
    assert content["scene"]["constants"] == {"a": ["1", "2", "4"]}
    assert content["scene"]["q"] == ["12/25", "3/5", "16/25"]
    assert np.shape(content["trajectory"]["p"]) == (3, 3)
    assert np.shape(content["sphere"]["q"]) == (30, 3)
    for picture in ("work_precision", "coordinates"):
        assert (tmp_path / "out" / f"{picture}.png").read_bytes().startswith(b"\x89PNG")
    text = (tmp_path / "out" / "report.txt").read_text("utf-8")
    assert "error q" in text
    assert "Gauss's collocation" in text
    assert "γ" not in text


def test_its_numbers_are_what_the_schema_says(write, capsys):
    jsonschema = pytest.importorskip("jsonschema")
    schema = (Path(integrable.__file__).parent / "schemas" / "result.json").read_text(encoding="utf-8")
    assert main(["run", str(write(SCENE)), "--json"]) == 0
    content = json.loads(capsys.readouterr().out)
    check = jsonschema.Draft202012Validator(json.loads(schema)).is_valid
    assert check(content)
    assert not check({**content, "trajectory": {"times": [], "q": []}})


def test_a_report_holds_additions_and_integrators_against_more_digits(write):
    scene, said = load_scene(write(SCENE)), []
    report, path = measure(scene, 15, said.append)
    assert len(said) == pieces_of_work(scene, 15)
    rows = {row.setting: row for row in report.rows}
    assert rows["floats"].error_gamma < 1e-14
    assert rows["tol 1e-9"].error_gamma == pytest.approx(1e-9, rel=1e3)
    assert set(rows["floats"].drift) == {"F", "H"}
    assert report.truth.agrees
    assert 0 < report.floor[0] < 1e-13
    assert path.q.shape == (3, 3)


@cache
def run_of(system):
    """The motion of a short scene: the same for every integrator."""
    return run(short(system, 0, -1, 1))


@pytest.mark.parametrize(
    ("system", "name"),
    [
        # compiling the equations of each takes seconds: one every day
        pytest.param(system, name, marks=pytest.mark.slow if name[-2:] == "16" and system not in COMPILED else ())
        for system in CLASSICAL
        for name in ("SciPy DOP853", "Gauss-Legendre 6", "Gauss-Legendre 16", "heyoka")
    ],
)
def test_integrators_take_every_system(system, name):
    method = METHODS[name]
    if not method.installed:
        pytest.skip(f"{method.module} is not installed")
    scene = short(system, 0, -1, 1)
    # a wave of KdV passes one place some ten times as fast as the others move
    step = 0.005 if system == "kdv_two_gaps" else 0.05
    found = method.solve(*scene.start(15), scene.times.floats(), step if method.parameter == "step" else 1e-12)
    true = run_of(system)
    assert np.abs(found.gamma - true.q).max() < 1e-7
    assert np.abs(found.M - true.p).max() < 1e-7


@pytest.mark.thinned(2)
@pytest.mark.parametrize(("system", "order"), [("ellipsoid", 2), ("neumann", 2), ("toda", 1)])
def test_the_discretization_of_a_system_is_a_method_of_its_own(system, order):
    scene = short(system, 0, 1)
    tasks = [task for task in tasks_of(scene, system, "quick") if task.method == BACKLUND]
    assert tasks
    truth = measured(tasks_of(scene, system, "quick")[0], None)
    errors = [measured(replace(tasks[0], value=n), truth)["error_gamma"] for n in (10, 40)]
    assert np.log(errors[0] / errors[1]) / np.log(4) == pytest.approx(order, abs=0.15)
    assert not any(task.method == BACKLUND for task in tasks_of(short("lagrange", 0, 1), "lagrange", "quick"))


def test_a_page_of_a_study_calls_q_and_p_by_their_names():
    row = {"scene": "neumann", "kind": "flow", "method": FLOW, "setting": "floats", "value": 15}
    result = {"total": 0.5, "runs": 1, "error_gamma": 1e-15, "error_M": 1e-15, "drift": {"F": 0.0}}
    found = SceneFindings(load_scene("neumann"), flow=[{"row": row, "result": result}])
    study = Study([found], "quick", "integrable report", {}, {}, [], [], None, {}, 1.0)
    assert "| error q | error p |" in scene_section(study, found)
    assert error_against_run_time(found).axes[0].get_ylabel() == "largest error of q over the run"


def test_a_step_back_undoes_a_step():
    system = Neumann((1, 2, 4))
    state = system.state((0.48, 0.6, 0.64), (0.384, 1.28, -1.488))
    again = system.discrete(system.discrete(state, 0.1), -0.1)
    assert np.abs(np.array(again) - np.array(state)).max() < 1e-14
    earth = Ellipsoid((1, 2, 4))
    state = earth.state((1, 0, 0), (0, 0.6, 0.8))
    again = earth.discrete(earth.discrete(state, 0.5), -0.5)
    assert np.abs(np.array(again) - np.array(state)).max() < 1e-15
    lattice = TodaLattice(3)
    start = lattice.state((0, 0.5, -0.25), (1, -0.5, 0.25))
    assert sum(lattice.discrete(start, 0.125).q) == pytest.approx(0.25 + 0.125 * 0.75, rel=1e-14)


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("a = [1, 2, 4]", "inertia = [1, 2, 4]", r"\[body\] inertia: unknown key"),
        ("a = [1, 2, 4]", "a = [1, 1, 4]", r"\[body\] a = .*different"),
        ("a = [1, 2, 4]", "", r"\[body\] a: missing; a number or a list of numbers is needed"),
        ('"neumann"\n[body]\na = [1, 2, 4]', '"spherical_pendulum"', r"\[body\]: missing; an empty table is needed"),
        ('p = ["0.384"', 'p = ["0.5"', r"\[start\] .*\(q, p\) = 0 is needed"),
        ("q = ", "gamma = ", r"\[start\] gamma: unknown key"),
        ("[run]", "[steps]\ncount = 3\n[run]", r"\[steps\]: given"),
        ('"coordinates"]', '"sphere"]', r'pictures: "sphere" given'),
    ],
)
def test_what_is_wrong_is_named(write, old, new, said):
    assert old in SCENE
    with pytest.raises(ArgumentError, match=said):
        load_scene(write(SCENE.replace(old, new))).start(15)


def test_what_is_for_bodies_alone_is_refused(tmp_path):
    with pytest.raises(ArgumentError, match="neumann has no body"):
        sweep("neumann", vary={"d": [1, 2]}, out=tmp_path / "a.zarr")


def test_next_to_a_pole_a_row_is_measured_by_itself() -> None:
    """At t = 81, q_0 = 1803 and p_0 = 153061: the effects of inputs and of rounding are relative to these."""
    system = ClassicalSystem(HenonHeiles.with_frequencies(1, 1.25))
    state = system.state((0.1, 0.05), (0, 0.1))
    times = [80.0, 81.0]
    found = conditioning(system, state, times)
    assert {"q0", "q1", "p1"} <= set(found.inputs) <= {*system.system.flow(Point(*state.vectors))._inputs()[1]}
    assert 1e3 < found.gamma < 1e5
    assert 1e3 < found.M < 1e5
    fine = ClassicalSystem(system.system.over(MP(40)))
    start = fine.onto_constraints(State(*(tuple(map(fine.field.coerce, x)) for x in (state.gamma, state.M))))
    truth, floats = fine.motion_through(start).at(times), system.motion_through(state).at(times)
    assert abs(float(truth.q[1][0])) > 1e3
    errors = Judge(fine, start, truth.q, truth.p).errors(floats.q, floats.p)
    assert max(errors.values()) < 2.0**-53
