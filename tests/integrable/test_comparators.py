"""The comparators: what each keeps, and its order as the slope of error against step, without the round-off plateau."""

from __future__ import annotations

from fractions import Fraction
from itertools import pairwise
from types import SimpleNamespace

import mpmath
import numpy as np
import pytest

from integrable.comparators import (
    gauss_legendre6,
    hirota_kimura,
    hirota_kimura_factors,
    hirota_kimura_integrals,
    hirota_kimura_step,
    implicit_midpoint,
    modified_moments,
    moser_veselov,
)
from integrable.jets import JetField
from integrable.reference import taylor
from jacobian import QQ, PrecisionLoss
from jacobian.errors import ArgumentError

BALL = SimpleNamespace(inertia=(1, 2, 3), d=0.7)
TOP = SimpleNamespace(inertia=(1, 2, 3), d=0)
START = SimpleNamespace(gamma=(0.48, 0.6, 0.64), M=(0.384, 1.28, -1.488))
TILTED = SimpleNamespace(gamma=(0.48, 0.6, 0.64), M=(1.104, 2.18, -0.528))


def order(errors: list[tuple[float, float]]) -> float:
    """The slope of log error against log step, fitted to the steps before the errors level off at round-off.

    The plateau is the smallest error, where the errors stop falling; points within a factor 100 of it are left out.
    """
    smallest = min(e for _, e in errors)
    levels = any(after > before / 1.3 for (_, before), (_, after) in pairwise(errors))
    kept = [(s, e) for s, e in errors[1:] if not levels or e > 100 * smallest]
    assert len(kept) >= 3, f"no slope above round-off: {errors}"
    log_step, log_error = np.log([s for s, _ in kept]), np.log([e for _, e in kept])
    return float(np.polyfit(log_step, log_error, 1)[0])


def test_the_plateau_filter() -> None:
    steps = [2.0**-k for k in range(12)]
    assert order([(h, 0.1 * h**4 + 1e-9) for h in steps]) == pytest.approx(4, abs=0.1)
    with pytest.raises(AssertionError, match="no slope"):
        order([(h, 1e-15) for h in steps])


METHODS = {
    "implicit midpoint": (implicit_midpoint, {}, BALL, START, 2),
    "implicit midpoint, tilted": (implicit_midpoint, {}, BALL, TILTED, 2),
    "implicit midpoint, top": (implicit_midpoint, {}, TOP, START, 2),
    "Gauss-Legendre 6": (gauss_legendre6, {}, BALL, START, 6),
    "Gauss-Legendre 6, top": (gauss_legendre6, {}, TOP, TILTED, 6),
    "Moser-Veselov": (moser_veselov, {}, TOP, START, 2),
    "Moser-Veselov, tilted": (moser_veselov, {}, TOP, TILTED, 2),
    "Moser-Veselov, modified moments": (moser_veselov, {"order": 4}, TOP, TILTED, 4),
}


@pytest.mark.parametrize("name", METHODS)
def test_order_of_convergence(name) -> None:
    method, options, body, start, expected = METHODS[name]
    truth = taylor(body, start, [2], digits=18)
    wanted = np.concatenate([truth.gamma[0], truth.M[0]]).astype(float)
    errors = []
    for count in (8, 12, 16, 24, 32, 48, 64, 96, 128):
        run = method(body, start, step=2 / count, count=count, **options)
        errors.append((2 / count, np.abs(np.concatenate([run.gamma[-1], run.M[-1]]) - wanted).max()))
    assert order(errors) == pytest.approx(expected, abs=0.25)


def test_order_of_hirota_kimura() -> None:
    truth = taylor(TOP, START, [2], digits=18).M[0].astype(float)
    errors = []
    for count in (8, 16, 32, 64, 128, 256):
        found = hirota_kimura(TOP.inertia, START.M, step=2 / count, count=count)[-1]
        errors.append((2 / count, np.abs(np.array(found) - truth).max()))
    assert order(errors) == pytest.approx(2, abs=0.2)


def integrals(body, run):
    """C1, C2, H1, H2 along a run."""
    a = np.array([1 / (x + body.d) for x in body.inertia])
    x, m = run.gamma, run.M
    dot = lambda p, q: np.sum(p * q, axis=1)  # noqa: E731
    g2 = 1 / (1 - body.d * dot(a * x, x))
    h1 = dot(a * m, m) + body.d * g2 * dot(a * x, m) ** 2
    return {"C1": dot(x, x), "C2": dot(x, m), "H1": h1, "H2": dot(m, m)}


