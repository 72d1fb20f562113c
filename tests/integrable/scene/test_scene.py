"""Scenes: what is read, and what is refused with one helpful line."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
from fractions import Fraction
from importlib.resources import files

import numpy as np
import pytest

import integrable
from integrable.scene.data import SYSTEMS, Scene, Times
from integrable.scene.file import load_scene, scene_names
from integrable.study.run import run
from jacobian import MP
from jacobian.errors import ArgumentError
from tests.integrable.scene_texts import MIXED


def test_the_shipped_scenes_load_and_have_a_body_and_a_start():
    assert {"chaplygin", "euler_top"} <= set(scene_names())
    for name in scene_names():
        scene = load_scene(name)
        assert (scene.name, scene.place) == (name, f"scene {name}.toml")
        assert scene.title
        assert scene.description
        body, state = scene.start(15)
        assert len(state.gamma) == len(state.M)
        assert scene.classical or len(state.M) == 3
        if scene.steps is not None:
            scene.step(body, 15)
        else:
            assert scene.times.floats()
        if scene.rolls_or_spins:
            assert (body.d == 0) == (scene.system == "euler_top")


def test_every_system_and_map_of_the_paper_has_a_scene():
    scenes = [load_scene(name) for name in scene_names()]
    assert {scene.system for scene in scenes} == set(SYSTEMS)
    assert {"tilted_ball", "tilde", "tilde_potential", "check", "hat", "gyroscopic"} <= {scene.name for scene in scenes}
    kinds = {one.kind for scene in scenes if scene.steps is not None for one in scene.steps.maps}
    assert {"conic", "keyless", "translation"} <= kinds
    points = dict(load_scene("beyond").steps.maps[0].arguments)["points"]
    assert min(points) > 1 / load_scene("beyond").d


def test_numbers_are_exact_whether_quoted_or_not(write):
    scene = load_scene(write(MIXED))
    assert scene.inertia == (1, 2, 3)
    assert scene.gamma == (Fraction(48, 100), Fraction(6, 10), Fraction(64, 100))
    assert scene.times.given == (0, Fraction(1, 10), Fraction(1, 3))
    assert scene.times.floats() == [0.0, 0.1, 1 / 3]
    third = scene.times.at(40)[2]
    assert abs(3 * third - 1) < third.context.mpf(10) ** -39
    assert (scene.report, scene.pictures, scene.sphere, scene.digits) == (None, (), None, 15)


def test_mass_and_radius_stand_for_d(write):
    scene = load_scene(write(MIXED.replace('d = "0.7"', 'mass = "2.8"\nradius = "0.5"')))
    assert float(scene.start(15)[0].d) == pytest.approx(0.7, rel=1e-15)


def test_spaced_times():
    linear = Times(first=Fraction(0), until=Fraction(1), count=5)
    assert linear.floats() == [0.0, 0.25, 0.5, 0.75, 1.0]
    log = Times(first=Fraction(1, 10), until=Fraction(1000), count=5, spacing="log")
    assert log.floats() == pytest.approx([0.1, 1, 10, 100, 1000])
    assert log.floats()[-1] == 1000
    # the times are the same doubles at any number of digits
    assert [float(time) for time in log.at(40)] == log.floats()


def test_a_scene_is_frozen_and_describes_itself_as_plain_data():
    scene = load_scene("chaplygin")
    with pytest.raises(AttributeError):
        scene.digits = 3
    described = json.loads(json.dumps(scene.describe()))
    assert described["gamma"] == ["12/25", "3/5", "16/25"]
    assert described["report"]["digits"] == list(scene.report.digits)


REFUSED = [
    ("[body", "[body]]", "not a TOML file"),
    (
        "inertia =",
        "inertai =",
        '[body] inertai: unknown key; did you mean "inertia"? (known: inertia, d, mass, radius)',
    ),
    ("[start]", "[strat]", 'strat: unknown key; did you mean "start"?'),
    ("[run]", "[run]\ncount = 3", "[run] count: unknown key"),
    ('d = "0.7"', "", "[body] d: nothing given; either d, or mass and radius, are needed"),
    ('d = "0.7"', "d = 1\nmass = 2", "[body] d: d and mass given; either d, or mass and radius, are needed"),
    ('d = "0.7"', "d = nan", "[body] d: NaN given; a finite number"),
    ('d = "0.7"', "d = inf", "[body] d: Infinity given; a finite number"),
    ('d = "0.7"', "d = true", "[body] d: true given; a finite number"),
    ('d = "0.7"', 'd = "0,7"', '[body] d: "0,7" given; a finite number such as'),
    ('d = "0.7"', "d = 1e999999999", "a finite number"),
    ('d = "0.7"', 'd = "1/0"', '[body] d: "1/0" given; a finite number'),
    ('["1", 2, 3.0]', "[1, 2]", "[body] inertia: [1, 2] given; a list of 3 numbers is needed"),
    ('["1", 2, 3.0]', "3", "[body] inertia: 3 given; a list of 3 numbers is needed"),
    ('["1", 2, 3.0]', "[1, 2, -3]", "[body] inertia"),
    ('"0.6", 0.64', '"0.6", 0.65', "[start] gamma"),
    ('"-1.488"', '"-1.5"', "[start]"),
    ("system =", "sistem =", 'sistem: unknown key; did you mean "system"?'),
    ('"chaplygin_ball"', '"chaplygin"', 'system: "chaplygin" given; did you mean "chaplygin_ball"?'),
    ('"chaplygin_ball"', '"euler_top"', "[body] d: unknown key; (known: inertia)"),
    ('[0, 0.1, "1/3"]', "[0, -1.5]", "[run] times: -1.5 given; times ≥ 0 are needed"),
    ('[0, 0.1, "1/3"]', "[]", "[run] times: no time given"),
    ('[0, 0.1, "1/3"]', "{until = 0, count = 3}", "[run] times: until: 0.0 given; a time after 0.0 is needed"),
    ('[0, 0.1, "1/3"]', "{until = 2, count = 1}", "[run] times: count: 1 given; an integer ≥ 2 is needed"),
    ('[0, 0.1, "1/3"]', '{until = 2, count = 3, spacing = "lin"}', 'spacing: "lin" given; did you mean "linear"?'),
    ('[0, 0.1, "1/3"]', '{until = 2, count = 3, spacing = "log"}', "[run] times: from: missing; a number is needed"),
    (
        '[0, 0.1, "1/3"]',
        '{from = "1e-200", until = "1e200", count = 3, spacing = "log"}',
        "[run] times: until: 1e+200 given; at most 1e300 times 1e-200 is needed",
    ),
    ("times =", "digits = 0\ntimes =", "[run] digits: 0 given; an integer ≥ 1 is needed"),
    ("times =", "digits = 15.5\ntimes =", "[run] digits: 15.5 given; an integer ≥ 1 is needed"),
    ("[run]", '[output]\npictures = ["spheer"]\n[run]', '[output] pictures: "spheer" given; did you mean "sphere"?'),
    ("[run]", '[output]\npictures = ["work_precision"]\n[run]', "a [report] table is needed"),
    ("[run]", "[report]\ntolerances = [1e-20]\n[run]", "[report] tolerances: 1e-20 given; SciPy takes"),
    ("[run]", "[report]\ndigits = [15, 10]\n[run]", "[report] digits: [15, 10] given; different costs are needed"),
    ("[run]", "[report]\ndigits = [40]\ntruth_digits = 40\n[run]", "[report] truth_digits: 40 given; at least 50"),
]


@pytest.mark.parametrize(
    ("old", "new", "message"), REFUSED, ids=[new.replace("\n", " ") or "removed" for _, new, _ in REFUSED]
)
def test_what_is_wrong_is_named(write, old, new, message):
    assert old in MIXED
    path = write(MIXED.replace(old, new, 1), "ball.toml")
    with pytest.raises(ArgumentError) as caught:
        load_scene(path).start(15)
    said = str(caught.value)
    assert said.startswith("scene ball.toml: ")
    assert message in said
    assert "\n" not in said


def test_a_missing_table_is_named(write):
    with pytest.raises(ArgumentError, match=r"\[run\]: missing; a table with times, digits is needed"):
        load_scene(write(MIXED[: MIXED.index("[run]")]))


def test_a_scene_that_is_not_there_is_named_with_what_is():
    with pytest.raises(ArgumentError, match=r'"chaplygn" given, no such scene; did you mean "chaplygin"\?'):
        load_scene("chaplygn")
    with pytest.raises(ArgumentError, match=r'"/nowhere/ball.toml" cannot be read: No such file'):
        load_scene("/nowhere/ball.toml")


def test_run_returns_the_trajectory_the_scene_asks_for(write):
    trajectory = run(write(MIXED))
    assert trajectory.report is None
    assert trajectory.gamma.shape == trajectory.M.shape == (3, 3)
    assert np.abs(trajectory.gamma[0] - [0.48, 0.6, 0.64]).max() < 1e-15
    precise = run(load_scene(write(MIXED)), digits=30)
    assert np.abs(trajectory.gamma - precise.gamma.astype(float)).max() < 1e-14
    assert np.abs(trajectory.M - precise.M.astype(float)).max() < 1e-13


@pytest.mark.parametrize("digits", [0, -3, 2.5, True, "30"])
def test_run_refuses_digits_that_are_none(write, digits):
    with pytest.raises(ArgumentError, match=f"digits = {digits!r}: a positive number of decimal digits is needed"):
        run(write(MIXED), digits=digits)


def test_run_takes_digits_of_numpy(write) -> None:
    assert run(write(MIXED), digits=np.int64(30)).system.field == MP(30)


def test_run_writes_nothing_unless_told_where(write, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    run(write(MIXED, "ball.toml"))
    assert [path.name for path in tmp_path.iterdir()] == ["ball.toml"]
    run(write(MIXED), out=tmp_path / "a" / "b")
    assert [path.name for path in (tmp_path / "a" / "b").iterdir()] == ["result.json"]
    result = json.loads((tmp_path / "a" / "b" / "result.json").read_text(encoding="utf-8"))
    assert (result["schema"], result["digits"], result["report"], result["sphere"]) == (1, 15, None, None)
    assert result["trajectory"]["gamma"][0] == pytest.approx([0.48, 0.6, 0.64])


def test_a_scene_without_report_or_pictures_imports_neither(write):
    code = (
        "import sys; from integrable import run; run(sys.argv[1]);"
        "print(sorted({name.split('.')[0] for name in sys.modules} & {'scipy', 'matplotlib', 'tqdm', 'galois'}));"
        "print([name for name in sys.modules if name in ('integrable.study.motions', 'integrable.study.plot', "
        "'integrable.scene.output')])"
    )
    done = subprocess.run(
        [sys.executable, "-c", code, str(write(MIXED))], capture_output=True, text=True, check=True, timeout=120
    )
    assert done.stdout.split("\n")[:2] == ["[]", "[]"]


def test_scene_is_what_load_scene_returns(write):
    assert isinstance(load_scene(str(write(MIXED))), Scene)


@pytest.mark.skipif(os.name == "nt", reason="Windows has no such names")
@pytest.mark.parametrize(
    ("name", "read"), [("a\nb", "a_b"), ("c\udcff", "c_"), ("d\u2028e", "d_e"), ("f\x1b[31mg", "f_[31mg")]
)
def test_a_name_with_a_line_break_or_bytes_that_are_no_letters(name, read, tmp_path):
    """Such names led to a UnicodeEncodeError in .h5 files and to messages of two lines."""
    pytest.importorskip("h5py")
    path = tmp_path / f"{name}.toml"
    path.write_text((files("integrable") / "scenes" / "chaplygin.toml").read_text(encoding="utf-8"), encoding="utf-8")
    scene = load_scene(path)
    assert scene.name == read
    assert str(scene.place) == f"scene {read}.toml"
    found = integrable.sweep(path, vary={"d": [0.5]}, out=tmp_path / "out.h5", executor="threads")
    assert found.members == 1
    path.write_text("x = 1", encoding="utf-8")
    with pytest.raises(ArgumentError, match=re.escape(f"scene {read}.toml: ")):
        load_scene(path)
