"""The bound of 1/g on a short run, by which hopeless runs are given up before they begin."""

from __future__ import annotations

import numpy as np
import pytest

from integrable import ChaplyginBall
from integrable.motion import short


@pytest.mark.parametrize("inertia", [(1, 2, 3), (3, 1, 2), (0.01, 0.02, 0.0299), (1, 30, 900)])
@pytest.mark.parametrize("d", [1e-6, 0.7, 40.0])
def test_no_run_that_leads_to_its_end_is_given_up(inertia, d, monkeypatch) -> None:
    """A limit slightly above the number of a run's panels is enough for it, even if its pace is underestimated."""
    ball = ChaplyginBall(inertia, d)
    generator = np.random.default_rng(1)
    found = 0
    for _ in range(4):
        gamma, M = generator.normal(size=(2, 3))
        gamma /= np.linalg.norm(gamma)
        state = ball.state(gamma, M - (gamma @ M) * gamma)
        for time in (40.0, -90.0):
            monkeypatch.setattr(short, "panels_within", lambda *_: 1000)
            run = short.ShortRuns(ball, state)
            if run.at(np.array([time])) is None or not run.panels:
                continue
            monkeypatch.setattr(short, "panels_within", lambda *_, most=run.panels + run.panels // 4 + 2: most)
            assert short.ShortRuns(ball, state).at(np.array([time])) is not None
            found += 1
    assert found or d == 40.0
