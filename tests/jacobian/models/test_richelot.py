"""(2,2)-isogenies: homomorphisms with the right kernel, their duals, orders, chains, the split case."""

from random import Random

import pytest

from jacobian import GF, QQ, RR, ArgumentError, CurveMismatch, FieldError, HyperellipticCurve, JacobianError, poly
from jacobian.models.richelot import RichelotIsogeny, Splitting, richelot_isogenies
from jacobian.models.standard import without_h


def curves(K, count, rng, dependent=False):
    """Curves y² = G₁G₂G₃ of genus 2, sometimes with a linear G₁, or with G₃ in the span of the others."""
    while count:
        first, second, third = (poly.random(K, 3, rng) for _ in range(3))
        if rng.random() < 0.3:
            first = poly.trim(K, first[:2])
        if dependent:
            third = poly.add(K, poly.scale(K, K.random(rng), first), poly.scale(K, K.random(rng), second))
        try:
            C = HyperellipticCurve(K, poly.mul(K, poly.mul(K, first, second), third))
        except JacobianError:
            continue
        if C.genus == 2:
            count -= 1
            yield C


@pytest.mark.thinned(4)
@pytest.mark.parametrize("K", [GF(3), GF(5), GF(101), GF(7, 2), GF(2**61 - 1)], ids=lambda K: K.name)
def test_isogenies_are_homomorphisms_with_a_dual(K):
    rng, models = Random(3), set()
    for C in curves(K, 8 if K.order > 10 else 3, rng):
        J = C.jacobian()
        for phi in richelot_isogenies(C)[:2]:
            if isinstance(phi, Splitting):
                continue
            models.add(C.model)
            assert len(set(phi.kernel())) == 3
            assert all(S and not 2 * S and not phi(S) for S in phi.kernel())
            assert sum(phi.kernel()) == J.zero()
            D, E = J.random(rng), J.random(rng)
            assert phi(D) + phi(E) == phi(D + E)
            assert phi.dual()(phi(D)) == 2 * D
            F = phi.target.jacobian().random(rng)
            assert phi(phi.dual()(F)) == 2 * F
            assert phi(J.zero()) == phi.target.jacobian().zero()
            assert K.order > 1000 or J.order() == phi.target.jacobian().order()
    assert K.order < 10 or models == {"ramified", "split", "inert"}


@pytest.mark.thinned(2)
@pytest.mark.parametrize("K", [GF(13), GF(101), GF(7, 2)], ids=lambda K: K.name)
def test_a_dependent_splitting_leads_to_elliptic_curves(K):
    rng, tried = Random(5), 0
    for C in curves(K, 12, rng, dependent=True):
        J = C.jacobian()
        for phi in richelot_isogenies(C):
            if not isinstance(phi, Splitting):
                continue
            tried += 1
            first, second = phi.targets
            assert (first.genus, second.genus) == (1, 1)
            assert J.order() == first.jacobian().order() * second.jacobian().order()
            D, E = J.random(rng), J.random(rng)
            assert tuple(a + b for a, b in zip(phi(D), phi(E), strict=True)) == phi(D + E)
            assert not any(image for S in phi.kernel() for image in phi(S))
    assert tried > 4


def test_all_fifteen():
    C = HyperellipticCurve(GF(101), poly.from_roots(GF(101), [1, 2, 4, 8, 16, 31]))
    found = richelot_isogenies(C)
    assert len(found) == 15
    classes = {S for phi in found for S in phi.kernel()}
    assert len(classes) == 15 == len([D for D in C.jacobian().torsion(2).elements() if D])


def a_chain(C, length):
    """Successive isogenies, none of them dual to the one before; None where there is no such chain."""
    chain = []
    for _ in range(length):
        curve = chain[-1].target if chain else C
        back = set(chain[-1].dual().back.kernel()) if chain else set()
        steps = (phi for phi in richelot_isogenies(curve) if isinstance(phi, RichelotIsogeny))
        phi = next((phi for phi in steps if set(phi.kernel()) != back), None)
        if phi is None:
            return None
        chain.append(phi)
    return chain


def test_a_chain_and_its_way_back():
    """Three steps and back by the duals: multiplication by 8."""
    K, rng, chain = GF(10007), Random(1), None
    while chain is None:
        C = HyperellipticCurve(K, poly.from_roots(K, rng.sample(range(K.order), 6)))
        chain = a_chain(C, 3)
    D = image = C.jacobian().random(rng)
    for phi in chain:
        image = phi(image)
    for phi in reversed(chain):
        image = phi.dual()(image)
    assert image == 8 * D


def test_over_the_rational_numbers():
    C = HyperellipticCurve(QQ, poly.from_roots(QQ, [0, 1, -1, 2, -3]))
    D = C.jacobian()(C.point(3, 12))
    found = richelot_isogenies(C)
    assert len(found) == 15
    for phi in found[:5]:
        assert phi.dual()(phi(D)) == 2 * D
        assert phi(3 * D) == 3 * phi(D)
        reduced = phi(D).change_ring(GF(10007))
        below = RichelotIsogeny(C.change_ring(GF(10007)), [[int(c) % 10007 for c in G] for G in phi.quadratics])
        assert below(D.change_ring(GF(10007))) == reduced


def test_what_is_refused():
    K = GF(101)
    C = HyperellipticCurve(K, poly.from_roots(K, [1, 2, 4, 8, 16, 31]))
    phi = richelot_isogenies(C)[0]
    with pytest.raises(CurveMismatch, match="the isogeny begins at"):
        phi(phi.target.jacobian().zero())
    with pytest.raises(ArgumentError, match="their product is not"):
        RichelotIsogeny(C, [[1, 1], [1, 2], [1, 3]])
    for wrong in (3, [[1, 1], [1, 2]]):
        with pytest.raises(ArgumentError, match=r"quadratics = .*: three polynomials"):
            RichelotIsogeny(C, wrong)
    with pytest.raises(ArgumentError, match="their determinant is not 0"):
        Splitting(C, phi.quadratics)
    even = HyperellipticCurve(K, poly.mul(K, poly.mul(K, (1, 0, 1), (2, 0, 1)), (3, 0, 1)))
    with pytest.raises(ArgumentError, match="the target is a product"):
        RichelotIsogeny(even, [[1, 0, 1], [2, 0, 1], [3, 0, 1]])
    with_h = HyperellipticCurve(K, [1, 3, 1, 4, 1, 1], [1])
    with pytest.raises(ArgumentError, match="without_h"):
        richelot_isogenies(with_h)
    assert richelot_isogenies(without_h(with_h).target) is not None
    with pytest.raises(FieldError, match="over QQ and finite fields"):
        richelot_isogenies(HyperellipticCurve(RR, [1, 0, 0, 0, 0, 1]))
    assert richelot_isogenies(HyperellipticCurve(QQ, [2, 0, 0, 0, 0, 0, 1])) == []
