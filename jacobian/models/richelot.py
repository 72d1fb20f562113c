"""(2,2)-isogenies of Jacobians of curves of genus 2 (Richelot 1837; Bost & Mestre 1988; Smith 2005, chapter 8).

Let y² = G₁G₂G₃ with quadratic (or linear) G_i, D the determinant of their coefficients, ascending, and H_i = G_j'G_k −
G_jG_k' for (i, j, k) = (1, 2, 3), (2, 3, 1), (3, 1, 2). The kernel consists of 0 and the classes of the points over the
roots of each G_i; the target is the Jacobian of Y² = D·H₁H₂H₃. The isogeny maps the class of a point (x, y) to that of
the two points (X, Y) with

    G₁(x)H₁(X) + G₂(x)H₂(X) = 0,    yY = D·G₁(x)H₁(X)(x − X).

If D = 0, the target is a product of two elliptic curves instead (:class:`Splitting`).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from itertools import combinations
from typing import Any

from jacobian import poly
from jacobian.curve.curve import HyperellipticCurve, check_curve, coefficient
from jacobian.errors import ArgumentError, FieldError, entries, shown
from jacobian.fields.factor import factor, roots
from jacobian.fields.protocol import Field
from jacobian.immutable import Immutable
from jacobian.law.divisor import Divisor
from jacobian.models.isomorphism import Isomorphism
from jacobian.models.pushforward import Family, pushed

Quadratics = tuple[poly.Poly, poly.Poly, poly.Poly]
Mapped = Callable[[poly.Poly], poly.Poly]


class RichelotIsogeny(Immutable):
    """The isogeny from the Jacobian of y² = G₁G₂G₃; get one from :func:`richelot_isogenies`. The kernel consists of 0
    and, for each G_i, the class of the points over its roots.

    ``source``, ``target``: the curves; ``quadratics``: the G_i. ``phi(D)`` is the image of a class; :meth:`dual` is the
    isogeny back, so that ``phi.dual()(phi(D)) == 2 * D``. The field is exact, of characteristic other than 2.
    """

    def __init__(self, source: HyperellipticCurve, quadratics: Quadratics) -> None:
        self.source, self.quadratics = _checked(source, quadratics)
        K = source.field
        self.determinant = determinant(K, self.quadratics)
        if K.is_zero(self.determinant):
            raise ArgumentError("quadratics: their determinant is 0, the target is a product: see Splitting")
        G1, G2, G3 = self.quadratics
        self.images = _bracket(K, G2, G3), _bracket(K, G3, G1), _bracket(K, G1, G2)
        product = poly.mul(K, poly.mul(K, self.images[0], self.images[1]), self.images[2])
        self.target = HyperellipticCurve(K, poly.scale(K, self.determinant, product))

    def kernel(self) -> list[Divisor]:
        """The three classes of order 2 in the kernel."""
        return kernel(self.source, self.quadratics)

    def __call__(self, D: Divisor) -> Divisor:
        """The image of a class; over QQ NotRepresentable where no rational classes in general position are found."""
        return pushed(self.source, self.target, D, self._family)

    def _family(self, L: Field, move: Mapped, u: poly.Poly, v: poly.Poly) -> Family | None:
        """The image (U_t, V_t) of (t, v(t)), t in L[t]/u; None if it is not defined at both points of (u, v)."""
        family = Family(L, u)
        (G1, G2), (H1, H2) = (map(move, pair[:2]) for pair in (self.quadratics, self.images))
        g1, g2 = family.reduced(G1), family.reduced(G2)
        h1, h2 = ([poly.trim(L, (coefficient(L, H, i),)) for i in range(3)] for H in (H1, H2))
        form = [poly.add(L, family.times(g1, x), family.times(g2, y)) for x, y in zip(h1, h2, strict=True)]
        factor = family.over(poly.mul(L, g1, move((self.determinant,))), v)
        if factor is None or not family.set_modulus(form):
            return None
        # V_t = D·G₁(t)/v(t) · H₁(X)(t − X) with D = ``determinant``
        rising = [family.times(family.generator, x) for x in h1]
        cubic = [poly.sub(L, x, y) for x, y in zip([*rising, ()], [(), *h1], strict=True)]
        family.set_value([family.times(factor, c) for c in cubic])
        return family

    def dual(self) -> DualIsogeny:
        """The dual isogeny, from ``target`` to ``source``, with ``dual(phi(D)) == 2 * D``."""
        return DualIsogeny(self)

    def __repr__(self) -> str:
        K = self.source.field
        kernel = ", ".join(poly.text(K, G) for G in self.quadratics)
        return f"Richelot isogeny from {self.source!r} with kernel ({kernel}) to {self.target!r}"


class DualIsogeny(Immutable):
    """The map back from the target Y² = D·H₁H₂H₃ of a Richelot isogeny (:mod:`jacobian.models.richelot`): the Richelot
    isogeny of the quadratics D·H₁, H₂, H₃, followed by y → −y/(4D⁴).
    """

    def __init__(self, forward: RichelotIsogeny) -> None:
        K, D = forward.source.field, forward.determinant
        H1, H2, H3 = forward.images
        self.forward = forward
        self.back = RichelotIsogeny(forward.target, (poly.scale(K, D, H1), H2, H3))
        fourth = K.mul(K.mul(D, D), K.mul(D, D))
        plus = forward.source.infinity_plus if forward.source.model == "split" else None
        scale = K.inv(K.mul(poly.integer(K, -4), fourth))
        self.scaled = Isomorphism(self.back.target, (1, 0, 0, 1), scale, infinity_plus=plus)

    def __repr__(self) -> str:
        return f"<dual of {self.forward!r}>"

    def __call__(self, D: Divisor) -> Divisor:
        """The image of a class D on the target of the Richelot isogeny ``forward``, whose dual this is."""
        return self.scaled(self.back(D))


class Splitting(Immutable):
    """The isogeny from the Jacobian of y² = G₁G₂G₃ with linearly dependent G_i to two elliptic curves.

    There are s₁, s₂, one of them possibly ∞, with G_i = a_i(x − s₁)² + b_i(x − s₂)². The curve covers Y² = Π(a_iX +
    b_i) by X = ((x − s₁)/(x − s₂))², and Y² = Π(a_i + b_iX) by the inverse of this X. ``source``, ``targets``: the
    curves; ``split(D)``: the two images of a class. FieldError where s₁ and s₂ are conjugate; it names the field that
    contains them.
    """

    def __init__(self, source: HyperellipticCurve, quadratics: Quadratics) -> None:
        self.source, self.quadratics = _checked(source, quadratics)
        K = source.field
        if not K.is_zero(determinant(K, self.quadratics)):
            raise ArgumentError("quadratics: their determinant is not 0, the target is a Jacobian: see RichelotIsogeny")
        self.move = Isomorphism(source, _to_squares(K, self.quadratics))
        # the moved curve is y² = Π(a_i x² + b_i)
        product = self.move.target.f[::2]
        self.targets = HyperellipticCurve(K, product), HyperellipticCurve(K, product[::-1])

    def __repr__(self) -> str:
        return f"<isogeny from the Jacobian of {self.source!r} to {self.targets[0]!r} and {self.targets[1]!r}>"

    def kernel(self) -> list[Divisor]:
        """The three classes of order 2 in the kernel."""
        return kernel(self.source, self.quadratics)

    def __call__(self, D: Divisor) -> tuple[Divisor, Divisor]:
        """The images of a class on both curves."""
        E, there = self.move.target, self.move(D)
        first = pushed(E, self.targets[0], there, self._squares)
        return first, pushed(E, self.targets[1], there, self._inverse_squares)

    @staticmethod
    def _squares(L: Field, move: Mapped, u: poly.Poly, v: poly.Poly) -> Family:
        family = Family(L, u)
        square = family.times(family.generator, family.generator)
        family.set_modulus([poly.neg(L, square), (L.one,)])
        family.set_value([v])
        return family

    @staticmethod
    def _inverse_squares(L: Field, move: Mapped, u: poly.Poly, v: poly.Poly) -> Family | None:
        family = Family(L, u)
        inverse = family.over((L.one,), family.generator)
        if inverse is None:
            return None
        square = family.times(inverse, inverse)
        family.set_modulus([poly.neg(L, square), (L.one,)])
        family.set_value([family.times(v, family.times(square, inverse))])
        return family


def richelot_isogenies(C: HyperellipticCurve) -> list[RichelotIsogeny | Splitting]:
    """The (2,2)-isogenies from a curve y² = f of genus 2 whose three quadratics are over the field, up to 15.

    The field is QQ or finite of odd characteristic. ``without_h(C).target`` has no h. Splittings that need a quadratic
    extension are omitted.
    """
    K = check_curve(C).field
    found: list[RichelotIsogeny | Splitting] = []
    for quadratics in quadratic_splittings(C):
        if not K.is_zero(determinant(K, quadratics)):
            found.append(RichelotIsogeny(C, quadratics))
            continue
        try:
            found.append(Splitting(C, quadratics))
        except FieldError:
            continue
    return found


def quadratic_splittings(C: HyperellipticCurve) -> Iterator[Quadratics]:
    """All {G₁, G₂, G₃} over the field with y² = G₁G₂G₃, G₁ with the leading coefficient."""
    K = check_curve(C).field
    if not K.exact or K.characteristic == 2:
        raise FieldError(f"field = {K.name}: Richelot isogenies are over QQ and finite fields of odd characteristic")
    if C.genus != 2 or C.h:
        raise ArgumentError(f"C = {C!r}: a curve y² = f of genus 2 is needed; without_h(C).target is one")
    irreducible = [P for P, _ in factor(K, C.f)] + [()] * (7 - len(C.f))
    pairs: list[poly.Poly] = [P for P in irreducible if len(P) == 3]
    lines = [P for P in irreducible if len(P) in (0, 2)]
    if any(len(P) > 3 for P in irreducible):
        return
    for choice in _pairings(list(range(len(lines)))):
        # () among ``lines`` stands for the point at infinity
        products = [poly.mul(K, lines[i] or (K.one,), lines[j] or (K.one,)) for i, j in choice]
        first, second, third = sorted([*pairs, *products], key=lambda G: (len(G), G))
        yield poly.scale(K, C.f[-1], first), second, third


def _pairings(rest: list[int]) -> Iterator[list[tuple[int, int]]]:
    if not rest:
        yield []
        return
    first, *others = rest
    for other in others:
        for more in _pairings([i for i in others if i != other]):
            yield [(first, other), *more]


def kernel(C: HyperellipticCurve, quadratics: Quadratics) -> list[Divisor]:
    """The classes of the points over the roots of each G_i in the Jacobian of C."""
    K, J = C.field, C.jacobian()
    # on a split model infinity is no branch point, so the G_i have degree 2, and n = 0 subtracts ∞₊ and ∞₋
    n = 0 if C.model == "split" else None
    return [J._reduced(poly.monic(K, G), (), n) for G in quadratics]


def determinant(K: Field, quadratics: Quadratics) -> Any:
    """The determinant of the coefficients of three quadratics, ascending."""
    (a, b, c), (d, e, f), (g, h, i) = ([coefficient(K, G, k) for k in range(3)] for G in quadratics)
    minors = (K.sub(K.mul(e, i), K.mul(f, h)), K.sub(K.mul(f, g), K.mul(d, i)), K.sub(K.mul(d, h), K.mul(e, g)))
    return K.dot((a, b, c), minors)


def _checked(C: HyperellipticCurve, quadratics: Any) -> tuple[HyperellipticCurve, Quadratics]:
    K = check_curve(C).field
    wanted = "three polynomials of degree at most two"
    given = [poly.trim(K, poly.coerce(K, G, "quadratics")) for G in entries(quadratics, "quadratics", wanted)]
    if len(given) != 3:
        raise ArgumentError(f"quadratics = {shown(quadratics)}: {wanted} are needed")
    first, second, third = given
    if C.h or poly.mul(K, poly.mul(K, first, second), third) != C.f or C.genus != 2:
        raise ArgumentError(f"quadratics: their product is not the f of {C!r}, or h ≠ 0")
    if any(len(G) > 3 for G in given):
        raise ArgumentError("quadratics: one of them is of degree 3 or more")
    return C, (first, second, third)


def _bracket(K: Field, a: poly.Poly, b: poly.Poly) -> poly.Poly:
    """a'b − ab': by Euler's relation half the Jacobian determinant of two forms of degree 2."""
    return poly.sub(K, poly.mul(K, poly.derivative(K, a), b), poly.mul(K, a, poly.derivative(K, b)))


def _to_squares(K: Field, quadratics: Quadratics) -> tuple[Any, Any, Any, Any]:
    """The matrix of x' = (x − s₁)/(x − s₂), where s₁ and s₂ are the fixed points of the involution of the line that
    exchanges the roots of each G_i. They are the roots of the Jacobian determinant of any two independent G_i.
    """
    jacobian = next(filter(None, (_bracket(K, a, b) for a, b in combinations(quadratics, 2))))
    degree, fixed = len(jacobian) - 1, roots(K, jacobian)
    if len(fixed) != degree:
        raise FieldError(
            f"field = {K.name}: the elliptic curves are conjugate, over the field of the roots of "
            f"{poly.text(K, jacobian)}: C.change_ring takes C there"
        )
    # if the Jacobian determinant has a single root, this is s₁, and s₂ = ∞
    return K.one, K.neg(fixed[0]), *((K.zero, K.one) if degree == 1 else (K.one, K.neg(fixed[1])))
