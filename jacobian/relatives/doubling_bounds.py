"""Bounds of the doubling on a Kummer surface: how much the height of 2D can differ from four times that of D.

The bound over the reals follows Stoll (1999, section 7). Let δ be the quartic forms of the doubling. For each of the
ten factorizations f = G·H into cubics (∞ is a root if deg f = 5) there are a linear form ℓ and a quadratic form y with
ℓ(δ(x)) = y(x)² on the surface. So |y(x)| is at most a constant times √|δ(x)|. The ten y span the quadratic forms, among
them the x_i², which are thereby bounded too. Everything is computed in balls.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import lru_cache, reduce
from itertools import combinations, combinations_with_replacement
from typing import Any

from jacobian.errors import PrecisionLoss
from jacobian.periods.ball_cover import ball_roots
from jacobian.periods.balls import BallNumbers, ball_numbers
from jacobian.periods.quadrature import Vector
from jacobian.relatives.kummer import KummerSurface

FIRST_BITS, TRIALS = 200, 5

# {exponents: coefficient}
Form = dict[tuple[int, ...], Any]

# the exponents of the quadratic monomials
QUADRATIC = [tuple(chosen.count(i) for i in range(4)) for chosen in combinations_with_replacement(range(4), 2)]


def bad_part(surface: KummerSurface) -> int:
    """16|disc(f)|, f as a sextic: a multiple of the gcd of all doubling forms δ_i at coprime x_j (Stoll 1999, 6.1)."""
    from flint import fmpz_poly

    discriminant = int(fmpz_poly(list(surface.f)).discriminant())
    return abs(16 * discriminant * (1 if surface.f[6] else surface.f[5] ** 2))


@lru_cache(maxsize=32)
def real_bounds(surface: KummerSurface) -> tuple[float, float]:
    """(low, high) with low ≤ log |δ(x)| − 4 log |x| ≤ high at real points of the surface, |x| being the largest |x_i|.

    δ are the doubling forms. PrecisionLoss where the enclosures of the roots of f are too wide for finite bounds.
    """
    bits = FIRST_BITS
    for _ in range(TRIALS):
        numbers = ball_numbers(bits)
        with numbers.working():
            high = numbers.flint.arb(max(sum(map(abs, form.values())) for form in surface.delta)).log()
            try:
                low = -2 * _largest_square(surface, numbers).log()
            except (ZeroDivisionError, PrecisionLoss):
                low = numbers.flint.arb.neg_inf()
            if low.is_finite():
                return float(low.lower()) - 1e-9, float(high.upper()) + 1e-9
        bits *= 2
    raise PrecisionLoss(f"{surface.curve!r}: the doubling on the Kummer surface has no bound with {bits // 2} bits")


def _largest_square(surface: KummerSurface, numbers: BallNumbers) -> Any:
    """A constant A with max x_i² ≤ A·√(max |δ_j(x)|) at all real points x of the surface, δ_j the doubling forms."""
    acb_mat = numbers.flint.acb_mat
    forms = list(tropes(surface, numbers))
    # each row of ``matrix`` expresses a monomial x_i·x_j as a linear combination of the ten quadratic forms
    matrix = acb_mat([[y.get(m, 0) for m in QUADRATIC] for _, y in forms]).inv()
    sizes = [sum(abs(c) for c in linear).sqrt() for linear, _ in forms]
    squares = (row for row, m in enumerate(QUADRATIC) if max(m) == 2)
    return largest([sum(abs(matrix[row, k]) * size for k, size in enumerate(sizes)) for row in squares])


def largest(values: Sequence[Any]) -> Any:
    """max |x_i| of real balls."""
    return reduce(lambda a, b: a.max(b), map(abs, values))


def tropes(surface: KummerSurface, numbers: BallNumbers) -> Iterator[tuple[Vector, Form]]:
    """Yields the ten pairs (ℓ, y) with ℓ(δ(x)) = y(x)² on the surface: the coefficients of ℓ, ℓ₄ = 1, and the form y.

    The planes ℓ = 0, the *tropes* that do not pass through κ(0), touch the surface along conics.
    """
    from flint import fmpq_poly

    roots: Vector = ball_roots(numbers, fmpq_poly(list(surface.f)), fmpq_poly([]))
    lead = surface.f[len(roots)]
    roots += [None] * (6 - len(roots))
    for others in combinations(range(1, 6), 2):
        chosen = (0, *others)
        g = _cubic(numbers, lead, [roots[i] for i in chosen])
        h = _cubic(numbers, 1, [roots[i] for i in range(6) if i not in chosen])
        linear = [g[i] * h[j] + g[j] * h[i] for i, j in ((0, 2), (0, 3), (1, 3))]
        linear.append(numbers.convert(1))
        yield linear, _root_on_surface(surface, linear, numbers)


def _cubic(numbers: BallNumbers, lead: int, roots: Vector) -> Vector:
    """The four coefficients, ascending, of lead·Π(x − e) over the finite roots e; None stands for the root ∞."""
    found = [numbers.convert(lead)]
    for e in roots:
        if e is not None:
            found = [b - e * a for a, b in zip([*found, 0], [0, *found], strict=True)]
    return found + [numbers.convert(0)] * (4 - len(found))


def _root_on_surface(surface: KummerSurface, linear: Vector, numbers: BallNumbers) -> Form:
    """The quadratic form y with y² = Σ ℓ_j δ_j + c·(Rξ₄² + Sξ₄ + T); Rξ₄² + Sξ₄ + T = 0 is the surface's equation.

    The δ_j are the doubling forms. The parts of both sides with ξ₄³, ξ₄² and ξ₄ determine y and the constant c.
    """
    total: Form = {}
    for factor, form in zip(linear, surface.delta, strict=True):
        total = _plus(total, form, factor)
    first = _part(total, 3, 0.5)
    R: Form = {(0, 2, 0): 1, (1, 0, 1): -4}
    f = surface.f
    powers = ((3, 0, 0), (2, 1, 0), (2, 0, 1), (1, 1, 1), (1, 0, 2), (0, 1, 2), (0, 0, 3))
    S: Form = {m: -k * c for m, k, c in zip(powers, (4, 2, 4, 2, 4, 2, 4), f, strict=True)}
    rest = _plus(_part(total, 2), _product(first, first), -1)
    # 2y = 2ξ₄² + 2ξ₄·first + rest + cR, and c·(first·R − S) = (the coefficient of ξ₄ in Σ ℓ_j δ_j) − first·rest
    left, right = _plus(_product(first, R), S, -1), _plus(_part(total, 1), _product(first, rest), -1)
    best = max(left, key=lambda m: float(abs(numbers.convert(left[m])).lower()))
    c = right[best] / left[best]
    if not all((right.get(m, 0) - c * left.get(m, 0) + numbers.convert(0)).contains(0) for m in {*left, *right}):
        raise PrecisionLoss("a trope of the Kummer surface is not a square on it")
    last = _plus(rest, R, c)
    found: Form = {(*m, 0): x / 2 for m, x in last.items()}
    found |= {(*m, 1): x for m, x in first.items()}
    found[0, 0, 0, 2] = numbers.convert(1)
    return found


def _part(form: Form, power: int, factor: float = 1) -> Form:
    """``factor`` times the coefficient of ξ₄^power, a form in ξ₁, ξ₂, ξ₃."""
    return {m[:3]: c * factor for m, c in form.items() if m[3] == power}


def _plus(a: Form, b: Form, factor: Any = 1) -> Form:
    found = dict(a)
    for m, c in b.items():
        found[m] = found.get(m, 0) + factor * c
    return found


def _product(a: Form, b: Form) -> Form:
    found: Form = {}
    for m, c in a.items():
        for n, d in b.items():
            k = tuple(i + j for i, j in zip(m, n, strict=True))
            found[k] = found.get(k, 0) + c * d
    return found
