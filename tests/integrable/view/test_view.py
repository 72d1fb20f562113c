"""The animated page: its numbers are those of the motion, and it works in a browser."""

from __future__ import annotations

import json
import re

import numpy as np
import pytest

from integrable.__main__ import main
from integrable.scene.file import load_scene, scene_names
from integrable.view.ovals import ovals
from integrable.view.page import view
from integrable.view.shown import shown
from jacobian.errors import ArgumentError, NotRepresentable
from tests.browser import opened


@pytest.mark.thinned(2)
@pytest.mark.parametrize("name", ["chaplygin", "euler_top", "tilted_ball", "different_moments"])
def test_the_points_lie_on_the_curve_and_their_angles_on_a_line(name):
    """The angles are integrals along the ovals, computed without the flow; by Abel's theorem they are linear in τ."""
    scene = load_scene(name)
    system, state = scene.start(15)
    rate = float(np.linalg.norm(system._omega_along(np.array([state.gamma]), np.array([state.M]))))
    run = system.motion_through(state).at(np.linspace(0, 30 / rate, 1500))
    found = ovals(system, list(run))
    upright = system if not scene.tilted else system.upright(state)[0]
    start = state if not scene.tilted else system.upright(state)[1]
    f = np.polynomial.Polynomial(upright.body.polynomial(*upright.integrals(start)[2:]))
    height = abs(found.y).max(axis=0)
    assert (abs(found.y**2 - f(found.u)) < 1e-11 * height**2).all()
    for k in (0, 1):
        angle = found.angles[:, k]
        rate, start = np.polyfit(run.tau, angle, 1)
        assert abs(angle - rate * run.tau - start).max() < 1e-11
        assert abs(found.rates[k] - rate) * np.ptp(run.tau) < 1e-11
        assert np.ptp(angle) > 0
    # a portrait counts the second angle from the upper end of its oval, and has the integrals in closed form
    portrait = system.motion_through(state).portrait
    assert abs((found.angles[0] - [0, 0.5] - portrait.angles + 0.5) % 1 - 0.5).max() < 1e-12
    assert np.allclose(found.rates, portrait.tau_frequencies, rtol=1e-12, atol=0)


def test_a_curve_without_two_ovals_is_refused_by_name():
    scene = load_scene("equal_moments")
    system, state = scene.start(15)
    with pytest.raises(NotRepresentable, match="shrunk or met"):
        ovals(system, [state, state])


@pytest.mark.parametrize(
    ("name", "frames", "why"),
    [("chaplygin", 20, "the 20 frames"), ("thin_ball", 600, "the 600 frames"), ("heavy_ball", 600, "rounding")],
)
def test_why_there_is_no_torus(name, frames, why):
    """A long motion with few frames used to be taken for one that loses digits."""
    content = shown(name, frames=frames)
    assert "angles" not in content
    assert len(content["missing"]) == 1
    assert why in content["missing"][0]


def test_the_ball_rolls_without_slipping():
    """In the numbers of the page, the centre of the ball has the velocity ω × (the radius upwards)."""
    content = shown("chaplygin", until=0.5, frames=200)
    turning = np.array(content["turning"]).reshape(-1, 3, 3)
    contact = np.array(content["contact"])
    run = load_scene("chaplygin")
    system, state = run.start(15)
    omega = np.einsum("nij,nj->ni", turning, system.flow(state).at(np.linspace(0, 0.5, 200)).omega)
    way = np.gradient(contact, 0.5 / 199, axis=0)[5:-5]
    assert abs(way - np.stack([omega[:, 1], -omega[:, 0]], axis=1)[5:-5]).max() < 2e-2 * abs(way).max()
    assert (abs(turning[:, 2] - np.array(content["gamma"])) < 1e-4).all()  # the upward direction in the body is γ


SLOW = {"separatrix"}  # its states need more digits than floats have


@pytest.mark.parametrize("name", [pytest.param(n, marks=[pytest.mark.slow] * (n in SLOW)) for n in scene_names()])
def test_every_scene_has_a_page_or_is_refused_by_name(name):
    scene = load_scene(name)
    if scene.finite_field or scene.classical:
        with pytest.raises(ArgumentError, match="no picture"):
            shown(scene)
        return
    content = shown(scene, frames=20)
    assert np.allclose(np.linalg.norm(content["gamma"], axis=1), 1, atol=1e-4)
    assert ("turning" in content) + ("points" in content) + len(content["missing"]) == 2
    json.dumps(content, allow_nan=False)


@pytest.mark.parametrize("until", ["x", [1, 2], 1j, float("inf"), 0])
def test_a_last_time_that_is_none_is_refused_by_name(until):
    with pytest.raises(ArgumentError, match="until = "):
        shown("chaplygin", until=until)


@pytest.mark.parametrize("out", [None, 3, ""])
def test_a_page_without_a_name_is_refused(out):
    with pytest.raises(ArgumentError, match=r"out = .*: give the path of an \.html file"):
        view("chaplygin", out)


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (["--until", "-1"], "until = -1.0"),
        (["--until", "nan"], "until = nan"),
        (["--frames", "1"], "frames"),
        (["--out", "ball.toml/page.html"], "out: "),
    ],
)
def test_wrong_arguments_get_one_line(tmp_path, monkeypatch, capsys, options, said):
    pytest.importorskip("plotly")
    monkeypatch.chdir(tmp_path)
    (tmp_path / "ball.toml").write_text("", encoding="utf-8")
    assert main(["view", "chaplygin", *options]) == 2
    captured = capsys.readouterr()
    assert captured.out == ""
    assert said in captured.err
    assert captured.err.count("\n") == 1


