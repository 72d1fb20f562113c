"""Algebras of endomorphisms by name, and the constraints that L-polynomials put on them.

End⁰ = End ⊗ QQ. Let E ⊂ End⁰(J), over QQ, be a field of degree 2, or QQ × QQ in genus 2. The Tate module, tensored with
QQ, is free over E ⊗ QQ_ℓ, so L_p is a norm from E[T]. Moreover End⁰(J) embeds into End⁰ of each reduction modulo a good
prime, whose dimension the roots of L_p determine (Tate 1966).

Let π be an eigenvalue of Frobenius at an ordinary prime. A curve of genus 2 has End(J) = ℤ over the algebraic closure
if at two such primes QQ(π) has degree 4, is the same for all powers of π and has one quadratic subfield, and the two
subfields differ. Indeed End⁰(J) lies in both fields QQ(π), and if it were larger than QQ it would contain both
subfields (the idea of Lombardo 2019; Costa, Mascot, Sijsling & Voight 2019). In genus 1 two different fields QQ(π)
suffice.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import count, product
from math import isqrt, prod
from typing import Any, NamedTuple

from jacobian.arithmetic.record import LPolynomials
from jacobian.curve.zeta import power_sums
from jacobian.errors import PrecisionLoss, shown
from jacobian.finite.integers import factorization
from jacobian.finite.weil import leading
from jacobian.periods.endomorphisms import Endomorphisms, Integers

ROOTS_OF_UNITY = 240
"""A multiple of the order of every root of unity in the splitting field, of degree at most 8, of a Frobenius polynomial
of degree 4.
"""
PRIMES = 100
"""The number of L-polynomials that are compared; each is an exact test."""


class Algebra(NamedTuple):
    """End ⊗ QQ: its ``name``, such as QQ(√5) or M_2(QQ), its ``dimension`` over QQ, whether it is ``commutative``."""

    name: str
    dimension: int
    commutative: bool


class Seen(NamedTuple):
    """The algebras of the endomorphisms found from periods.

    ``geometric``, ``rational``: the algebras over ℂ and over QQ; ``primes``: how many L-polynomials agree with them;
    ``proven``: whether End = ℤ is proven.
    """

    geometric: Algebra
    rational: Algebra
    primes: int
    proven: bool


def seen(found: Endomorphisms, L: LPolynomials | None = None) -> Seen:
    """The algebras of the endomorphisms ``found``, compared with L-polynomials of the same curve.

    PrecisionLoss if an L-polynomial contradicts them, which shows that some relation of the periods is no endomorphism.
    """
    rational = found.over_the_rationals()
    result = Seen(algebra(found.matrices), algebra(rational), 0, False)
    if L is None:
        return result
    polynomials = [(p, L.polynomial(p)) for p in L.p[:PRIMES].tolist()]
    for p, one in polynomials:
        _compare(p, one, len(found.matrices), rational)
    only = len(found.matrices) == 1 and len(_centres(polynomials)) > 1
    return result._replace(primes=len(polynomials), proven=only)


# --- the names of algebras


def algebra(basis: Sequence[Integers]) -> Algebra:
    """The algebra over QQ spanned by integral matrices, whose span is closed under multiplication."""
    from flint import fmpz_mat

    matrices = [fmpz_mat([list(row) for row in R]) for R in basis]
    size = len(matrices)
    if all(X * Y == Y * X for X in matrices for Y in matrices):
        return Algebra(_product_of_fields(matrices), size, True)
    commutators = [[c for Y in matrices for c in (X * Y - Y * X).entries()] for X in matrices]
    centre = size - fmpz_mat(commutators).rank()
    if centre == 1 and size == 4:
        return Algebra(_quaternions(matrices), size, False)
    if centre == 2 and size == 8:
        # a surface with an algebra of this dimension is isogenous to E², E with complex multiplication by the centre
        kernel, nullity = fmpz_mat(commutators).transpose().nullspace()
        rows = [[int(kernel[i, k]) for i in range(size)] for k in range(nullity)]
        middle = [sum((c * X for c, X in zip(row, matrices, strict=True)), 0 * matrices[0]) for row in rows]
        return Algebra(f"M_2({_product_of_fields(middle)})", size, False)
    return Algebra(f"of dimension {size} over QQ, with a centre of dimension {centre}", size, False)


def _product_of_fields(matrices: Sequence[Any]) -> str:
    """The name of a commutative algebra as a product of fields, one for each irreducible factor of the minimal
    polynomial of a generator.

    The generator is a combination of ``matrices`` with small coefficients. Its minimal polynomial has the least
    discriminant among all such generators.
    """
    generators = []
    for c in product(range(-2, 3) if len(matrices) < 5 else range(-1, 2), repeat=len(matrices)):
        minimal = sum((m * R for m, R in zip(c, matrices, strict=True)), 0 * matrices[0]).minpoly()
        if minimal.degree() == len(matrices):
            generators.append((abs(minimal.discriminant()), sum(map(abs, minimal.coeffs())), minimal))
    least = min(generators, key=lambda found: found[:2])[2]
    return " × ".join(sorted((_field(part) for part, _ in least.factor()[1]), key=lambda name: (len(name), name)))


def _field(polynomial: Any) -> str:
    if polynomial.degree() == 1:
        return "QQ"
    if polynomial.degree() == 2:
        return f"QQ(√{squarefree(int(polynomial.discriminant()))})"
    return f"QQ[x]/({polynomial})"


def squarefree(n: int) -> int:
    """n ≠ 0 without its square factors, with its sign."""
    return (1 if n > 0 else -1) * prod(p for p, e in factorization(abs(n)).items() if e % 2)


def _quaternions(matrices: Sequence[Any]) -> str:
    """The name of a quaternion algebra: M_2(QQ), or its discriminant, from an i and a j in it with ij = −ji."""
    from flint import fmpq, fmpq_mat

    n = matrices[0].nrows()
    one = fmpq_mat([[fmpq(int(i == j)) for j in range(n)] for i in range(n)])

    def trace(X: Any) -> Any:
        return sum((X[i, i] for i in range(n)), fmpq(0)) / n

    pure = [fmpq_mat(R) - trace(fmpq_mat(R)) * one for R in matrices]
    i = next(X for X in pure if X.rank())
    a = trace(i * i)
    if not a:
        return "M_2(QQ)"
    j = next(Y for Y in (X - trace(i * X) / a * i for X in pure) if Y.rank())
    b = trace(j * j)
    if not b:
        return "M_2(QQ)"
    A, B = (squarefree(int(c.p) * int(c.q)) for c in (a, b))
    ramified = [p for p in sorted({2, *factorization(abs(A)), *factorization(abs(B))}) if hilbert(A, B, p) < 0]
    return f"quaternion algebra of discriminant {prod(ramified)}" if ramified else "M_2(QQ)"


def hilbert(a: int, b: int, p: int) -> int:
    """Hilbert's symbol (a, b) at a prime, a and b squarefree: 1 if ax² + by² = 1 has solutions in QQ_p, else −1."""
    alpha, beta = (int(c % p == 0) for c in (a, b))
    u, v = a // p**alpha, b // p**beta
    if p == 2:
        exponent = (u - 1) // 2 * ((v - 1) // 2) + alpha * ((v * v - 1) // 8) + beta * ((u * u - 1) // 8)
        return -1 if exponent % 2 else 1
    sign = -1 if alpha and beta and p % 4 == 3 else 1
    for unit, other in ((u, beta), (v, alpha)):
        if other and pow(unit, (p - 1) // 2, p) != 1:
            sign = -sign
    return sign


# --- comparison with L-polynomials


def _compare(p: int, L: Sequence[int], geometric: int, rational: Sequence[Integers]) -> None:
    """Raises PrecisionLoss if L_p shows that the endomorphism ring over ℂ has a rank below ``geometric``, or that
    ``rational`` are not endomorphisms over QQ.
    """
    from flint import fmpz_mat

    if geometric > _endomorphisms_of(_power(L, ROOTS_OF_UNITY)) or len(rational) > _endomorphisms_of(_power(L, 1)):
        raise PrecisionLoss(f"p = {shown(p)}: the reduction has fewer endomorphisms than were seen; use more digits")
    for R in rational:
        minimal = fmpz_mat([list(row) for row in R]).minpoly()
        d = squarefree(int(minimal.discriminant())) if minimal.degree() == 2 else 0
        if d and (d != 1 or len(L) == 5) and not is_norm(L, d):
            raise PrecisionLoss(f"p = {shown(p)}: L_p is no norm from QQ[x]/({minimal}); use more digits")


def is_norm(L: Sequence[int], d: int) -> bool:
    """Whether an L-polynomial is a norm from E[T] with E = QQ(√d), in any genus, or E = QQ × QQ (d = 1), in genus 2."""
    factors = _power(L, 1).factor()[1]
    if d == 1:
        return all(part.degree() < 3 for part, _ in factors)
    return all(times % 2 == 0 or _splits(part, d) for part, times in factors)


def _splits(polynomial: Any, d: int) -> bool:
    """Whether an irreducible polynomial factors over QQ(√d).

    If the norm to QQ[x] of polynomial(x + m√d) is squarefree, the polynomial factors exactly if this norm does (Trager
    1976).
    """
    from flint import fmpz_poly

    if polynomial.degree() % 2:
        return False
    x = fmpz_poly([0, 1])
    for m in count(1):
        # polynomial(x + m√d) = even + odd·√d
        even, odd, power = fmpz_poly([0]), fmpz_poly([0]), (fmpz_poly([1]), fmpz_poly([0]))
        for c in polynomial.coeffs():
            even, odd = even + c * power[0], odd + c * power[1]
            power = (power[0] * x + d * m * power[1], power[1] * x + m * power[0])
        norm = even * even - d * odd * odd
        if norm.gcd(norm.derivative()).degree() == 0:
            return len(norm.factor()[1]) > 1
    return False


def _power(L: Sequence[int], n: int) -> Any:
    """The monic polynomial with the n-th powers of the eigenvalues of Frobenius as roots, by their power sums."""
    from flint import fmpz_poly

    size = len(L) - 1
    sums = power_sums(list(L), n * size)[n::n]
    return fmpz_poly(leading([-s for s in sums])[::-1])


def _endomorphisms_of(frobenius: Any) -> int:
    """The dimension of End⁰ from the polynomial of Frobenius: Σ m² over its roots, m their multiplicity (Tate 1966)."""
    return sum(part.degree() * times**2 for part, times in frobenius.factor_squarefree()[1])


def _centres(polynomials: Sequence[tuple[int, Sequence[int]]]) -> set[int]:
    """Squarefree d such that End⁰(J) is QQ or contains QQ(√d), in genus 1 and 2; two of them prove End⁰(J) = QQ."""
    found: set[int] = set()
    for p, L in polynomials:
        if len(L) == 3 and L[1] % p:
            found.add(squarefree(L[1] ** 2 - 4 * p))
        elif len(L) == 5 and L[2] % p:
            a, b = L[1:3]
            inner, outer = a * a - 4 * b + 8 * p, (b + 2 * p) ** 2 - 4 * p * a * a
            # if QQ(π) is not biquadratic, its real subfield is its only quadratic subfield
            if isqrt(inner) ** 2 != inner and isqrt(outer) ** 2 != outer:
                factors = _power(L, ROOTS_OF_UNITY).factor()[1]
                found |= {squarefree(inner)} if len(factors) == factors[0][1] == 1 else set()
        if len(found) > 1:
            break
    return found
