"""Square roots in residue fields, checked for the squares of all elements."""

import pytest

from jacobian import GF
from jacobian.errors import NotASquare
from jacobian.fields.irreducible import first_irreducible
from jacobian.fields.residue import ResidueField


@pytest.mark.thinned(2)
@pytest.mark.parametrize("degree", [1, 2, 3])
@pytest.mark.parametrize("K", [GF(3), GF(7), GF(13), GF(2, 2), GF(3, 2)], ids=repr)
def test_square_roots_of_all_elements(K, degree):
    own = GF(K.characteristic)
    P = first_irreducible(own, degree) if own == K else next(_irreducible(K, degree))
    L = ResidueField(K, P)
    squares = {L.mul(x, x) for x in L.elements()}
    for x in L.elements():
        if x in squares:
            root = L.sqrt(x)
            assert L.mul(root, root) == x
        else:
            with pytest.raises(NotASquare):
                L.sqrt(x)


def _irreducible(K, degree):
    """The monic irreducible polynomials of a degree up to 3, where these are the ones without a root."""
    from itertools import product

    from jacobian import poly

    for low in product(list(K.elements()), repeat=degree):
        P = (*low, K.one)
        if degree == 1 or all(poly.evaluate(K, P, x) != K.zero for x in K.elements()):
            yield P
