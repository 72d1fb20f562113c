"""Frequencies, actions, angles, sections and lines of the deformations' motions, compared with integrations."""

from __future__ import annotations

from functools import cache
from random import Random

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import root

from integrable import Check, Gyroscopic, Hat, Tilde
from jacobian import GF, MP, RR
from jacobian.errors import ArgumentError, NotRepresentable, PrecisionLoss
from jacobian.immutable import replaced
from jacobian.native.library import Library
from tests.integrable.deformed_systems import KINDS, random_deformation

START = ((0.48, 0.6, 0.64), (0.384, 1.28, -1.488))
POLES = (0, 0, 0.25, 0.5, 0.125)
SYSTEMS = {
    "tilde": Tilde((1, 2, 4)),
    "tilde, d": Tilde((4, 1, 2), 0.7),
    "check": Check((1, 2, 4)),
    "hat": Hat((2, 1, 4)),
    "poles": Tilde((1, 2, 4), potential=POLES),
    "strong poles": Tilde((2, 4, 1), potential=(0, 0, 2, 0.5, 0.125)),
}
FREE, IN_POLES = ("tilde", "tilde, d", "check", "hat"), ("poles", "strong poles")


@cache
def flow_of(name):
    system = SYSTEMS[name]
    return system.flow(system.state(*START))


def state_near(system, x):
    """The state nearest to six numbers: γ becomes a unit vector, and M orthogonal to it."""
    gamma = x[:3] / np.linalg.norm(x[:3])
    return system.state(gamma.tolist(), (x[3:] - gamma * (gamma @ x[3:])).tolist())


def slowness(system, gamma):
    """dt/dτ = 1/g, g⁻² = ΣI_ia_iγ_i²."""
    contact = np.array(system.body.inertia) * np.array(system.a)
    return np.sqrt(gamma**2 @ contact) if system.d else np.ones(gamma.shape[:-1])


@cache
def mean_slowness(name):
    """The mean of dt/dτ along a run with weights that vanish at both ends (Das et al. 2017)."""
    count = 40_000
    part = (np.arange(count) + 0.5) / count
    weights = np.exp(-1 / (part * (1 - part)))
    return weights @ slowness(SYSTEMS[name], flow_of(name).at_tau(2000 * part).gamma) / weights.sum()


# --- the loops of one point


def eigenvalue(system, x, k):
    """The larger (k = 0) or the smaller of the numbers with the sum H and the product −K, or −K/Πa_i for a hat pair."""
    _, _, H, K = system.integrals(state_near(system, x))
    product = K / np.prod(system.a) if isinstance(system, Hat) else K
    spread = np.sqrt(H * H + 4 * product)
    return (H - spread if k else H + spread) / 2


def one_loop(system, k):
    """The time in which the flow of half the eigenvalue k returns to the start, and ∮p dq of this loop."""
    start = np.array(sum(START, ()))

    def rates(_, y):
        x, h = y[:6], 1e-5
        slopes = [(eigenvalue(system, x + h * e, k) - eigenvalue(system, x - h * e, k)) / (4 * h) for e in np.eye(6)]
        rate = np.array(system.poisson(state_near(system, x))) @ slopes
        # γ and gM, with the ball's g, obey the brackets of e(3), whose canonical form is (γ × gM, dγ)
        return [*rate, np.cross(x[:3], x[3:]) @ rate[:3] / slowness(system, x[:3])]

    first = np.array(rates(0, start))[:6]

    def ahead(_, y):
        return (y[:6] - start) @ first

    ahead.direction = 1
    y, time = np.append(start, 0.0), 0.0
    ahead.terminal = True
    for _ in range(20):
        # a step away from the start, where the event is
        run = solve_ivp(rates, (0, 0.05), y, method="DOP853", rtol=1e-8, atol=1e-10)
        run = solve_ivp(rates, (0, 100), run.y[:, -1], method="DOP853", rtol=1e-8, atol=1e-10, events=ahead)
        y, time = run.y[:, -1], time + 0.05 + run.t[-1]
        if np.abs(y[:6] - start).max() < 1e-4:
            return time, y[6]
    raise AssertionError("no loop")


@pytest.mark.thinned(2)
@pytest.mark.thinned(3)
@pytest.mark.parametrize("k", [0, 1])
@pytest.mark.parametrize("name", SYSTEMS)
def test_the_loop_of_one_point_has_its_period_and_its_action(name, k) -> None:
    """The eigenvalues are functions of one point each. The flow of half of one moves this point alone, at its ν."""
    system, portrait = SYSTEMS[name], flow_of(name).portrait
    # H of a check pair is −e3 times the sum of the two eigenvalues of its tilde pair
    time, area = one_loop(system, 1 - k if name == "check" else k)
    nu = portrait.frequencies[k] * mean_slowness(name)
    turns = time * abs(nu)
    assert turns == pytest.approx(1 if name in IN_POLES else 2, rel=2e-6)
    assert area / (2 * np.pi * turns) == pytest.approx(np.sign(nu) * portrait.actions[k], rel=2e-6)


