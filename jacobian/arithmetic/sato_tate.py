"""Sato–Tate groups: their moments of (a_1/√p, a_2/p), and the groups with which the L-polynomials of a curve are
compatible.

In genus 2 there are 52 groups (Fité, Kedlaya, Rotger and Sutherland 2012). An element has the characteristic polynomial
(1 − 2cos α·T + T²)(1 − 2cos β·T + T²), as L_p(T/√p) has, so that a_1 = −2cos α − 2cos β, a_2 = 2 + 4·cos α·cos β. Each
component of a group is given by the probability law of its angles α, β or, where a_1 = 0, of a_2. All moments are
computed from these laws.

A group with identity component U(1) is given by a group H of rotations and an element J (notation of the 2012 paper).
It has a component for each A in H; or for each A and each J·A; or, for a subgroup H′ of index 2, for each A in H′ and
each J·A with A outside H′. For u in U(1) and A in H, which as an element of SU(2) has the eigenvalues e^(±iθ), u·A has
α, β = φ ± θ with φ uniform, and J·u·A has a_1 = 0, a_2 = −2cos 2θ. Moments are integrals of trigonometric polynomials,
computed exactly by sums over enough points.

Over QQ the endomorphisms of a factor with complex multiplication are never all rational, which leaves the groups of
:func:`over_the_rationals`.
"""

from __future__ import annotations

from functools import cache
from math import ceil, log, pi
from typing import Any, NamedTuple

import numpy as np

from jacobian.arithmetic.record import LPolynomials
from jacobian.errors import ArgumentError, Infeasible, shown

POINTS = 64
"""The number of equidistant angles: sums over them are exact for trigonometric polynomials of degree below it."""
EXPONENTS = {1: ((2, 0), (4, 0), (6, 0)), 2: ((2, 0), (4, 0), (0, 1), (0, 2), (0, 3), (0, 4), (2, 1), (2, 2))}
"""The (i, j) for which the means of a_1^i·a_2^j are compared, by genus."""
ATOMS = (-2, -1, 0, 1, 2)
"""The values of a_2/p that some groups take with positive probability where a_1 = 0; their frequencies are compared."""
FROM = 200
"""Primes up to this one are left out, because their a_i take few values."""
SLACK = 0.005
"""The allowed systematic error of a mean, relative to the standard deviation of one value. The random error of the mean
of 10^4 values is twice as large.
"""
RARE = 0.3
"""√p times the probability that the integer a_1 is 0 although the group has no component with a_1 = 0: about the
density of a_1/√p at 0.
"""
UNLIKELY = 1e-4
"""A group is compatible if its ``probability`` (:class:`Verdict`) is at least this."""
APART = 25.0
"""The χ² at which two groups count as separated."""


class Part(NamedTuple):
    """A component of a group: values of (a_1, a_2) with their probabilities."""

    a1: Any
    a2: Any
    weights: Any


class Verdict(NamedTuple):
    """A group, and the ``probability`` that χ² is at least as large as for the curve, if this is the curve's group. χ²
    measures how far means over the primes, such as that of a_1², are from their expected values.

    ``primes``: how many primes would separate the group from the most probable one; 0 for the most probable group.
    """

    group: str
    probability: float
    primes: int


# --- laws of angles


def _circle() -> tuple[Any, Any]:
    return 2 * pi * (np.arange(POINTS) + 0.5) / POINTS, np.full(POINTS, 1 / POINTS)


def _haar() -> tuple[Any, Any]:
    """The law of the angle of SU(2), whose density is proportional to sin²."""
    angles, weights = _circle()
    return angles, weights * 2 * np.sin(angles) ** 2


def _at(angle: float) -> tuple[Any, Any]:
    return np.array([angle]), np.ones(1)


