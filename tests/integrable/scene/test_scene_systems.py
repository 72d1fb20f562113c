"""Scenes of the deformed systems and of orbits: what is read, what is run, what is refused."""

from __future__ import annotations

import json
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest

from integrable import Check, Gyroscopic, Hat, Tilde
from integrable.__main__ import main
from integrable.scene.data import Comparison, Times, finite_field
from integrable.scene.file import load_scene
from integrable.study.motions import measure, pieces_of_work
from integrable.study.orbits import measure_orbit, pieces_of_orbit
from integrable.study.run import run
from jacobian import GF
from jacobian.errors import ArgumentError
from tests.integrable.scene_texts import EXACT, ORBIT, TILDE

# --- deformed systems


def test_a_deformed_system_is_read_with_its_parameters(write):
    system, _ = load_scene(write(TILDE)).start(30)
    assert isinstance(system, Tilde)
    assert float(system.d) == pytest.approx(0.7)
    assert [float(x) for x in (system.potential.a, system.potential.b, *system.potential.poles)] == pytest.approx(
        [0.1, 0.05, 0.02, 0.04, 0.06]
    )
    assert load_scene(write(TILDE.replace('d = "0.7"\n', ""))).start(15)[0].d == 0
    for word, kind in (("check", Check), ("hat", Hat)):
        text = TILDE.replace('"tilde"', f'"{word}"').replace('d = "0.7"\n', "")
        assert isinstance(load_scene(write(text)).start(15)[0], kind)
    text = TILDE.replace('"tilde"', '"gyroscopic"').replace('d = "0.7"\n', "")
    gyroscopic = load_scene(write(text.replace(text[text.index("potential") : text.index("\n\n[start]")], 'c = "1/2"')))
    assert isinstance(gyroscopic.start(15)[0], Gyroscopic)
    assert gyroscopic.start(15)[0].c == 0.5


def test_a_run_without_curves_is_an_integration_to_the_last_digit(write):
    found = run(write(TILDE))
    precise = run(load_scene(write(TILDE)), digits=30)
    assert found.gamma.shape == found.M.shape == (2, 3)
    assert np.abs(found.gamma[0] - [0.48, 0.6, 0.64]).max() < 1e-15
    assert np.abs(found.gamma - precise.gamma.astype(float)).max() < 1e-15


@pytest.mark.parametrize(
    ("name", "method"),
    [
        ("tilde", "elliptic curves"),
        ("check", "elliptic curves"),
        ("hat", "elliptic curves"),
        ("gyroscopic", "integrated"),
        pytest.param("tilde_potential", "integrated", marks=pytest.mark.slow),
    ],
)
def test_the_report_of_a_deformed_system(name, method):
    asked = Comparison((15, 20), (Fraction("1e-5"), Fraction("1e-10")), 32, Fraction(1, 4), 1, ())
    scene = replace(load_scene(name), times=Times(given=(Fraction(0), Fraction(3, 2))), report=asked)
    labels = []
    report, trajectory = measure(scene, 15, labels.append)
    assert len(labels) == pieces_of_work(scene, 15)
    assert [(row.method, row.setting) for row in report.rows] == [
        (method, "floats"),
        (method, "20 digits"),
        ("SciPy DOP853", "tol 1e-5"),
        ("SciPy DOP853", "tol 1e-10"),
    ]
    floats, precise, loose, tight = report.rows
    assert max(floats.error_gamma, floats.error_M, *floats.drift.values()) < 1e-13
    assert max(precise.error_gamma, precise.error_M, *precise.drift.values()) < 1e-17
    assert 1e-10 < loose.error_gamma < 1e-2
    assert tight.error_gamma < 1e-3 * loose.error_gamma
    assert list(floats.drift) == ["C1", "C2", "H", "K"]
    assert report.truth.agrees
    assert max(report.truth.error_gamma, report.truth.error_M) < 1e-29
    table = report.table()
    assert max(map(len, table.splitlines())) <= 100
    assert all(word in table for word in (method, "ΔK", "SciPy DOP853"))
    assert trajectory.gamma.shape == (2, 3)


# --- orbits


