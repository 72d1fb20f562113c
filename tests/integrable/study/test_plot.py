"""Pictures of artificial reports, checked by their contents; no global state is changed."""

from __future__ import annotations

import subprocess
import sys
from dataclasses import replace
from types import SimpleNamespace

import matplotlib as mpl
import numpy as np
import pytest

from integrable.oracles.methods import METHODS
from integrable.scene.looks import LOOKS
from integrable.scene.tables import plain_power
from integrable.study.plot import FLOOR, FORMATS, draw, look_of, residual_growth, sphere, work_precision
from integrable.study.report import _ORACLES, Report, Row, TruthCheck
from jacobian.errors import ArgumentError

ROWS = (
    Row("divisor flow", "first use", total=3.0),
    Row("divisor flow", "floats", digits=15, error_gamma=4e-13, total=2.5e-3, setup=2e-3, evaluation=5e-4),
    Row("divisor flow", "50 digits", error_gamma=4e-49, total=2.5, setup=1.5, evaluation=1.0),
    Row("SciPy DOP853", "tol 1e-6", error_gamma=3e-2, total=0.04),
    Row("SciPy DOP853", "tol 3e-14", error_gamma=1.7e-10, total=0.4),
    Row("SciPy DOP853", "tol 1e-1", note="gave up"),
)
REPORT = Report(
    "A ball",
    (0.0, 1000.0, 11),
    3,
    ROWS,
    TruthCheck(65, 1.0, 1e-64, 1e-64, 0.1),
    ((10, 1e-16), (1000, 3e-15)),
    floor=(2e-13, 3e-13),
)
SCENE = SimpleNamespace(title="A ball")


def curve(count=500):
    t = np.linspace(0, 20, count)
    x, y, z = np.cos(t), 0.9 * np.sin(1.3 * t), 0.4 * np.sin(t)
    gamma = np.stack([x, y, z], axis=1)
    return SimpleNamespace(times=t, gamma=gamma / np.linalg.norm(gamma, axis=1, keepdims=True))


@pytest.mark.parametrize("suffix", FORMATS)
@pytest.mark.parametrize("picture", ["work_precision", "sphere", "residual_growth"])
def test_every_picture_in_every_format(picture, suffix):
    before = mpl.rcParams.copy()
    content = draw(picture, suffix, SCENE, REPORT, curve())
    assert content.startswith(b"\x89PNG" if suffix == "png" else b"<?xml")
    assert len(content) > 5000
    assert mpl.rcParams.copy() == before


def test_work_precision_shows_every_measured_row_once():
    axes = work_precision(REPORT).axes[0]
    assert (axes.get_xscale(), axes.get_yscale()) == ("log", "log")
    texts = [text.get_text() for text in axes.texts]
    assert [text for text in texts if text in ("floats", "50 digits", "tol 1e-6", "tol 3e-14")] == [
        "tol 1e-6",
        "tol 3e-14",
        "floats",
        "50 digits",
    ]
    assert axes.get_title(loc="left").endswith("; lower left is better")
    assert "inputs rounded to doubles: 2e-13" in texts
    shown = {(x, y) for line in axes.lines for x, y in zip(line.get_xdata(), line.get_ydata(), strict=True)}
    assert {(2.5e-3, 4e-13), (5e-4, 4e-13), (2.5, 4e-49), (0.04, 3e-2), (0.4, 1.7e-10)} <= shown
    assert not any("first use" in text or "gave up" in text for text in texts)


def test_work_precision_of_nothing_is_still_a_picture():
    empty = Report("A ball", (0.0, 1.0, 2), 3, (), REPORT.truth, ())
    assert draw("work_precision", "png", SCENE, empty, None).startswith(b"\x89PNG")


@pytest.mark.parametrize(("times", "side"), [((0.04, 0.6), "right"), ((0.6, 7.0), "left")])
def test_the_label_of_the_floor_is_where_no_marks_are(times, side):
    """The label used to cover the mark of the compiled run: its side was chosen by only one of two marks at that
    height.
    """
    flow = [Row("divisor flow", "floats", error_gamma=1.5e-14, total=time, digits=15) for time in reversed(times)]
    rows = (*flow, Row("divisor flow", "30 digits", error_gamma=1e-29, total=8.0),
            Row("SciPy DOP853", "tol 1e-4", error_gamma=0.8, total=0.04))  # fmt: skip
    axes = work_precision(replace(REPORT, rows=rows)).axes[0]
    (label,) = (text for text in axes.texts if text.get_text().startswith("inputs rounded"))
    assert label.get_ha() == side


def test_sphere_shows_each_segment_on_one_side_only():
    shown = curve()
    left, right = sphere(shown.gamma, shown.times, "A ball").axes[:2]
    counts = [len(axes.collections[0].get_segments()) for axes in (left, right)]
    assert sum(counts) == 499
    assert min(counts) > 100
    names = {text.get_text() for axes in (left, right) for text in axes.texts}
    assert {"front: γ₁ ≥ 0", "back: γ₁ ≤ 0, seen from behind", "start"} <= names


def test_residual_growth_has_its_points():
    line = residual_growth(REPORT).axes[0].lines[0]
    assert list(zip(line.get_xdata(), line.get_ydata(), strict=True)) == [(10, 1e-16), (1000, 3e-15)]


def test_a_format_that_is_none_is_refused():
    with pytest.raises(ArgumentError, match='format: "gif" given; one of png, svg is needed'):
        draw("sphere", "gif", SCENE, REPORT, curve())


@pytest.mark.parametrize(
    ("module", "stay_out"), [("motions", {"matplotlib", "scipy"}), ("plot", {"matplotlib.pyplot"})]
)
def test_what_is_not_imported(module, stay_out):
    code = f"import sys, integrable.study.{module}; print(not {stay_out!r} & sys.modules.keys())"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, timeout=60)
    assert done.stdout.strip() == "True"


def test_no_two_methods_look_alike():
    """Each has its own colour, and its own marker or filling: a picture can be read without colours."""
    assert {*METHODS, *_ORACLES} <= set(LOOKS)  # the flow by elliptic curves used to look like an unknown method
    assert len({colour for colour, _, _ in LOOKS.values()}) == len(LOOKS)
    assert len({(marker, filled) for _, marker, filled in LOOKS.values()}) == len(LOOKS)
    assert FLOOR["color"] not in {colour for colour, _, _ in LOOKS.values()}


def test_unlike_runs_of_the_flow_are_not_joined():
    axes = work_precision(REPORT).axes[0]
    joined = [line for line in axes.lines if len(line.get_xdata()) > 2 and line.get_linewidth() > 0]
    flow = {row.total for row in REPORT.rows if row.method != "SciPy DOP853" and row.error_gamma}
    assert not any(set(line.get_xdata()) & flow for line in joined)


@pytest.mark.parametrize(("value", "words"), [(1e12, "10¹²"), (2e-9, "2·10⁻⁹"), (1000.0, "1000"), (0.5, "0.5")])
def test_powers_are_written_one_way(value, words):
    assert plain_power(value) == words


def test_marks_that_are_illegible_on_white_alone_have_an_edge() -> None:
    assert [name for name in LOOKS if "markeredgecolor" in look_of(name)] == ["closed elliptic form"]