@pytest.mark.slow
@pytest.mark.parametrize(("name", "width"), [("chaplygin", 1280), ("chaplygin", 390), ("hat", 1280), ("keyless", 1280)])
def test_the_page_moves_in_a_browser(tmp_path, monkeypatch, capsys, name, width):
    """There are no console errors or external requests; the slider and Play move the drawing."""
    pytest.importorskip("plotly")
    monkeypatch.chdir(tmp_path)
    assert main(["view", name, "--frames", "100"]) == 0
    assert "runs/" in capsys.readouterr().out.replace("\\", "/")
    text = (tmp_path / "runs" / name / "view.html").read_text(encoding="utf-8")
    assert not re.search(r"""<(script|img|link)[^>]*(src|href)=["'](?!data:)""", text)
    drawn = """() => JSON.stringify(["ball", "sphere"].map(id =>
        (document.getElementById(id).data || []).map(trace => [trace.x[0], trace.z && trace.z[0]])))"""
    with opened(width) as (page, complaints):
        page.goto((tmp_path / "runs" / name / "view.html").as_uri())
        page.wait_for_function("() => window.drawFrame")
        before = page.evaluate(drawn)
        page.evaluate(
            "() => { const s = document.getElementById('slider'); s.value = 40; s.dispatchEvent(new Event('input')); }"
        )
        after = page.evaluate(drawn)
        assert before != after
        # slow, so that the motion does not end before the second click on a busy machine
        page.select_option("#speed", "0.25")
        page.click("#play")
        page.wait_for_function("() => Number(document.getElementById('slider').value) > 40")
        page.click("#play")
        assert page.text_content("#play") == "Play"
        assert page.text_content("#time") != ""
        assert page.evaluate("document.documentElement.scrollWidth") <= width
        # controls for fingers are at least 44 pixels high
        heights = "() => [...document.querySelectorAll('#controls > :not(output)')].map(e => e.offsetHeight)"
        assert all(height == 0 or height >= 44 for height in page.evaluate(heights))
        unnamed = "() => [...document.querySelectorAll('.plot')].filter(p => !p.getAttribute('aria-label')).length"
        assert page.evaluate(unnamed) == 0
        assert complaints == []


@pytest.mark.slow
def test_the_page_follows_the_theme_of_its_reader(tmp_path):
    pytest.importorskip("plotly")
    out = view("chaplygin", tmp_path / "ball.html", frames=100)
    looks = """() => [getComputedStyle(document.body).backgroundColor, getComputedStyle(document.body).color,
        ...["ball", "sphere", "ovals", "torus"].map(id => document.getElementById(id).layout.paper_bgcolor)]"""
    seen = {}
    with opened() as (page, complaints):
        for scheme in ("light", "dark"):
            page.emulate_media(color_scheme=scheme)
            page.goto(out.as_uri())
            page.wait_for_function("() => window.drawFrame")
            seen[scheme] = page.evaluate(looks)
        assert complaints == []
    assert seen["light"] == ["rgb(255, 255, 255)", "rgb(34, 34, 34)", *["#fff"] * 4]
    assert seen["dark"] == ["rgb(20, 24, 28)", "rgb(230, 230, 230)", *["#14181c"] * 4]


@pytest.mark.slow
def test_lines_on_the_torus_reach_its_edges(tmp_path):
    """The lines used to end at the last frame before an edge, so that every crossing left a gap."""
    pytest.importorskip("plotly")
    out = view("chaplygin", tmp_path / "ball.html", frames=100)
    with opened() as (page, complaints):
        page.goto(out.as_uri())
        page.wait_for_function("() => window.drawFrame")
        x, y = page.evaluate("() => { const d = document.getElementById('torus').data[0]; return [d.x, d.y]; }")
        gaps = [k for k, value in enumerate(x) if value is None]
        assert len(gaps) > 5
        for k in gaps:
            assert any({side[k - 1], side[k + 1]} == {0, 1} for side in (x, y))
        assert complaints == []


@pytest.mark.slow
def test_the_captions_are_of_the_body_that_is_shown(tmp_path):
    """The caption for a top used to describe a ball that rolls on a plane."""
    pytest.importorskip("plotly")
    text = {
        name: view(name, tmp_path / f"{name}.html", frames=20).read_text(encoding="utf-8")
        for name in ("euler_top", "chaplygin")
    }
    captions = {
        name: re.search(r'aria-label="The body, turning".*?</figcaption>', page, re.S)[0] for name, page in text.items()
    }
    assert "plane" not in captions["euler_top"]
    assert "touched the plane" in captions["chaplygin"]


@pytest.mark.slow
def test_a_picture_and_a_video_are_saved(tmp_path):
    pytest.importorskip("plotly")
    out = view("euler_top", tmp_path / "top.html", frames=4)
    with opened() as (page, complaints):
        page.goto(out.as_uri())
        page.wait_for_function("() => window.drawFrame")
        with page.expect_download() as found:
            page.click("#picture")
        assert found.value.suggested_filename == "euler_top.png"
        with page.expect_download() as found:
            page.click("#video")
        assert found.value.suggested_filename.startswith("euler_top.")
        assert (found.value.path()).stat().st_size > 1000
        assert complaints == []