def _of_angles(first: Any, second: Any, generic: bool = False) -> Part:
    """The component with independent angles α and β.

    ``generic``: the component USp(4), whose density has the additional factor (2cos α − 2cos β)²/2 (Weyl).
    """
    (alpha, p), (beta, q) = first, second
    a, b = 2 * np.cos(alpha)[:, None], 2 * np.cos(beta)[None]
    weights = p[:, None] * q[None] * ((a - b) ** 2 / 2 if generic else 1.0)
    return Part(-(a + b).ravel(), (2 + a * b).ravel(), weights.ravel())


def _about(theta: Any, phi: Any) -> Part:
    """The component with α, β = φ ± θ for independent angles θ and φ."""
    (t, p), (f, q) = theta, phi
    c = 4 * np.cos(t)[:, None] * np.cos(f)[None]
    d = 2 + 2 * (np.cos(2 * t)[:, None] + np.cos(2 * f)[None])
    return Part(-c.ravel(), d.ravel(), (p[:, None] * q[None]).ravel())


def _even(angle: Any) -> Part:
    """The component with a_1 = 0 and a_2 = −2cos(angle)."""
    values, weights = angle
    return Part(np.zeros(len(values)), -2 * np.cos(values), weights)


# --- the groups of genus 2


ROTATIONS = {"T": {1: 1, 2: 3, 3: 8}, "O": {1: 1, 2: 9, 3: 8, 4: 6}}
"""The number of rotations of each order in the groups T and O."""


def _rotations(name: str) -> list[float]:
    """The angles θ of a group of rotations C_n, D_n, T or O: half of each rotation's angle."""
    if name in ROTATIONS:
        return [pi / order if order > 1 else 0.0 for order, count in ROTATIONS[name].items() for _ in range(count)]
    n = int(name[1:])
    turns = [pi * k / n for k in range(n)]
    return turns if name[0] == "C" else turns + [pi / 2] * n


def _unitary() -> dict[str, list[Part]]:
    """The 32 groups with identity component U(1)."""
    found = {}

    def parts(plain: list[float], turned: list[float]) -> list[Part]:
        return [_about(_at(theta), _circle()) for theta in plain] + [_even(_at(2 * theta)) for theta in turned]

    for name in ("C1", "C2", "C3", "C4", "C6", "D2", "D3", "D4", "D6", "T", "O"):
        H = _rotations(name)
        found[name], found[f"J({name})"] = parts(H, []), parts(H, H)
    for n in (2, 4, 6):
        half, odd = n // 2, [pi * k / n for k in range(1, n, 2)]
        found[f"C{n},1"] = parts(_rotations(f"C{half}"), odd)
        # without J: D_(n/2), half of the rotations about the main axis and half turns about half of the other axes
        found[f"D{n},1"] = parts(_rotations(f"C{half}") + [pi / 2] * half, odd + [pi / 2] * half)
    for n in (3, 4, 6):
        found[f"D{n},2"] = parts(_rotations(f"C{n}"), [pi / 2] * n)
    # without J: the twelve rotations of the tetrahedron; with J: the octahedron's other rotations, by π or π/2
    found["O,1"] = parts(_rotations("T"), [pi / 2] * 6 + [pi / 4] * 6)
    return found


def _others() -> dict[str, list[Part]]:
    """The 20 groups whose identity component is not U(1)."""
    circle, haar, quarter = _circle(), _haar(), _at(pi / 2)
    found = {}
    for n in (1, 2, 3, 4, 6):
        plain = [_about(haar, _at(pi * k / n)) for k in range(n)]
        found[f"E{n}"] = plain
        found[f"J(E{n})"] = plain + [_even((2 * haar[0], haar[1]))] * n
    # F is U(1)²; in the components of a and b one angle is π/2, in that of ab both are; c exchanges the angles
    F, a, ab, ac = _of_angles(circle, circle), _of_angles(quarter, circle), _of_angles(quarter, quarter), _even(quarter)
    found |= {"F": [F], "Fa": [F, a], "Fab": [F, ab], "Fa,b": [F, a, a, ab], "Fac": [F, ac, ab, ac]}
    mixed, both = _of_angles(circle, haar), _of_angles(haar, haar)
    found |= {"G1,3": [mixed], "N(G1,3)": [mixed, _of_angles(quarter, haar)]}
    return found | {"G3,3": [both], "N(G3,3)": [both, _even(haar)], "USp(4)": [_of_angles(haar, haar, generic=True)]}