# --- runs of both points


@pytest.mark.thinned(3)
@pytest.mark.parametrize(("oval", "end", "place"), [(0, "lower", 0), (1, "upper", 2)])
@pytest.mark.parametrize("name", FREE)
def test_crossings_are_those_of_an_integration(name, oval, end, place) -> None:
    """At the outer ends a component of γ × M vanishes; at d = 0 the crossings are 1/|f| apart."""
    system, flow = SYSTEMS[name], flow_of(name)
    # the ovals of a check and a hat pair are those of the tilde pair of A⁻¹
    order = np.argsort(system.body.inertia if isinstance(system, Check | Hat) else system.a)
    axis = int(order[place])

    def rates(_, x):
        rate = system.vector_field(state_near(system, x))
        return [*rate.gamma, *rate.M]

    def crossed(_, x):
        return np.cross(x[:3], x[3:])[axis]

    run = solve_ivp(rates, (0, 60), sum(START, ()), method="DOP853", rtol=1e-11, atol=1e-13, events=crossed)
    (true,) = run.t_events
    section, f = flow.section(len(true), oval, end), flow.portrait.frequencies[oval]
    assert np.abs(section.times - true).max() < 1e-7
    assert abs(60 * abs(f) - len(true)) < 1
    if not system.d:
        assert np.abs(np.diff(true) * abs(f) - 1).max() < 1e-7


def separated(system, run):
    """ũ1 < ũ2 of a pair with poles, roots of ΣE_i²(x − a_j)(x − a_k) with E_i² = b_i/γ_i² + w_i², w = γ × M."""
    a, squares = np.array(system.a), np.array(POLES[2:]) / run.gamma**2 + np.cross(run.gamma, run.M) ** 2
    polynomials = sum(squares[:, [i]] * np.poly([a[i - 2], a[i - 1]]) for i in range(3))
    return np.array([np.sort(np.roots(p).real) for p in polynomials])


@pytest.mark.thinned(3)
@pytest.mark.parametrize("end", ["lower", "upper"])
@pytest.mark.parametrize("oval", [0, 1])
def test_a_section_in_poles_is_an_extreme_of_a_separated_variable(oval, end) -> None:
    system, flow = SYSTEMS["poles"], flow_of("poles")
    values = separated(system, flow.at(np.linspace(0, 60, 20_001)))[:, oval]
    extreme = values.min() if end == "lower" else values.max()
    section = flow.section(20, oval, end)
    assert np.abs(separated(system, section.run)[:, oval] - extreme).max() < 1e-6 * (values.max() - values.min())
    assert np.abs(np.diff(section.times) * flow.portrait.frequencies[oval]) == pytest.approx(1, rel=1e-12)


@pytest.mark.parametrize("name", SYSTEMS)
def test_crossings_ascend_and_rotate(name) -> None:
    flow = flow_of(name)
    for oval, end in ((0, "upper"), (1, "lower")):
        section = flow.section(300, oval, end)
        assert len(section) == 300
        assert section.times[0] > 0
        assert (np.diff(section.times) > 0).all()
        steps = np.diff(section.theta, axis=0) - section.rotation
        assert abs((steps + 0.5) % 1 - 0.5).max() < 1e-12
        if name in FREE:
            w = np.cross(section.run.gamma, section.run.M)
            # the axis of the middle moment
            assert abs(w[:, np.argsort(SYSTEMS[name].a)[1]] / np.linalg.norm(w, axis=1)).max() < 1e-11


@pytest.mark.parametrize("name", ["tilde, d", "check", "poles"])
def test_angles_are_linear_in_tau_and_vanish_at_the_lower_ends(name) -> None:
    flow, system = flow_of(name), SYSTEMS[name]

    def angles(run):
        return np.array(system.flow(state_near(system, np.append(run.gamma[0], run.M[0]))).portrait.angles)

    def off(found, wanted):
        return abs((found - wanted + 0.5) % 1 - 0.5).max()

    nu = np.array(flow.portrait.frequencies) * mean_slowness(name)
    assert off(angles(flow.at_tau([7.3])), flow.portrait.angles + 7.3 * nu) < 1e-8
    for oval in range(2):
        for end, angle in (("lower", 0), ("upper", 0.5)):
            section = flow.section(1, oval, end)
            # next to an end √ũ is known to half of its digits, and so is the angle
            wanted = np.insert(section.theta[0], oval, angle)
            assert off(angles(section.run), wanted) < 1e-7


# --- digits


