"""Derivatives of the states of systems of any genus, compared with complex steps through an integrator, and identities
that hold for them at any time.
"""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from integrable.classical.henon_heiles import HenonHeiles
from integrable.classical.neumann import Neumann
from integrable.classical.toda import TodaLattice
from integrable.portrait.sensitivity import by_differences
from jacobian import MP, RR
from jacobian.errors import ArgumentError, FieldError, NotRepresentable
from tests.integrable.classical.rows import REAL

STEP = 1e-60j
# q and p are canonical, or q moves on a surface in a space where they are
CANONICAL = [
    ("neumann", 2), ("garnier", 2), ("henon_heiles", 1), ("barriers", 2), ("toda", 4), ("ellipsoid", 2),
    ("pendulum", 3), ("galaxy", 3),
]  # fmt: skip
OTHERS = [("lagrange", 3), ("two_gaps", 2)]


def neumann(q, p, a):
    size = np.sqrt(np.sum(q * q))
    q = q / size
    p = p - np.sum(q * p) * q
    return (q, p), lambda q, p: (p, ((np.sum(a * q * q) - np.sum(p * p)) / np.sum(q * q) - a) * q)


def toda(q, p, none):
    def rates(q, p):
        links = np.exp(np.roll(q, -1) - q)
        return p, links - np.roll(links, 1)

    return (q, p), rates


def pendulum(q, p, none):
    size = np.sqrt(np.sum(q * q))
    q = q / size
    p = p - np.sum(q * p) * q
    return (q, p), lambda q, p: (p, (q[2] - np.sum(p * p)) / np.sum(q * q) * q - np.array([0, 0, 1]))


def geodesic(q, p, a):
    q = q / np.sqrt(np.sum(q * q / a))
    n = q / a
    p = p - np.sum(n * p) / np.sum(n * n) * n
    return (q, p), lambda q, p: (p, -np.sum(p * p / a) / np.sum(q * q / a**2) * q / a)


def star(q, p, given):
    """The motion in the potential −GM/S, by its gradient."""
    (a, c, mass) = given

    def rates(q, p):
        x, y, z = q
        product = np.sqrt(a * a * c * c + c * c * (x * x + y * y) + a * a * z * z)
        total = np.sqrt(np.sum(q * q) + a * a + c * c + 2 * product)
        scale = -mass / total**3
        return p, scale * q * (1 + np.array([c * c, c * c, a * a]) / product)

    return (q, p), rates


FORMULAS = {"neumann": neumann, "toda": toda, "pendulum": pendulum, "ellipsoid": geodesic, "galaxy": star}


def by_complex_steps(name, system, state, times, longest=0.05):
    """∂(q, p)/∂(q(0), p(0), constants) through DOP853: the imaginary parts of runs from complex inputs. Its tolerance
    does not see them, so that steps are short.
    """
    n, inputs = len(state.q), np.array([*state.q, *state.p, *system.constants, *system.parameters], dtype=float)
    columns = []
    for k in range(len(inputs)):
        moved = inputs.astype(complex)
        moved[k] += STEP
        start, rates = FORMULAS[name](*np.split(moved, [n, 2 * n]))
        run = solve_ivp(
            lambda t, y, rates=rates: np.concatenate(rates(*np.split(y, 2))), (0, times[-1]), np.concatenate(start),
            "DOP853", times, rtol=1e-13, atol=1e-13, max_step=longest,
        )  # fmt: skip
        columns.append(run.y.imag.T / STEP.imag)
    return np.stack(columns, axis=2)


@pytest.mark.thinned(4)
@pytest.mark.parametrize(("name", "n"), [("neumann", 2), ("toda", 3), ("pendulum", 3), ("ellipsoid", 2), ("galaxy", 3)])
def test_beside_complex_steps_through_an_integrator(name, n) -> None:
    system, state = REAL[name](RR, n)
    times = [0.0, 4.0]
    found = system.flow(state).sensitivity(times)
    truth = by_complex_steps(name, system, state, times)
    assert found.matrix.shape == truth.shape == (2, 2 * len(state.q), len(found.columns))
    assert abs(found.matrix - truth).max() < 2e-12 * abs(truth).max()
    assert found.way == "integrated"


def rates_of(system, q, p):
    rate = system.vector_field(system.state(q, p))
    return np.array([*rate.q, *rate.p])