KEPT = {
    "implicit midpoint": {"C1", "C2", "H2"},
    "implicit midpoint, tilted": {"C1", "C2", "H2"},
    "implicit midpoint, top": {"C1", "C2", "H1", "H2"},
    "Gauss-Legendre 6": {"C1", "C2", "H2"},
    "Gauss-Legendre 6, top": {"C1", "C2", "H1", "H2"},
    "Moser-Veselov": {"C1", "C2", "H1", "H2"},
    "Moser-Veselov, tilted": {"C1", "C2", "H1", "H2"},
    "Moser-Veselov, modified moments": {"C1", "C2", "H1", "H2"},
}


@pytest.mark.parametrize("name", METHODS)
def test_what_is_kept_and_what_is_not(name) -> None:
    method, options, body, start, _ = METHODS[name]
    run = method(body, start, step=0.2, count=300, **options)
    for key, values in integrals(body, run).items():
        drift = np.abs(values - values[0]).max()
        if key in KEPT[name]:
            assert drift < 1e-12, key
        else:
            assert drift > 3e-11, key


@pytest.mark.parametrize("method", [implicit_midpoint, moser_veselov])
def test_in_multiprecision_the_integrals_are_kept_to_its_digits(method) -> None:
    context = mpmath.MPContext()
    context.dps = 40
    run = method(TOP, START, step="0.1", count=20, number=context.mpf)
    for key, values in integrals(SimpleNamespace(inertia=[context.mpf(x) for x in (1, 2, 3)], d=0), run).items():
        assert max(abs(v - values[0]) for v in values) < 1e-36, key


def test_the_modified_moments_are_the_moments_at_step_zero() -> None:
    assert modified_moments((1.0, 2.0, 3.0), START.M, 0.0) == pytest.approx([1, 2, 3])


# --- Hirota–Kimura, exactly

MOMENTS, STEP = (Fraction(2), Fraction(3), Fraction(7)), Fraction(1, 5)


def rational_start(seed):
    rng = np.random.default_rng(seed)
    return [Fraction(int(x), 11) for x in rng.integers(-20, 20, 3)]


@pytest.mark.parametrize("seed", range(5))
def test_hirota_kimura_solves_its_equations_and_keeps_its_integrals_exactly(seed) -> None:
    M = rational_start(seed)
    a = [1 / x for x in MOMENTS]
    new = hirota_kimura_step(MOMENTS, M, STEP)
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        assert new[i] - STEP / 2 * (a[k] - a[j]) * (M[k] * new[j] + M[j] * new[k]) == M[i]
    assert hirota_kimura_integrals(MOMENTS, new, STEP) == hirota_kimura_integrals(MOMENTS, M, STEP)
    # birational: the inverse is the map of −step
    assert hirota_kimura_step(MOMENTS, new, -STEP) == M


@pytest.mark.parametrize("seed", range(3))
def test_hirota_kimura_has_an_invariant_measure_exactly(seed) -> None:
    M = rational_start(seed)
    K = JetField(QQ, 3)
    image = hirota_kimura_step([K.constant(x) for x in MOMENTS], K.variables(M), K.constant(STEP))
    rows = [x.slopes for x in image]
    determinant = sum(
        rows[0][i] * (rows[1][i - 2] * rows[2][i - 1] - rows[1][i - 1] * rows[2][i - 2]) for i in range(3)
    )
    after = hirota_kimura_factors(MOMENTS, [x.value for x in image], STEP)
    before = hirota_kimura_factors(MOMENTS, M, STEP)
    assert determinant == (after[2] / before[2]) ** 2


def test_hirota_kimura_does_not_keep_the_length_of_M() -> None:
    rows = np.array(hirota_kimura((1, 2, 3), START.M, step=0.1, count=2000))
    size = np.sum(rows**2, axis=1)
    assert np.abs(size - size[0]).max() == pytest.approx(1.4e-3, rel=0.1)
    found = np.array([hirota_kimura_integrals((1, 2, 3), row, 0.1) for row in rows])
    assert np.abs(found - found[0]).max() < 1e-12


# --- refusals


def test_refusals() -> None:
    with pytest.raises(ArgumentError, match=r"d = 0\.7.*order 2 or 4"):
        moser_veselov(BALL, START, step=0.1, count=1)
    with pytest.raises(ArgumentError, match="order = 3"):
        moser_veselov(TOP, START, step=0.1, count=1, order=3)
    with pytest.raises(PrecisionLoss, match="smaller step"):
        moser_veselov(TOP, START, step=50, count=1)
    with pytest.raises(PrecisionLoss, match="smaller step"):
        implicit_midpoint(BALL, START, step=50, count=1)
