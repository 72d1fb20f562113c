"""The modules that are loaded by an operation, measured in a fresh interpreter."""

import subprocess
import sys

import pytest

HEAVY = ("numpy", "galois", "numba", "matplotlib", "mpmath", "scipy", "flint")
ADDITION = """
from jacobian import RR, HyperellipticCurve
C = HyperellipticCurve(RR, [0, 4, 0, -5, 0, 1])
J = C.jacobian()
D = J.from_points([C.lift_x(-1.5), C.lift_x(3)])
E = J.from_points([C.lift_x(0.5 - 2), C.lift_x(2.5)])
E = D + J.from_points([C.lift_x(-0.0 - 1.25), C.lift_x(2.25)])
-E
"""
# random classes are an exception: python-flint factors their polynomials
PRIME = """
from jacobian import GF, HyperellipticCurve
C = HyperellipticCurve(GF(2**61 - 1), [1, 2, 3, 4, 5, 6, 1])
D = C.jacobian().from_points([(0, 1), next(P for x in range(1, 99) for P in C.lift_x(x, all=True))])
assert not 12345 * D - 12345 * D
K = GF(2, 8, (1, 0, 1, 1, 1, 0, 0, 0, 1))
C = HyperellipticCurve(K, [1, 0, 0, 0, 0, 1], [1])
D = C.jacobian().from_points([C.lift_x(0), next(P for x in range(1, 256) for P in C.lift_x(x, all=True))])
assert not 77 * D + (-77) * D
"""


@pytest.mark.parametrize(
    "code",
    ["import jacobian", ADDITION, PRIME, "from jacobian import MP"],
    ids=["import", "float addition", "exact arithmetic", "MP named"],
)
def test_nothing_heavy_is_loaded(code):
    check = f"{code}\nimport sys\nprint([name for name in {HEAVY!r} if name in sys.modules])"
    done = subprocess.run([sys.executable, "-c", check], capture_output=True, text=True, check=False)
    assert done.stderr == ""
    assert done.stdout == "[]\n"


def test_the_import_alone_loads_little():
    """No optional package, no kernel, and no module that only some fields or groups need."""
    later = (
        "gmpy2",
        "flint",
        "jacobian.batch",
        "jacobian.addition.calls",
        "jacobian.finite.search",
        "jacobian.inexact.composition",
    )
    check = f"import jacobian, sys\nprint([name for name in {later!r} if name in sys.modules])"
    done = subprocess.run([sys.executable, "-c", check], capture_output=True, text=True, check=False)
    assert (done.stdout, done.stderr) == ("[]\n", "")