@cache
def groups(genus: int) -> dict[str, list[Part]]:
    """All groups of genus 1 (three) and 2 (52) by name, with their components; a_2 = 1 in genus 1."""
    if genus == 2:
        return _unitary() | _others()
    circle, haar = (Part(-2 * np.cos(angle), np.ones(POINTS), weights) for angle, weights in (_circle(), _haar()))
    return {"U(1)": [circle], "SU(2)": [haar], "N(U(1))": [circle, Part(np.zeros(1), np.ones(1), np.ones(1))]}


def over_the_rationals(genus: int) -> list[str]:
    """The names of the groups that are possible over QQ, where complex conjugation acts on complex multiplication.

    So groups with identity component U(1) contain J, and groups with U(1)² contain an element that inverts both
    factors. Groups with U(1)² have four components: two factors with one field of complex multiplication would be
    isogenous, and a CM field of degree 4 is contained in the field of definition of the endomorphisms. Groups with
    U(1) × SU(2) have two components. Not every group in the list is that of a curve over QQ.
    """
    never = {"U(1)", "F", "Fa", "Fab", "G1,3", "T", "O", "C1", "C2", "C3", "C4", "C6", "D2", "D3", "D4", "D6"}
    return [name for name in groups(genus) if name not in never]


def with_endomorphisms(genus: int, geometric: int, commutative: bool, rational: int) -> list[str]:
    """The names of the groups over QQ of Jacobians whose endomorphisms have the ranks ``geometric`` over ℂ and
    ``rational`` over QQ; ``commutative``: whether the endomorphism ring over ℂ is commutative.

    The ring over ℂ determines the identity component (Fité, Kedlaya, Rotger and Sutherland 2012). The rank over QQ is
    the mean of a_1² (Costa, Fité and Sutherland 2019).
    """
    if genus == 1:
        return ["SU(2)"] if geometric == 1 else ["N(U(1))"]
    known = {1: ("USp(4)",), 2: ("G3,3", "N(G3,3)"), 3: ("G1,3", "N(G1,3)")}
    others = {*(name for names in known.values() for name in names)}

    def fits(name: str) -> bool:
        if geometric in known:
            return name in known[geometric]
        kind = "F" if name.startswith("F") else "E" if "E" in name else "U(1)"
        return name not in others and kind == ("U(1)" if geometric == 8 else "F" if commutative else "E")

    return [name for name in over_the_rationals(2) if fits(name) and round(moment(groups(2)[name], 2)) == rational]


def moment(parts: list[Part], i: int, j: int = 0) -> float:
    """The mean of a_1^i·a_2^j over the components of a group."""
    return float(np.mean([np.sum(part.weights * part.a1**i * part.a2**j) for part in parts]))