def test_an_orbit_over_the_reals(write):
    scene = load_scene(write(ORBIT.replace("count = 12", "count = 12\ndigits = [15, 20]\nrepeat = 1")))
    labels = []
    found = measure_orbit(scene, 15, labels.append)
    assert len(labels) == pieces_of_orbit(scene, 15) == 3
    floats, precise = found.report.rows
    assert max(floats.error_gamma, floats.error_M, *floats.drift.values()) < 1e-9
    assert 0 < precise.error_gamma < 1e-14
    assert floats.seconds_per_step > 0
    assert [n for n, _ in floats.growth] == list(range(13))
    assert floats.growth[0][1] < 1e-16
    assert max(e for _, e in floats.growth) == floats.error_gamma
    assert found.report.jump < 1e-28
    assert found.gamma.shape == found.M.shape == (13, 3)
    table = found.report.table()
    assert max(map(len, table.splitlines())) <= 100
    assert "one addition of 12·D'" in table


def test_an_orbit_over_a_finite_field_is_exact(write, capsys, tmp_path):
    path = write(EXACT)
    found = run(path)
    (row,) = found.report.rows
    assert (row.error_gamma, row.error_M, set(row.drift.values()), found.report.jump) == (0, 0, {0.0}, 0.0)
    system, state = load_scene(path).start(15)
    assert system.field == GF(2**61 - 1)
    step = system.translation([34, 27], multiple=2)
    for _ in range(12):
        state = step(state)
    assert tuple(found.gamma[-1]) == state.gamma
    assert main(["run", str(path), "--out", str(tmp_path / "there")]) == 0
    assert "exactly" in capsys.readouterr().out
    stored = json.loads((tmp_path / "there" / "result.json").read_text(encoding="utf-8"))
    assert stored["trajectory"]["steps"] == list(range(13))
    assert stored["trajectory"]["M"][-1] == list(state.M)
    with pytest.raises(ArgumentError, match="digits: 30 given; an orbit over GF"):
        run(path, digits=30)


@pytest.mark.parametrize(
    ("given", "call"),
    [
        ('"keyless"', lambda s: s.keyless()),
        ('"keyless", signs = [1, -1, 1]', lambda s: s.keyless([1, -1, 1])),
        ('"torsion", signs = [1, -1, 1]', lambda s: s.torsion([1, -1, 1])),
        ('"translation", points = [3, 4], sheets = [1, -1]', lambda s: s.translation([3, 4], [1, -1])),
        ('"multiplication", factor = -3', lambda s: s.multiplication(-3)),
        ('"conic", x0 = 0, y0 = "0.3"', lambda s: s.conic(0.0, 0.3)),
        ('"conic", y0 = "0.3", sign = -1', lambda s: s.conic(None, 0.3, -1)),
    ],
)
def test_what_kinds_there_are(write, given, call):
    text = ORBIT.replace('"translation", points = [34, 27], multiple = 2', given).replace("count = 12", "count = 1")
    if "conic" in given:
        text = text.replace("chaplygin_ball", "euler_top").replace("d = 1\n", "")
    scene = load_scene(write(text))
    system, state = scene.start(15)
    assert scene.step(system, 15)(state) == call(system)(state)


def test_maps_are_composed_in_their_order(write):
    maps = '{ kind = "translation", conjugate = [0, "0.05"] }, { kind = "keyless" }'
    text = ORBIT.replace('{ kind = "translation", points = [34, 27], multiple = 2 }', maps)
    scene = load_scene(write(text))
    system, state = scene.start(15)
    expected = system.keyless()(system.translation([0.05j, -0.05j])(state))
    assert scene.step(system, 15)(state) == expected
    precise, start = scene.start(40)
    image = scene.step(precise, 40)(start)
    assert max(abs(float(x) - y) for x, y in zip(image.gamma, expected.gamma, strict=True)) < 1e-13


@pytest.mark.parametrize(("weights", "factor"), [('["1/2", 0]', 0.5), ('[0, "1/4"]', 0.25)])
def test_a_shift_has_weights(write, weights, factor):
    text = ORBIT.replace('"translation", points = [34, 27], multiple = 2', f'"shift", weights = {weights}')
    scene = load_scene(write(text.replace("count = 12", "count = 1")))
    system, state = scene.start(15)
    first = weights.startswith('["1')
    shift = system.shift((lambda h1, h2: factor * h1) if first else (lambda h1, h2: factor * h2))
    assert scene.step(system, 15)(state) == shift(state)


@pytest.mark.parametrize(
    ("name", "order"), [("GF(101)", 101), ("GF(2^61-1)", 2**61 - 1), ("GF(7^3)", 343), ("GF(2^127 - 1)", 2**127 - 1)]
)
def test_names_of_finite_fields(name, order):
    assert finite_field(name).order == order


