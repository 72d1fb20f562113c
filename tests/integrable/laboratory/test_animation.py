"""Animated pictures of runs."""

from __future__ import annotations

import os
import shutil

import numpy as np
import pytest

from integrable import RigidBody, RollingBall
from jacobian.errors import ArgumentError

pytest.importorskip("matplotlib")
Image = pytest.importorskip("PIL.Image")

BALL = RollingBall((0.1, 0.12, 0.15), 2, 0.5).motion(np.eye(3), (1.0, 2.0, 3.0))


@pytest.mark.parametrize("motion", [BALL, RigidBody((1, 2, 3)).motion(np.eye(3), (1.0, 2.0, 3.0))])
def test_a_frame_for_each_time(motion, tmp_path):
    path = tmp_path / "run.gif"
    motion.at(np.linspace(0, 1, 4)).animate(path)
    with Image.open(path) as picture:
        assert picture.n_frames == 4
        frames = []
        for k in range(4):
            picture.seek(k)
            frames.append(np.array(picture.convert("L"), dtype=int))
    assert all(abs(x - frames[0]).max() > 50 for x in frames[1:])
    assert [p.name for p in tmp_path.iterdir()] == ["run.gif"]


def test_the_vertical_goes_on_its_sphere(tmp_path):
    """The trail in the second panel grows."""
    path = tmp_path / "run.gif"
    BALL.at(np.linspace(0, 3, 5)).animate(path)
    inked = []
    with Image.open(path) as picture:
        for k in (1, 2, 4):
            picture.seek(k)
            frame = np.array(picture.convert("RGB"), dtype=int)
            inked.append((frame[:, frame.shape[1] // 3 : 2 * frame.shape[1] // 3].max(axis=2) < 200).sum())
    assert inked[0] < inked[1] < inked[2]


@pytest.mark.skipif(shutil.which("ffmpeg") is None, reason="no ffmpeg")
def test_films(tmp_path):
    path = tmp_path / "run.mp4"
    BALL.at(np.linspace(0, 1, 4)).animate(path)
    assert path.read_bytes()[4:8] == b"ftyp"
    assert [p.name for p in tmp_path.iterdir()] == ["run.mp4"]


def test_a_film_without_ffmpeg_is_refused_at_once(tmp_path, monkeypatch):
    monkeypatch.setenv("PATH", "")
    with pytest.raises(ArgumentError, match=r"\.mp4 needs ffmpeg, which is not there; \.gif does without"):
        BALL.at([0, 1]).animate(tmp_path / "run.mp4")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.skipif(os.name != "posix", reason="a shell script")
@pytest.mark.parametrize(
    ("script", "why"),
    [
        ("cat > /dev/null; echo no encoder >&2; exit 1", "ffmpeg has failed (no encoder); .gif does without"),
        ("cat > /dev/null; exit 3", "ffmpeg has failed (exit code 3)"),
        ("exit 3", ""),
    ],
)
def test_an_ffmpeg_that_gives_up_is_one_line(tmp_path, monkeypatch, script, why):
    fake = tmp_path / "bin" / "ffmpeg"
    fake.parent.mkdir()
    fake.write_text(f"#!/bin/sh\n{script}\n", encoding="utf-8")
    fake.chmod(0o755)
    monkeypatch.setenv("PATH", str(fake.parent), prepend=os.pathsep)
    with pytest.raises(ArgumentError, match=r"^path = .*run\.mp4'") as caught:
        BALL.at([0.0, 1.0]).animate(tmp_path / "run.mp4")
    assert why in str(caught.value)
    assert "\n" not in str(caught.value)
    assert [p.name for p in tmp_path.iterdir()] == ["bin"]


def test_bad_calls(tmp_path):
    run = BALL.at([0, 1])
    for call, message in (
        (lambda: run.animate(tmp_path / "run.png"), "ends in .gif or .mp4"),
        (lambda: run.animate(tmp_path / "run.gif", fps=0), "fps = 0"),
        (lambda: run.animate(3), "path = 3: give the path of a .gif or .mp4 file"),
        (lambda: run.animate(tmp_path / "none" / "run.gif"), "give a file in a folder that exists"),
        (lambda: BALL.at([0]).animate(tmp_path / "run.gif"), "nothing that moves"),
    ):
        with pytest.raises(ArgumentError, match=message):
            call()
    assert list(tmp_path.iterdir()) == []
