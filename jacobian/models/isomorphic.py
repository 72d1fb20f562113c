"""All isomorphisms between two curves of genus ≥ 2 over a finite field of odd characteristic or over QQ.

An isomorphism maps the branch points, the roots of the form F = h² + 4f of degree 2g + 2, to branch points, and up to
y ↦ −y − h it is determined by the images of three. So factors of F with three or more roots in total are chosen, and
these roots are mapped in every possible way to roots of factors of the same degrees. Each choice gives a linear system
over the field for (a : b : c : d) in x' = (ax + b)/(cx + d).

Over QQ the same is done modulo a prime p of good reduction. The result is lifted to a solution of
F'(ax + b, cx + d) = λF modulo powers of p, digit by digit, until the residues determine rational numbers. If F and F'
are integral, the height of (a : b : c : d) is at most 6(‖F‖‖F'‖)³: it is orthogonal to three rows (α, 1, −αβ, −β), α a
root of F and β its image, so a, b, c, d are 3 × 3 minors of these. The heights of α and β are at most the Mahler
measures of F and F', which are at most the Euclidean norms ‖F‖ and ‖F'‖ (Landau 1905).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from fractions import Fraction
from itertools import count, product
from math import isqrt
from typing import Any

from jacobian import poly
from jacobian.curve.curve import HyperellipticCurve, check_curve
from jacobian.element import Arithmetic
from jacobian.errors import ArgumentError, CurveMismatch, FieldError, NotASquare
from jacobian.fields import GF, QQ
from jacobian.fields.change import embedding
from jacobian.fields.factor import factor, roots
from jacobian.fields.primality import is_prime
from jacobian.fields.protocol import Field
from jacobian.fields.rational import primitive
from jacobian.linear import echelon, solution
from jacobian.models.isomorphism import Isomorphism, substituted
from jacobian.relatives.torsion_lifts import rational_of

Matrix = tuple[Any, Any, Any, Any]
# a closed point of the projective line over K: its degree, and its monic irreducible polynomial, () for infinity
Place = tuple[int, poly.Poly]
# the search for a prime of good reduction starts here
FIRST = 1009


def is_isomorphic(C: HyperellipticCurve, E: HyperellipticCurve) -> bool:
    """Whether the curves are isomorphic over their field (see :func:`isomorphisms`)."""
    return next(_isomorphisms(C, E), None) is not None


def automorphisms(C: HyperellipticCurve) -> list[Isomorphism]:
    """The automorphisms of C over its field: the identity and (x, y) → (x, −y − h) first."""
    own = isomorphisms(C, C)
    K = C.field
    return sorted(own, key=lambda iso: (iso.matrix != (K.one, K.zero, K.zero, K.one), iso.scale != K.one))


def isomorphisms(C: HyperellipticCurve, E: HyperellipticCurve) -> list[Isomorphism]:
    """All isomorphisms from C to E over their field, a finite one of odd characteristic or QQ, for genus ≥ 2.

    They come in pairs that differ by y → −y − h. ArgumentError in genus 1, which has other isomorphisms; FieldError in
    characteristic 2 and over inexact fields; CurveMismatch for curves over different fields.
    """
    return list(_isomorphisms(C, E))


def _isomorphisms(C: HyperellipticCurve, E: HyperellipticCurve) -> Iterator[Isomorphism]:
    K = check_curve(C).field
    if check_curve(E).field != K:
        raise CurveMismatch(f"{C!r} and {E!r} are over two fields: C.change_ring(K) makes them one")
    if not K.exact or K.characteristic == 2:
        raise FieldError(f"field = {K.name}: isomorphisms are found over QQ and finite fields of odd characteristic")
    if C.genus == 1 or E.genus == 1:
        raise ArgumentError("genus = 1: translations are isomorphisms too, and of another form; this is for genus ≥ 2")
    if C.genus != E.genus:
        return
    for matrix in _rational_matrices(C, E) if K == QQ else _matrices(K, C.discriminant, E.discriminant, C.genus):
        yield from _with_matrix(C, E, matrix)


def _with_matrix(C: HyperellipticCurve, E: HyperellipticCurve, matrix: Matrix) -> Iterator[Isomorphism]:
    """Yields the isomorphisms with this matrix: e² is the factor in F_E(ax + b, cx + d) = e²F_C, F = h² + 4f."""
    K, n = C.field, C.genus + 1
    moved = substituted(K, E.discriminant, 2 * n, matrix)
    ratio = K.div(moved[-1], C.discriminant[-1])
    if moved != poly.scale(K, ratio, C.discriminant):
        return
    try:
        root = K.sqrt(ratio)
    except NotASquare:
        return
    half, moved_h = K.inv(poly.integer(K, 2)), substituted(K, E.h, n, matrix)
    plus = E.infinity_plus if E.model == "split" else None
    for e in (root, K.neg(root)):
        t = poly.scale(K, half, poly.sub(K, poly.scale(K, e, C.h), moved_h))
        yield Isomorphism(C, matrix, e, t, plus)


# --- matrices over a finite field


def _matrices(K: Field, F: poly.Poly, G: poly.Poly, genus: int) -> list[Matrix]:
    """Candidates (a : b : c : d), the first non-zero number being 1, that map roots of the form F to roots of G."""
    from_places, to_places = (_places(K, form, genus) for form in (F, G))
    if sorted(k for k, _ in from_places) != sorted(k for k, _ in to_places):
        return []
    chosen = _three(from_places)
    images = [[place for place in to_places if place[0] == k] for k, _ in chosen]
    found = set()
    for choice in product(*images):
        if len(set(choice)) < len(choice):
            continue
        for equations in product(*(_equations(K, P, Q) for P, Q in zip(chosen, choice, strict=True))):
            matrix = _null_vector(K, [row for rows in equations for row in rows])
            if matrix is not None:
                found.add(matrix)
    return sorted(found)


def _places(K: Field, form: poly.Poly, genus: int) -> list[Place]:
    """The zeros of a form of degree 2g + 2 without double roots, as closed points."""
    found = [(len(P) - 1, P) for P, _ in factor(K, poly.monic(K, form))]
    return [*found, (1, ())] if len(form) == 2 * genus + 2 else found


def _three(places: list[Place]) -> list[Place]:
    """Closed points with degrees of sum ≥ 3: a single one, if there is one of degree ≥ 3."""
    for place in sorted(places):
        if place[0] >= 3:
            return [place]
    taken: list[Place] = []
    for place in sorted(places, reverse=True):
        taken.append(place)
        if sum(k for k, _ in taken) >= 3:
            break
    return taken


def _equations(K: Any, P: Place, Q: Place) -> list[list[list[Any]]]:
    """For each root β of Q's polynomial, a linear system over K for aα + b = β(cα + d), α being a fixed root of P's.

    Its equations are the traces over K of α^i times this equation, 0 ≤ i < deg P.
    """
    k = P[0]
    if k == 1:
        (x, y), (z, w) = (_rational_point(K, place) for place in (P, Q))
        return [[[K.mul(x, w), K.mul(y, w), K.neg(K.mul(x, z)), K.neg(K.mul(y, z))]]]
    # over GF(p) the polynomial of P serves as the modulus of L
    L = GF(K.characteristic, k, P[1]) if K.degree == 1 else GF(K.characteristic, K.degree * k)
    inclusion = embedding(K, L)
    alpha = roots(L, inclusion.polynomial(P[1]))[0]
    systems = []
    for beta in roots(L, inclusion.polynomial(Q[1])):
        row = [alpha, L.one, L.neg(L.mul(alpha, beta)), L.neg(beta)]
        rows = []
        for _ in range(k):
            rows.append([_trace(inclusion, x, k) for x in row])
            row = [L.mul(alpha, x) for x in row]
        systems.append(rows)
    return systems


def _rational_point(K: Arithmetic, place: Place) -> tuple[Any, Any]:
    return (K.neg(place[1][0]), K.one) if place[1] else (K.one, K.zero)


def _trace(inclusion: Any, x: Any, k: int) -> Any:
    L, total = inclusion.large, inclusion.large.zero
    for _ in range(k):
        total, x = L.add(total, x), inclusion.frobenius(x)
    return inclusion.back(total)


def _null_vector(K: Field, rows: list[list[Any]]) -> Matrix | None:
    """The solution (a : b : c : d), its first non-zero number being 1; None if it is not unique, or if ad = bc."""
    pivots = echelon(K, rows, 4)
    if len(pivots) != 3:
        return None
    free = next(i for i in range(4) if i not in {column for column, _ in pivots})
    solution = [K.zero] * 4
    solution[free] = K.one
    for column, pivot in pivots:
        solution[column] = K.neg(pivot[free])
    if K.is_zero(K.sub(K.mul(solution[0], solution[3]), K.mul(solution[1], solution[2]))):
        return None
    unit = K.inv(next(x for x in solution if not K.is_zero(x)))
    a, b, c, d = (K.mul(unit, x) for x in solution)
    return a, b, c, d


# --- over QQ


def _rational_matrices(C: HyperellipticCurve, E: HyperellipticCurve) -> Iterator[Matrix]:
    F, G = (primitive(X.discriminant) for X in (C, E))
    p = next(p for p in count(FIRST, 2) if is_prime(p) and all(_separable(p, form) for form in (F, G)))
    K = GF(p)
    f, g = (tuple(c % p for c in form) for form in (F, G))
    for matrix in _matrices(K, f, g, C.genus):
        found = _lifted(p, (F, G), matrix, 6 * (_norm(F) * _norm(G)) ** 3)
        if found is not None:
            yield found


def _lifted(p: int, forms: tuple[list[int], list[int]], matrix: Matrix, height: int) -> Matrix | None:
    """The rational matrix, of at most this height, that reduces to ``matrix`` modulo p; None if there is none."""
    F, G = forms
    size, modulus = len(F) - len(F) % 2, p
    unit = next(i for i, x in enumerate(matrix) if x)
    free = [i for i in range(4) if i != unit]
    moved = _moved(G, size, matrix)
    top = next(i for i, c in enumerate(F) if c % p)
    numbers = [*matrix, moved[top] * pow(F[top], -1, p) % p]
    slopes = _slopes(G, size, matrix)
    # the unknowns are the three entries other than the fixed 1, and the factor c in (the transformed G) = cF
    system = [[*(slopes[i][j] % p for i in free), -_entry(F, j) % p] for j in range(size + 1)]
    while modulus <= 2 * height**2 * p:
        found = _fractions(numbers[:4], modulus)
        if found is not None and _proportional(F, _moved(G, size, found)):
            return found
        wrong = [(x - numbers[4] * _entry(F, j)) // modulus for j, x in enumerate(_moved(G, size, numbers[:4]))]
        change = solution(GF(p), system, [-x % p for x in wrong])
        if change is None:
            return None
        for i, x in zip([*free, 4], change, strict=True):
            numbers[i] += modulus * x
        modulus *= p
    return None


def _moved(form: Sequence[int], degree: int, matrix: Sequence[Any]) -> list[Any]:
    """The coefficients of the form at (ax + b, cx + d), degree + 1 of them, ints where they are whole."""
    moved = substituted(QQ, tuple(form), degree, matrix)
    return [int(x) if x.denominator == 1 else x for x in (_entry(moved, j) for j in range(degree + 1))]


def _slopes(form: Sequence[int], degree: int, matrix: Sequence[Any]) -> list[list[Any]]:
    """The derivatives of :func:`_moved` by the entries a, b, c and d of ``matrix``."""
    above = [i * c for i, c in enumerate(form)][1:]
    below = [(degree - i) * c for i, c in enumerate(form)][:degree]
    rows = []
    for part in (above, below):
        plain = _moved(part, degree - 1, matrix)
        rows += [[0, *plain], [*plain, 0]]
    return rows


def _entry(form: Sequence[Any], j: int) -> Any:
    return form[j] if j < len(form) else 0


def _proportional(F: Sequence[int], moved: list[Any]) -> bool:
    top = next(i for i, c in enumerate(F) if c)
    return all(x * F[top] == moved[top] * _entry(F, j) for j, x in enumerate(moved))


def _norm(form: Sequence[int]) -> int:
    return isqrt(sum(c * c for c in form)) + 1


def _separable(p: int, form: Sequence[int]) -> bool:
    K, reduced = GF(p), tuple(c % p for c in form)
    return reduced[-1] != 0 and len(poly.gcd(K, reduced, poly.derivative(K, reduced))) == 1


def _fractions(residues: Sequence[int], modulus: int) -> Matrix | None:
    """The rational numbers, of height up to √(modulus/2), that have these four residues, or None."""
    pairs = [rational_of(c, modulus, isqrt(modulus // 2)) for c in residues]
    a, b, c, d = (pair and Fraction(*pair) for pair in pairs)
    return None if None in pairs else (a, b, c, d)