@pytest.mark.parametrize("name", ["tilde", "check", "hat"])
def test_an_orbit_on_two_curves(write, name):
    text = ORBIT.replace("chaplygin_ball", name).replace("d = 1\n", "")
    text = text.replace("points = [34, 27], multiple = 2", "points = [30, -30]")
    found = run(write(text))
    (row,) = found.report.rows
    assert max(row.error_gamma, row.error_M, *row.drift.values()) < 1e-11
    assert list(row.drift) == ["C1", "C2", "H", "K"]
    assert found.gamma.shape == (13, 3)


REFUSED = [
    (
        ORBIT.replace("chaplygin_ball", "tilde"),
        "multiple = 2",
        "signs = [1, 1, 1]",
        'signs: given; kind = "translation"',
    ),
    (ORBIT.replace("chaplygin_ball", "tilde"), '"translation"', '"keyless"', '"keyless" given; (known: translation)'),
    (TILDE, "potential = [", "potential = [1, ", '[body] potential: [1, "0.1", '),
    (TILDE, '"tilde"', '"check"', "[body] d: unknown key; (known: inertia, potential)"),
    (TILDE, '"tilde"', '"gyroscopic"', "[body] d: unknown key"),
    (TILDE, "[start]\n", "[start]\ntilted = true\n", "[start] tilted: unknown key"),
    (TILDE, "[run]", "[report]\nsteps = [10]\n[run]", "[report] steps: unknown key"),
    (TILDE, "[body]", 'field = "GF(7)"\n[body]', "a finite field needs [steps]"),
    (ORBIT, "[steps]", "[run]\ntimes = [1]\n[steps]", "either [run], a motion, or [steps], an orbit"),
    (ORBIT, "count = 12", "count = 0", "[steps] count: 0 given; an integer ≥ 1 is needed"),
    (ORBIT, "count = 12", "cuont = 12", '[steps] cuont: unknown key; did you mean "count"?'),
    (ORBIT, "count = 12", "count = 12\ndigits = [15, 12]", "[steps] digits: [15, 12] given; different costs"),
    (ORBIT, "count = 12", "count = 12\ndigits = [30]\ntruth_digits = 30", "truth_digits: 30 given; at least 40"),
    (ORBIT, '"translation"', '"transaltion"', 'maps[0]: kind: "transaltion" given; did you mean "translation"?'),
    (ORBIT, "points = [34, 27], ", "", "maps[0]: points: either points"),
    (ORBIT, "points = [34, 27]", "points = [34, 27], conjugate = [0, 1]", "maps[0]: points: either points"),
    (ORBIT, "multiple = 2", "factor = 2", 'maps[0]: factor: given; kind = "translation" takes points'),
    (ORBIT, "multiple = 2", "sheets = [1, 2]", "maps[0]: sheets: [1, 2] given; a list of signs 1 and -1"),
    (ORBIT, "multiple = 2", "multiple = 0", "[steps] maps: multiple = 0"),
    (ORBIT, "points = [34, 27]", "points = [34, 27, 3]", "[steps] maps: points = "),
    (ORBIT, '"translation", points = [34, 27], multiple = 2', '"multiplication"', "factor: missing; an integer"),
    (ORBIT, '"translation", points = [34, 27], multiple = 2', '"conic", y0 = 1', "[steps] maps: d = 1"),
    (ORBIT, '[{ kind = "translation", points = [34, 27], multiple = 2 }]', "[]", "[steps] maps: [] given"),
    (ORBIT, "count = 12", 'count = 12\n[output]\npictures = ["work_precision"]', '"work_precision" given; (known:'),
    (EXACT, "count = 12", "count = 12\ndigits = [15]", "[steps] digits: unknown key"),
    (EXACT, "count = 12", 'count = 12\n[output]\npictures = ["sphere"]', "no place in a picture"),
    (EXACT, "GF(2^61-1)", "GF(2^61-3)", "scene scene.toml: field: "),
    (EXACT, "GF(2^61-1)", "F_7", 'field: "F_7" given; GF(101), GF(2^61-1) or GF(7^3) would be one'),
    (EXACT, "GF(2^61-1)", "9" * 5000, '9… (5000 characters)" given; GF(101), '),
    (EXACT, "GF(2^61-1)", "GF(5)", "[start] 12/25 has a denominator that is zero in GF(5)"),
]


@pytest.mark.parametrize(("text", "old", "new", "message"), REFUSED, ids=[row[3] for row in REFUSED])
def test_what_is_wrong_is_named(write, text, old, new, message):
    assert old in text
    path = write(text.replace(old, new, 1))
    with pytest.raises(ArgumentError) as caught:
        run(path)
    said = str(caught.value)
    assert said.startswith("scene scene.toml:")
    assert message in said
    assert "\n" not in said
