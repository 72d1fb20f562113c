"""What "auto" takes the costs of a torus for."""

from __future__ import annotations

from integrable.motion.short import FREE, ROLLING, THIN, panels_within, torus_cost


def test_the_costs_of_a_torus_follow_from_its_clock() -> None:
    """Without d there is none; moments that differ much beside d give 1/g many modes; tenths of d are no difference."""
    bodies = ((1.0, 3.0, 0.0), (1.0, 3.0, 0.7), (1e-4, 1.5, 1.0), (0.1, 0.3, 1e3))
    assert [torus_cost(*body) for body in bodies] == [FREE, ROLLING, THIN, ROLLING]


def test_a_torus_that_is_cheap_paid_for_or_there_leaves_fewer_panels() -> None:
    fresh = [panels_within(cost, 1, False, 0) for cost in (FREE, ROLLING, THIN)]
    assert 0 < fresh[0] < fresh[1] < fresh[2]
    assert panels_within(ROLLING, 1, False, 100) < fresh[1] < panels_within(ROLLING, 100, False, 0)
    assert panels_within(ROLLING, 1, True, 0) < 0