@pytest.mark.parametrize("kind", KINDS)
def test_two_precisions_agree(kind) -> None:
    rng, K, fine = Random(3), MP(30), MP(60)
    for _ in range(4):
        system, state = random_deformation(kind, rng)

        portrait = system.flow(state).portrait
        scales = [*portrait.frequencies, *portrait.actions, *portrait.periods]

        def numbers(field, system=system, state=state, scales=scales):
            start = replaced(state, vectors=tuple(tuple(map(field.coerce, v)) for v in state.vectors))
            found = system.over(field).flow(start).portrait
            scaled = zip((*found.frequencies, *found.actions, *found.periods), scales, strict=True)
            return [*(x / scale for x, scale in scaled), *found.angles]

        floats, wide, truth = numbers(RR), numbers(K), numbers(fine)
        for x, y, z in zip(floats, wide, truth, strict=True):
            # angles are rounded relative to a turn
            assert abs(x - z) < 2.3e-16 * max(abs(z), 1)
            assert abs(y - z) < 1e-29 * max(abs(z), 1)


def test_a_section_in_many_digits() -> None:
    system = Tilde((4, 1, 2), "0.7", field=MP(30))
    section = system.flow(system.state(("0.48", "0.6", "0.64"), ("0.384", "1.28", "-1.488"))).section(3, 1, "upper")
    w = [g[2] * m[0] - g[0] * m[2] for g, m in zip(section.run.gamma, section.run.M, strict=True)]
    assert max(map(abs, w)) < 1e-28
    assert np.abs(section.times.astype(float) - flow_of("tilde, d").section(3, 1, "upper").times).max() < 1e-13


# --- lines


@pytest.mark.parametrize("name", IN_POLES)
def test_the_lines_add_up_to_the_motion(name) -> None:
    flow = flow_of(name)
    found, times = flow.spectrum(), np.array([0, -3.7, 25.0, 1234.5])
    run, waves = flow.at(times), np.exp(2j * np.pi * times[:, None] * found.frequencies)
    assert found.quantities == ("gamma", "M", "omega")
    for quantity in found.quantities:
        wanted = getattr(run, quantity)
        assert abs((waves @ getattr(found, quantity)).real - wanted).max() < 3e-12 * abs(wanted).max()
    assert np.allclose(found.frequencies, found.modes @ flow.portrait.frequencies / 2, rtol=0, atol=1e-12)
    assert (found.frequencies > 0).sum() == len(found) - 1


def test_lines_in_poles_are_those_of_interpreted_code(monkeypatch) -> None:
    system = Tilde((1, 2, 4), potential=(0, 0, 8, 8, 8))
    state = system.state(*START)
    true = system.flow(state).spectrum()

    def load(library):
        raise AssertionError(f"{library.name} is compiled")

    monkeypatch.setenv("NUMBA_DISABLE_JIT", "1")
    monkeypatch.setattr(Library, "load", load)
    monkeypatch.setattr(Library, "__getattr__", lambda library, name: load(library))
    found = system.flow(state).spectrum()
    assert found.modes.tolist() == true.modes.tolist()
    for quantity in true.quantities:
        wanted = getattr(true, quantity)
        assert abs(getattr(found, quantity) - wanted).max() <= 1e-15 * abs(wanted).max()


# --- what grows


@pytest.mark.parametrize("name", ["check", "poles"])
def test_the_secular_part_is_what_grows(name) -> None:
    """Frequencies change with two functions of the inputs alone, and the rest of the derivatives stays bounded."""
    found = flow_of(name).sensitivity([1e5 + 7])
    assert abs(found.matrix).max() > 1e4
    assert abs(found.periodic).max() < 10
    assert np.linalg.matrix_rank(found.secular[0] / 1e5, tol=1e-9) == 2


# --- special cases


def test_small_oscillations_have_the_frequencies_of_the_linearized_equations() -> None:
    system = SYSTEMS["poles"]

    def pull(x):
        rate = system.vector_field(state_near(system, np.append(x, [0, 0, 0])))
        return [*rate.M[:2], x @ x - 1]

    gamma = root(pull, START[0], tol=1e-15).x
    flow = system.flow(state_near(system, np.append(gamma, [0, 0, 0])))
    true = np.unique(np.abs(np.linalg.eigvals(system.linearized(flow.state)).imag).round(9))[-2:] / (2 * np.pi)
    portrait = flow.portrait
    assert np.sort(np.abs(portrait.frequencies)) == pytest.approx(true, rel=1e-8)
    assert [f > 0 for f in portrait.frequencies] == [True, False]
    assert max(portrait.actions) < 1e-14
    with pytest.raises(NotRepresentable, match=r"angles: .* rests"):
        _ = portrait.angles
    with pytest.raises(NotRepresentable, match=r"section: .* rests"):
        flow.section(1)


