"""python-flint's polynomials in reference cycles, and the lifetime of their rings."""

import subprocess
import sys

from jacobian import GF
from jacobian.fields import flint_polynomials, irreducible

COLLECTED = """
import gc
from jacobian import GF
from jacobian.fields.flint_polynomials import conversions

K = {field}
into, _ = conversions(K)
class Node:
    pass


for _ in range(50):
    node = Node()
    node.itself, node.polynomial = node, into([K.one, K.one, K.one])
conversions.cache_clear()
del into, node
gc.collect()
"""


def test_a_polynomial_is_collected_after_its_ring():
    """python-flint 0.9 frees coefficients by the field of the ring, which may be cleared before."""
    code = "\n".join(
        COLLECTED.format(field=field) for field in ("GF(7, 9)", "GF(101, 2)", "GF(2**89 - 1)", "GF(2, 20)")
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr[-1000:]


def test_of_a_prime_of_a_word_no_ring_is_kept():
    before = irreducible.prime_ring.cache_info().currsize
    into, back = flint_polynomials.conversions(GF(2**61 - 1))
    assert back(into((1, 0, 2))) == (1, 0, 2)
    assert irreducible.prime_ring.cache_info().currsize == before