def moments_of_groups(most: int = 8) -> dict[str, list[int]]:
    """The means of a_1², a_1⁴, …, a_1^most and a_2, …, a_2^(most/2) for each group of genus 2. They are integers."""
    powers = [(i, 0) for i in range(2, most + 1, 2)] + [(0, j) for j in range(1, most // 2 + 1)]
    return {name: [round(moment(parts, *e)) for e in powers] for name, parts in groups(2).items()}


# --- comparison with a curve


def _compared(genus: int, a1: Any, a2: Any, even: Any, atom: Any) -> Any:
    """The quantities whose means are compared, (N, …), at N values of (a_1, a_2): the products in EXPONENTS, ``even``,
    and for each number in ATOMS whether a_2 has this value and ``atom`` is true.

    For a group, ``even``, (N,), says whether a_1 = 0 on the whole component, and ``atom``, (N,), whether the component
    has a single value of (a_1, a_2). For a curve, both say whether a_1 = 0.
    """
    columns = [a1**i * a2**j for i, j in EXPONENTS[genus]]
    return np.stack([*columns, even, *(atom & (np.abs(a2 - c) < 1e-9) for c in ATOMS)], axis=1).astype(float)


@cache
def _expected(genus: int, name: str) -> tuple[Any, Any]:
    """The means and the covariances of the quantities of :func:`_compared` in a group."""
    parts = groups(genus)[name]
    rows = []
    for x in parts:
        one = np.ones(len(x.a1), bool)
        rows.append(_compared(genus, x.a1, x.a2, one & (np.abs(x.a1).max() < 1e-9), one & (len(x.a1) == 1)))
    weights = np.concatenate([x.weights for x in parts]) / len(parts)
    values = np.concatenate(rows)
    means = weights @ values
    return means, (values * weights[:, None]).T @ values - np.outer(means, means)


def sato_tate_groups(L: LPolynomials) -> list[Verdict]:
    """The groups over QQ that L is compatible with, the most probable first; genus 1 and 2.

    This is evidence, not proof. It treats the L-polynomials at different primes as independent, and compares the
    moments in EXPONENTS, how often a_1 = 0, and how often a_2/p then has each value in ATOMS. Infeasible in genus 3;
    ArgumentError for fewer than 100 primes beyond FROM.
    """
    genus = L.curve.genus
    if genus not in EXPONENTS:
        raise Infeasible(f"genus {genus}: Sato–Tate groups are identified in genus 1 and 2")
    chosen = L.p > FROM
    count = int(np.sum(chosen))
    if count < 100:
        raise ArgumentError(f"bound = {shown(L.bound)}: {count} primes beyond {FROM} are too few, 100 are needed")
    values = L.normalised()[chosen]
    a2 = values[:, 1] if genus == 2 else np.ones(count)
    even = L.coefficients[chosen, 0] == 0
    sample = _compared(genus, values[:, 0], a2, even, even)
    found = np.mean(sample, axis=0)
    chances = {}
    for name in over_the_rationals(genus):
        means, covariance = _expected(genus, name)
        square = _square(found - means, covariance, count, float(np.mean(L.p[chosen] ** -0.5)))
        chances[name] = _tail(square, len(found))
    order = sorted((name for name, chance in chances.items() if chance > UNLIKELY), key=lambda name: -chances[name])
    return [Verdict(name, chances[name], _telling(genus, order[0], name)) for name in order]


def _square(off: Any, covariance: Any, count: int, root: float) -> float:
    """χ² of means at ``count`` primes. ``off``: their deviations from the expected ones; ``root``: the mean of 1/√p."""
    slack = SLACK * np.sqrt(np.diag(covariance)) + 1e-6
    # the integer a_1 may be 0 by chance, with a probability of the order of 1/√p
    slack[-len(ATOMS) - 1 :] += RARE * root
    return float(off @ np.linalg.solve(covariance / count + np.diag(slack**2), off))


def _telling(genus: int, first: str, other: str) -> int:
    """About how many primes separate the group ``other`` from ``first`` by χ² = APART; 0 if even 10⁸ primes do not."""
    (a, _), (b, covariance) = _expected(genus, first), _expected(genus, other)
    count = 100
    while first != other and count < 10**8:
        if _square(a - b, covariance, count, 2 / bound_with(count) ** 0.5) > APART:
            return count
        count += count // 4
    return 0


def _tail(x: float, degrees: int) -> float:
    """The probability that χ² with this number of degrees of freedom exceeds x."""
    from mpmath import mp

    return float(mp.gammainc(degrees / 2, x / 2, mp.inf, regularized=True))


def bound_with(count: int) -> int:
    """An estimate n(log n + log log n) of the least bound with n = ``count`` primes below it."""
    n = max(count, 6)
    return ceil(n * (log(n) + log(log(n))))