@pytest.mark.parametrize("kind", [Tilde, Check, Hat])
@pytest.mark.parametrize("inertia", [(1, 1 + 1e-14, 2), (1, 1 + 2**-52, 1 + 2**-51)])
def test_a_point_moves_in_the_oval_of_moments_that_differ_in_last_bits(kind, inertia) -> None:
    system = kind(inertia)
    flow = system.flow(system.state(*START))
    wide = flow._through(flow._numbers, MP(60))
    assert flow.portrait.angles == pytest.approx([float(x) for x in wide.portrait.angles], rel=1e-15)
    for oval in (0, 1):
        section, true = flow.section(3, oval), wide.section(3, oval).times.astype(float)
        assert abs(section.times - true).max() <= 1e-15 * true.max()
        w = np.cross(section.run.gamma, section.run.M)
        assert (abs(w).min(axis=1) < 1e-14).all()


def test_a_factor_of_m_changes_all_frequencies() -> None:
    """H is of degree 2 in M: with 3M the frequencies and actions are those with M, times 3; 2Σ2πf·J = H at d = 0."""
    system, portrait = SYSTEMS["hat"], flow_of("hat").portrait
    fast = system.flow(system.state(START[0], [3 * x for x in START[1]])).portrait
    assert fast.frequencies == pytest.approx([3 * f for f in portrait.frequencies], rel=1e-14)
    assert fast.actions == pytest.approx([3 * J for J in portrait.actions], rel=1e-14)
    H = system.integrals(system.state(*START)).H
    assert 2 * np.pi * np.dot(portrait.frequencies, portrait.actions) == pytest.approx(H, rel=1e-13)
    assert portrait.periods == pytest.approx([1 / abs(f) for f in portrait.frequencies])


def test_what_is_refused() -> None:
    flow = flow_of("tilde")
    for wrong in ({"count": 0}, {"count": 3, "oval": 2}, {"count": 3, "end": "left"}):
        with pytest.raises(ArgumentError, match=[*wrong][-1]):
            flow.section(**wrong)
    with pytest.raises(NotRepresentable, match=r"spectrum: .*M is infinite"):
        flow.spectrum()
    weak = Tilde((1, 2, 4), potential=(0, 0, 0.01, 0.01, 0.01))
    with pytest.raises(PrecisionLoss, match=r"spectrum: a grid of .* is needed"):
        weak.flow(weak.state(*START)).spectrum()
    wide = SYSTEMS["poles"].over(MP(20))
    start = wide.state(("0.48", "0.6", "0.64"), ("0.384", "1.28", "-1.488"))
    with pytest.raises(NotRepresentable, match=r"spectrum: .*MP\(20\)"):
        wide.flow(start).spectrum()
    for system in (Gyroscopic((1, 2, 4), 3), Tilde((1, 2, 4), potential=(3, 5, 2, 4, 6)), Tilde((1, 2, 2))):
        motion = system.motion_through(system.state(*START))
        for asked in (lambda m: m.portrait, lambda m: m.spectrum(), lambda m: m.section(1)):
            with pytest.raises(NotRepresentable, match=r"portrait, spectrum, section, secular: .*integrated"):
                asked(motion)
    exact = Tilde((1, 2, 4), field=GF(101))
    with pytest.raises(ArgumentError, match="RR or MP"):
        exact.flow(exact.state((1, 0, 0), (0, 1, 2)))


@pytest.mark.parametrize(
    ("system", "gamma", "M"),
    [
        (Check((1, 1.5, 2)), (3**-0.5,) * 3, (2, -1, -1)),
        (Check((1, 2, 4)), (1 / 3, 2 / 3, 2 / 3), (-4, 1, 1)),
        (Tilde((1, 2, 4)), (0.48, 0.64, 0.6), (-0.9, -1.2, 2)),
    ],
)
def test_a_point_that_starts_at_an_end_of_its_oval_has_a_phase_of_zero(system, gamma, M) -> None:
    """Its phase, noise around 0, had to agree in all digits: PrecisionLoss; a tiny negative phase was 1 modulo 1."""
    flow = system.flow(system.state(gamma, M))
    first, second = flow.portrait.angles
    assert first < 1e-15
    assert 1e-3 < second < 1
    assert np.isfinite(flow.sensitivity([1.0]).secular).all()


def test_secular_parts_do_not_depend_on_the_unit_of_time() -> None:
    """Columns in units of γ and of M were mixed: for |M| = 1e-30 half a percent was wrong, for 1e-60 everything."""
    system, found = SYSTEMS["tilde"], []
    for unit in (1.0, 2.0**-200):
        flow = system.flow(system.state(START[0], [unit * x for x in START[1]]))
        secular = flow.sensitivity([1e4 / unit]).secular[0, :, :6]
        sizes = np.repeat([1, unit], 3)
        found.append(secular / sizes[:, None] * sizes)
    assert abs(found[0] - found[1]).max() < 1e-11 * abs(found[0]).max()
