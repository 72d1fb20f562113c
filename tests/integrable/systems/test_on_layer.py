"""The ball and the top among the systems of any genus: their flow has the methods of every other."""

from __future__ import annotations

import numpy as np
import pytest

from integrable.classical.toda import TodaLattice
from integrable.mumford.flow import MumfordFlow, Path
from integrable.systems.on_layer import BodyOnLayer

STATE = (0.48, 0.6, 0.64), (0.384, 1.28, -1.488)


@pytest.mark.parametrize("d", [0, 0.7])
def test_the_flow_of_a_body_has_what_every_flow_of_the_layer_has(d) -> None:
    system = BodyOnLayer((1, 2, 3), d)
    flow = system.flow(system.state(*STATE))
    names = {name for name in dir(MumfordFlow) if not name.startswith("_")}
    assert names <= set(dir(flow))
    run, body = flow.at([0.5, 2]), flow.system
    assert body == system.body
    assert {name for name in dir(Path) if not name.startswith("_")} <= set(dir(run))
    assert (run.q == body.flow(body.state(*STATE)).at([0.5, 2]).gamma).all()
    assert (run.p == run.M).all()


def test_enclosures_in_the_time_of_the_flow() -> None:
    """Balls at values of τ contain the states there."""
    flow = BodyOnLayer((1, 2, 3), 0.7).flow(BodyOnLayer((1, 2, 3), 0.7).state(*STATE))
    run, found = flow.at_tau([1.25]), flow.enclosure_at_tau([1.25])
    for balls, row in ((found.q[0], run.gamma[0]), (found.p[0], run.M[0])):
        assert all(abs(float(x.mid()) - y) < 1e-14 for x, y in zip(balls, row, strict=True))


def test_portrait_spectrum_and_sections_by_both_methods() -> None:
    """The ball's own closed forms, tables and clock, and integrals over the ovals of the layer."""
    ball = BodyOnLayer((1, 2, 3), 0.7)
    own, other = (way(ball.state(*STATE)) for way in (ball.flow, ball.by_additions))
    assert np.allclose(np.abs(own.portrait.frequencies), np.abs(other.portrait.frequencies), rtol=1e-15, atol=0)
    lines, more = own.spectrum(), other.spectrum()
    # frequency and size of the strongest lines of M
    found, expected = (
        sorted(zip(np.linalg.norm(M, axis=1), x.frequencies, strict=True))[-15:]
        for M, x in ((lines.M, lines), (more.p, more))
    )
    assert np.allclose(found, expected, rtol=1e-12, atol=0)
    for axis, oval, end in (("largest", 0, "lower"), ("least", 1, "upper")):
        assert np.allclose(own.section(20, axis).times, other.section(20, oval, end).times, rtol=1e-13, atol=0)


def test_a_run_is_a_sequence_of_states() -> None:
    chain = TodaLattice(3)
    path = chain.flow(chain.state((0, 1, 2), (1, 0, 0))).certify([0, 0.5, 1])
    assert [state.q for state in path] == [tuple(q) for q in path.q.tolist()]
    assert (path[-1], len(path[1:]), path[[2]].times.tolist()) == (path[2], 2, [1.0])
    assert path[1:].digits.tolist() == path.digits[1:].tolist()
    assert chain.flow(path[0]).at([1]).p[0] == pytest.approx(path.p[2], abs=1e-14)