@pytest.mark.thinned(2)
@pytest.mark.parametrize(
    ("name", "n"),
    [
        pytest.param(*x, marks=pytest.mark.slow if x[0] in ("barriers", "toda", "galaxy") else ())
        for x in (*CANONICAL, *OTHERS)
    ],
)
def test_the_flow_carries_its_own_field_and_is_symplectic(name, n) -> None:
    """S takes ẋ(0) to ẋ(t), at any time; where q and p are canonical it preserves dq ∧ dp of tangent vectors."""
    system, state = REAL[name](RR, n)
    flow, times = system.flow(state), [0.0, -1e6]
    path, found = flow.at(times), flow.sensitivity(times)
    width = 2 * len(state.q)
    S = found.matrix[:, :, :width]
    size = abs(S).max(axis=(1, 2))
    for k, (q, p) in enumerate(zip(path.q, path.p, strict=True)):
        carried = S[k] @ rates_of(system, state.q, state.p)
        assert abs(carried - rates_of(system, q, p)).max() < 2e-15 * size[k]
    if (name, n) in CANONICAL:
        half = np.eye(width // 2)
        form = np.block([[0 * half, half], [-half, 0 * half]])
        first = S[0].T @ form @ S[0]
        # products of elements of size S cancel
        assert all(abs(x.T @ form @ x - first).max() < 1e-14 * s * s for x, s in zip(S, size, strict=True))
        assert abs(np.linalg.matrix_rank(first) - width) in (0, 2)


def test_the_start_is_projected_onto_its_constraints() -> None:
    """At t = 0 the derivatives are those of the projection; constants have no effect yet."""
    system, state = REAL["neumann"](RR, 2)
    found = system.flow(state).sensitivity([0.0])
    q, p = map(np.array, state)
    first = np.eye(3) - np.outer(q, q)
    assert np.allclose(found.matrix[0, :3, :3], first, rtol=0, atol=1e-15)
    assert np.allclose(found.matrix[0, 3:, 3:6], first, rtol=0, atol=1e-15)
    # ∂(p − (q, p)q) by q along the sphere
    assert np.allclose(found.matrix[0, 3:, :3], -np.outer(q, p @ first), rtol=0, atol=1e-15)
    assert abs(found.matrix[0, :, 6:]).max() < 1e-15
    assert found.columns == ("q0", "q1", "q2", "p0", "p1", "p2", "a0", "a1", "a2")


@pytest.mark.parametrize("time", [pytest.param(-12.5, marks=pytest.mark.slow), 1e6])
def test_a_scaling_of_neumanns_system_in_units_of_any_size(time) -> None:
    """q(t) for (c²a, cp) is q(ct): S applied to (0, p, 2a) is t·ẋ + (0, p)."""
    for unit in (1.0, 2.0**40):
        system = Neumann((unit**2, 2 * unit**2, 4 * unit**2))
        q, p = np.array([0.6, 0.48, 0.64]), unit * np.array([0.4, -0.5, 0.0])
        flow = system.flow(system.state(q, p))
        t = time / unit
        path, found = flow.at([t]), flow.sensitivity([t]).matrix[0]
        wanted = t * rates_of(system, path.q[0], path.p[0]) + np.array([0, 0, 0, *path.p[0]])
        scaled = found @ np.array([0, 0, 0, *p, *(2 * e for e in system.constants)])
        units = np.array([1, 1, 1, unit, unit, unit])
        size = abs(found * [*units, *units[:3] * unit**2] / units[:, None]).max()
        assert abs((scaled - wanted) / units).max() < 1e-14 * size


def test_many_digits_agree_with_floats() -> None:
    system, state = REAL["toda"](RR, 3)
    more = system.over(MP(30))
    exact = more.flow(more.state(state.q, state.p)).sensitivity([2, 1e6])
    found = system.flow(state).sensitivity([2, 1e6])
    assert exact.matrix.dtype == object
    assert abs(found.matrix - exact.matrix.astype(float)).max() < 1e-15 * abs(found.matrix).max()


@pytest.mark.parametrize(
    ("name", "n"),
    [
        ("neumann", 2),
        ("toda", 3),
        ("garnier", 2),
        ("henon_heiles", 1),
        pytest.param("ellipsoid", 2, marks=pytest.mark.slow),
        pytest.param("veselova", 2, marks=pytest.mark.slow),
    ],
)
def test_equations_of_variation_agree_with_differences_of_motions(name, n) -> None:
    """Two methods that share no formula: Taylor series of jets, and motions by additions in 39 digits."""
    system, state = REAL[name](RR, n)
    flow, times = system.flow(state), np.array([0.0, 2.5, -1.5])
    found = flow.sensitivity(times)
    true = by_differences(flow, times)
    assert (found.way, true.way, found.columns) == ("integrated", "differences", true.columns)
    assert abs(found.matrix - true.matrix).max() <= 1e-15 * abs(true.matrix).max()


def test_a_particle_far_from_the_input_has_a_derivative_that_begins_with_a_high_power() -> None:
    chain = TodaLattice(8)
    flow = chain.flow(chain.state((0, 0.5, -0.25, 0, 0.5, 0, 0, 0.25), (1, -1, 0.5, -0.5, 0, 0, 0.25, 0)))
    found = flow.sensitivity([0.5, 3.0])
    assert found.way == "integrated"
    # the map is canonical
    turn = np.kron([[0, 1], [-1, 0]], np.eye(8))
    for S in found.matrix:
        assert abs(S.T @ turn @ S - turn).max() < 1e-14 * abs(S).max() ** 2
    assert 0 < abs(found.matrix[0, 4, 0]) < 1e-4


def test_beside_an_unstable_equilibrium() -> None:
    """The derivatives of a nearly upright pendulum grow like e^t, and still have all their digits."""
    system, state = REAL["pendulum"](RR, 3)
    upright = system.flow(system.state((1e-9, 0, 1), (0, 0, 0))).sensitivity([20.0]).matrix[0]
    assert abs(upright).max() > 1e5
    # the integration loses what the motion magnifies
    truth = by_complex_steps("pendulum", system, type(state)((1e-9, 0.0, 1.0), (0.0, 0.0, 0.0)), [0.0, 20.0], 0.1)[1]
    assert abs(upright - truth).max() < 1e-6 * abs(truth).max()


def test_inputs_without_derivatives_have_no_columns() -> None:
    system = HenonHeiles((1, 2), "-1/2", "-1/4", 0, (0, "1/512"))
    flow = system.flow(system.state((0.01, 0.02, 0.05), (0, 0.01, 0)))
    assert flow.sensitivity([1.0]).columns[6:] == ("a0", "a1", "alpha", "beta", "gamma", "barriers1")
    chain = TodaLattice(2)
    assert chain.flow(chain.state((0, 0), (1, 0))).sensitivity([1.0]).columns == ("q0", "q1", "p0", "p1")


def test_the_rest_of_the_derivatives_is_periodic() -> None:
    """In genus 1 the state returns after two turns, and so do the derivatives without their secular part."""
    system, state = REAL["garnier"](RR, 1)
    flow = system.flow(state)
    found = flow.sensitivity([1.0, 1.0 + 600 * flow.portrait.periods[0]])
    assert abs(found.matrix[1]).max() > 300
    assert abs(found.periodic[1] - found.periodic[0]).max() < 1e-14 * abs(found.matrix[1]).max()
    assert np.linalg.matrix_rank(found.secular[1], tol=1e-9) == 1


@pytest.mark.parametrize("name", [pytest.param("neumann", marks=pytest.mark.slow), "henon_heiles"])
def test_the_secular_part_is_what_grows(name) -> None:
    system, state = REAL[name](RR, 2 if name == "neumann" else 1)
    found = system.flow(state).sensitivity([1e5 + 7])
    assert abs(found.matrix).max() > 1e4
    assert abs(found.periodic).max() < 10
    assert np.linalg.matrix_rank(found.secular[0] / 1e5, tol=1e-9) == 2


def test_what_is_refused_by_name() -> None:
    system, state = REAL["toda"](RR, 2)
    flow = system.flow(state)
    with pytest.raises(NotRepresentable, match="do not determine a state"):
        _ = flow.sensitivity([1.0]).secular
    with pytest.raises((ArgumentError, FieldError), match="times"):
        flow.sensitivity("soon")
    assert flow.sensitivity([]).matrix.shape == (0, 4, 4)
