"""Moving pictures of runs."""

from __future__ import annotations

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
