"""Every system along its motion to T = 3, and every map along an orbit, at 30 digits: integrals kept to 1e-25."""

from __future__ import annotations

import pytest

from integrable import ChaplyginBall, Check, EulerTop, Gyroscopic, Hat, Tilde
from integrable.phase.state import State
from integrable.steps.translation import moving_branch_point
from jacobian import MP

K = MP(30)
GAMMA, M = ("0.48", "0.6", "0.64"), ("0.384", "1.28", "-1.488")
TILTED = ("1.104", "2.18", "-0.528")
# repelling for this start; the kinetic energies are indefinite, so that the other sign may attract
POLES = ("0.02", "0.04", "0.06")
ATTRACTED = ("-0.02", "-0.04", "-0.06")

SYSTEMS = {
    "ball": lambda: ChaplyginBall((1, 2, 3), "0.7", field=K),
    "top": lambda: EulerTop((1, 2, 3), field=K),
    "tilde": lambda: Tilde((1, 2, 4), field=K),
    "tilde, d": lambda: Tilde((1, 2, 4), "0.7", field=K),
    "tilde, potential": lambda: Tilde((1, 2, 4), potential=("0.1", "0.05", *POLES), field=K),
    "tilde, poles": lambda: Tilde((1, 2, 4), potential=(0, 0, *POLES), field=K),
    "tilde, d, potential": lambda: Tilde((1, 2, 4), "0.7", potential=("0.1", "0.05", *POLES), field=K),
    "check": lambda: Check((1, 2, 4), field=K),
    "check, potential": lambda: Check((1, 2, 4), potential=("0.1", "0.05", *ATTRACTED), field=K),
    "hat": lambda: Hat((1, 2, 4), field=K),
    "hat, potential": lambda: Hat((1, 2, 4), potential=("0.1", "0.05", *POLES), field=K),
    "gyroscopic": lambda: Gyroscopic((1, 2, 4), 3, field=K),
}


def drift(system, start, states):
    """The largest change of the integrals, relative where they are above 1."""
    before = system.integrals(start)
    return max(
        abs(x - y) / max(1, abs(y)) for state in states for x, y in zip(system.integrals(state), before, strict=True)
    )


def start_of(name, system):
    if name != "hat, potential":
        return system.state(GAMMA, M)
    # a quarter of M: with the full M a pole is met before T = 3
    return system.state(GAMMA, [K.coerce(x) / 4 for x in M])


@pytest.mark.thinned(3)
@pytest.mark.parametrize("name", SYSTEMS)
def test_the_integrals_of_every_system(name) -> None:
    system = SYSTEMS[name]()
    start = start_of(name, system)
    run = system.motion_through(start).at([3, "1.5", -1])
    states = [State(tuple(x), tuple(m)) for x, m in zip(run.gamma, run.M, strict=True)]
    assert drift(system, start, states) <= 1e-25
    assert max(abs(x - y) for x, y in zip(states[0].gamma, start.gamma, strict=True)) > 1e-3


@pytest.mark.parametrize("name", ["ball", "top"])
def test_the_integrals_of_a_tilted_motion(name) -> None:
    system = SYSTEMS[name]()
    start = system.state(GAMMA, TILTED, tilted=True)
    run = system.flow(start).at([3, -1])
    states = [State(tuple(x), tuple(m), tilted=True) for x, m in zip(run.gamma, run.M, strict=True)]
    assert drift(system, start, states) <= 1e-25


MAPS = {
    "two points": ("ball", lambda s: s.translation(["1.8", "2.5"])),
    "two points, doubled": ("ball", lambda s: s.translation(["1.8", "2.5"], multiple=2)),
    "two points of the top": ("top", lambda s: s.translation(["0.8", "0.9"], multiple=2)),
    "one point and infinity": ("ball", lambda s: s.translation(["1.8"])),
    "a conjugate pair": ("ball", lambda s: s.translation([0.5j, -0.5j])),
    "a conjugate pair of the top": ("top", lambda s: s.translation([0.5j, -0.5j])),
    "the branch point h1/h2, doubled": ("ball", lambda s: s.translation([moving_branch_point, "1.8"], multiple=2)),
    "the branch point 1/d": ("ball", lambda s: s.torsion()),
    "keyless": ("ball", lambda s: s.keyless()),
    "keyless of the top": ("top", lambda s: s.keyless()),
    "three times the divisor": ("ball", lambda s: s.multiplication(3)),
    "a conic": ("top", lambda s: s.conic(0, "0.3")),
    "a conic at infinity": ("top", lambda s: s.conic(None, "0.3")),
    "a time shift": ("ball", lambda s: s.shift(lambda h1, h2: h1 * h2 / 4)),
    "a composition": ("ball", lambda s: s.keyless() @ s.translation(["1.8", "2.5"])),
    "points that move with the integrals": ("ball", lambda s: s.translation([lambda h1, h2: 2 + h1 / 4, "2.5"])),
    "both curves of the tilde pair": ("tilde", lambda s: s.translation(("30", "-30"))),
    "one curve of the tilde pair": ("tilde, d", lambda s: s.translation((None, "-30"))),
    "both curves of the check pair": ("check", lambda s: s.translation(("30", "-30"))),
    "both curves of the hat pair": ("hat", lambda s: s.translation(("30", "-30"))),
}


@pytest.mark.thinned(2)
@pytest.mark.parametrize("name", MAPS)
def test_the_integrals_of_every_map(name) -> None:
    """Along four steps of a map that is not the identity."""
    kind, make = MAPS[name]
    system = SYSTEMS[kind]() if name != "one curve of the tilde pair" else Tilde((1, 2, 4), "0.1", field=K)
    step, states = make(system), [start := system.state(GAMMA, M)]
    for _ in range(4):
        states.append(step(states[-1]))
    assert drift(system, start, states) <= 1e-25
    assert max(abs(x - y) for x, y in zip(states[1].gamma, start.gamma, strict=True)) > 1e-3


# --- deformed systems at special positions


@pytest.mark.parametrize("kind", [Tilde, Check, Hat])
@pytest.mark.parametrize("axis", range(3))
def test_a_vanishing_gamma_on_the_curves(kind, axis) -> None:
    """The flow and the step pass through γ_i = 0."""
    system = kind((1, 2, 4), field=K)
    x = ["0.6", "0.8"]
    x.insert(axis, "0")
    m = ["1.2", "-0.9"]
    m.insert(axis, "0.5")
    sides = [K.coerce(v) for v in m]
    i, j = [k for k in range(3) if k != axis]
    sides[i], sides[j] = K.coerce("0.8"), K.coerce("-0.6")
    start = system.state(x, sides)
    assert start.gamma[axis] == 0
    run = system.flow(start).at([0, "0.5"])
    states = [State(tuple(a), tuple(b)) for a, b in zip(run.gamma, run.M, strict=True)]
    assert max(abs(a - b) for a, b in zip((*states[0].gamma, *states[0].M), (*start.gamma, *start.M), strict=True)) < (
        1e-27
    )
    assert drift(system, start, states) <= 1e-25


@pytest.mark.parametrize("small", ["1e-3", "1e-8"])
def test_a_body_near_the_limit_of_d(small) -> None:
    """As d → 1/max a_i a moment of inertia goes to 0: the tilde flow, its clock and its integrals."""
    system = Tilde((small, 1, 2), "0.7", field=K)
    start = system.state(GAMMA, M)
    run = system.flow(start).at(["0.25", "-0.1"])
    states = [State(tuple(x), tuple(m)) for x, m in zip(run.gamma, run.M, strict=True)]
    assert drift(system, start, states) <= 1e-22
