"""Arrays of divisors: the group law of a Jacobian on N classes at once.

>>> from jacobian import GF, HyperellipticCurve
>>> from jacobian.batch import DivisorArray
>>> J = HyperellipticCurve(GF(7), [1, 0, 0, 0, 0, 1]).jacobian()
>>> A = DivisorArray.stack([J.from_points([(0, 1)])] * 4)
>>> [0, 1, 2, 5] * A
DivisorArray([(1, 0), (x, 1), (x^2, 1), …], 4 rows)
"""

from jacobian.batch.array import DivisorArray
from jacobian.numbers.threads import set_threads, threads

__all__ = ["DivisorArray", "set_threads", "threads"]
