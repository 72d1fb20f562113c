"""The default objects: a body and a state of it without arguments."""

import numpy as np

from integrable import ChaplyginBall, EulerTop, load_scene


def test_the_example_is_the_first_scene():
    ball, state = ChaplyginBall.example()
    scene = load_scene("chaplygin")
    assert ball == ChaplyginBall([float(x) for x in scene.inertia], float(scene.d))
    assert state == ball.state([float(x) for x in scene.gamma], [float(x) for x in scene.M])


def test_the_t_handle_is_its_scene_and_turns_over_and_back():
    """It spins nearly about its middle axis, so that M₂ goes from almost |M| to almost −|M| and back."""
    top, state = EulerTop.t_handle()
    scene = load_scene("t_handle")
    assert top == EulerTop([float(x) for x in scene.inertia])
    assert state == top.state([float(x) for x in scene.gamma], [float(x) for x in scene.M], tilted=True)
    middle = top.flow(state).at(np.linspace(0, 100, 1000)).M[:, 1]
    assert middle.min() < -1.49
    assert middle.max() > 1.49
    assert np.count_nonzero(np.diff(np.sign(middle))) >= 4
