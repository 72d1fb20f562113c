"""Published integrators and discretizations for comparison with the divisor flow, behind one interface:
:data:`METHODS`.

    METHODS["Gauss-Legendre 6"].solve(system, state, times, 0.1)     # Solution(gamma, M, evaluations)

Each is a :class:`integrable.oracles.method.Method`. A system is a body with ``inertia`` and ``d`` (ball, top), or an
object whose method ``rates_in`` computes ẏ in any number type (the deformations, the systems of
:mod:`integrable.classical`). The arithmetic of :mod:`jacobian` is not used.
"""

from __future__ import annotations

from integrable.oracles.compiled_methods import CompiledTaylor, Gauss16
from integrable.oracles.exact_methods import EllipticForm, ManyDigits
from integrable.oracles.heyoka_taylor import Heyoka
from integrable.oracles.method import Method, time_scale
from integrable.oracles.scipy_methods import SciPy
from integrable.oracles.step_methods import Collocation, DiscreteTop

__all__ = ["METHODS", "Method", "time_scale"]

TOLERANCES = (1e-4, 1e-6, 1e-8, 1e-10, 1e-12, 3e-14)
STEPS = (0.5, 0.25, 0.12, 0.06, 0.03, 0.015)
"""Steps in units of the time scale of :meth:`Method.ladder`."""
BODIES = ("ball", "top")

METHODS: dict[str, Method] = {method.name: method for method in (
    SciPy("SciPy DOP853", "Hairer, Nørsett & Wanner (1993)", "tolerance", TOLERANCES, module="scipy", extra="app"),
    SciPy(
        "SciPy DOP853, compiled", "the same, its right-hand side compiled by numba", "tolerance", TOLERANCES,
        module="scipy", extra="app", compiled=True,
    ),
    SciPy(
        "SciPy LSODA", "Hindmarsh & Petzold (1983)", "tolerance", TOLERANCES[:-1], module="scipy", extra="app",
        solver="LSODA",
    ),
    SciPy(
        "SciPy Radau", "Hairer & Wanner (1996)", "tolerance", TOLERANCES[:-2], module="scipy", extra="app",
        solver="Radau",
    ),
    Collocation("implicit midpoint", "Gauss collocation, one stage", "step", STEPS, order=2),
    Collocation(
        "Gauss-Legendre 6", "Kuntzmann (1961), Butcher (1964), three stages", "step", STEPS, order=6, stages=3,
    ),
    DiscreteTop("Moser-Veselov", "Moser & Veselov (1991)", "step", STEPS, order=2),
    DiscreteTop("Moser-Veselov, order 4", "Hairer & Vilmart (2006)", "step", STEPS, order=4),
    DiscreteTop("Hirota-Kimura", "Hirota & Kimura (2000), γ by Kahan's rule (1993)", "step", STEPS, order=2),
    Gauss16(
        "Gauss-Legendre 16", "Hairer, McLachlan & Razakarivony (2008)", "step", (2.0, 1.4, 1.0, 0.7, 0.5),
        compiled=True, order=16,
    ),
    Gauss16(
        "Gauss-Legendre 16, adaptive", "the same with a chosen step", "tolerance", (1e-6, 1e-9, 1e-12, 1e-15, 1e-18),
        compiled=True,
    ),
    CompiledTaylor(
        "Taylor, compiled", "Jorba & Zou (2005), compensated sums", "tolerance", (1e-6, 1e-9, 1e-12, 1e-15, 1e-17),
        compiled=True,
    ),
    Heyoka(
        "heyoka", "Biscani & Izzo (2021)", "tolerance", (1e-6, 1e-9, 1e-12, 1e-15, 1e-18), module="heyoka",
        extra="peers", compiled=True,
    ),
    Heyoka(
        "heyoka, long double", "Biscani & Izzo (2021)", "tolerance", (1e-15, 1e-17, 1e-19, 1e-21), module="heyoka",
        extra="peers", compiled=True, guard=10,
    ),
    EllipticForm(
        "closed elliptic form", "Jacobi (1850); floats by SciPy, above 15 digits mpmath", "digits", (15, 30, 50),
        ("top",), module="scipy", extra="app",
    ),
    ManyDigits("Taylor, multiprecision", "Jorba & Zou (2005), on mpmath", "digits", (15, 20, 30, 40), BODIES),
    ManyDigits("mpmath odefun", "mpmath.odefun: Taylor series from differences", "digits", (15, 20), BODIES),
)}  # fmt: skip
"""The methods by name."""
