"""Cases where compiled code cannot be kept, and where nothing is compiled."""

import json
import os
import subprocess
import sys

import pytest

# numba tries several folders, none of which is writable here
NOWHERE = """
from numba.core import caching
def refused(self):
    raise PermissionError(13, "Permission denied")
caching._CacheLocator.ensure_cache_path = refused
from jacobian.native import kept
kept.place = lambda: None
"""
USES = """
from random import Random
from jacobian import GF, CC, RR, HyperellipticCurve
from jacobian.batch import DivisorArray
QUINTIC, SEXTIC = [1, 0, 0, 0, 0, 1], [1, 1, 0, 0, 0, 0, 1]
for K, f, h in ((GF(10007), QUINTIC, ()), (GF(2**61 - 1), SEXTIC, ()), (GF(3, 2), [1, 1, 0, 2], ()),
                (GF(2, 4), QUINTIC, [1]), (RR, QUINTIC, ()), (CC, SEXTIC, ())):
    J = HyperellipticCurve(K, f, h).jacobian()
    J.compile()
    D = J.random(Random(1))
    if K.exact:
        E = D + D
        assert (3 * D == E + D) and (E - D == D) and E == D.double()
    A = DivisorArray.stack([D, J.zero(), 2 * D])
    kind = {RR: "float64", CC: "complex128"}.get(K, "int64")
    for B, rows in ((A + D, [2 * D, D, 3 * D]), (3 * A, [3 * D, J.zero(), 6 * D]), (-A, [-D, J.zero(), -(2 * D)]),
                    (A * [1, 2, 3], [D, J.zero(), 6 * D]), (A.double(), [2 * D, J.zero(), 4 * D])):
        assert B.u.dtype == B.v.dtype == kind, (K, B.u.dtype)
        for mine, row in zip(B, rows, strict=True):
            if K.exact:
                assert mine == row
            else:
                assert len(mine.u) == len(row.u)
                assert all(abs(x - y) < 1e-9 * (1 + abs(y)) for x, y in zip(mine.u + mine.v, row.u + row.v))
J = HyperellipticCurve(GF(40009), QUINTIC).jacobian()
assert J.order() * J.random(Random(1)) == J.zero()
print(0)
"""
FLOWS = """
import json
from integrable import ChaplyginBall
from integrable.oracles.methods import METHODS
ball = ChaplyginBall((1, 2, 3), 0.7)
state = ball.state((0.48, 0.6, 0.64), (0.384, 1.28, -1.488))
found = [ball.flow(state, kernel=kernel).at([10, 1000, 0]).gamma.tolist() for kernel in ("auto", "python", "compiled")]
growth = [r for _, r in ball.flow(state, kernel="compiled").residual_growth([0, 10])]
methods = [method for method in METHODS.values() if method.compiled and method.installed]
costs = {"step": 0.1, "tolerance": 1e-12}
steps = [method.solve(ball, state, [10.0], costs[method.parameter]).gamma.tolist()[0] for method in methods]
print(json.dumps([found, growth, steps]))
"""


def run(code, **environment):
    done = subprocess.run(
        [sys.executable, "-W", "error", "-c", code],
        capture_output=True,
        text=True,
        timeout=300,
        check=False,
        env={**os.environ, **environment},
    )
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


@pytest.mark.slow  # everything is compiled anew
def test_the_flow_without_a_place_for_compiled_code():
    ignored = (
        "import warnings; from jacobian.numbers.compiler import NoCacheWarning as W; "
        "warnings.simplefilter('ignore', W)\n"
    )
    _check(run(NOWHERE + ignored + FLOWS))


def test_the_flow_where_nothing_is_compiled():
    _check(run(FLOWS, NUMBA_DISABLE_JIT="1"))


def _check(found):
    flows, growth, steps = found
    for rows in flows:
        # the values of README.md
        assert abs(rows[0][0] - 0.688668847139046788) < 1e-13
        assert abs(rows[1][0] + 0.88780908) < 1e-8
        assert rows[2] == [0.48, 0.6, 0.64]
    assert max(growth) < 1e-14
    assert all(abs(row[0] - 0.688668847139046788) < 1e-10 for row in steps)


def test_groups_and_batches_where_nothing_is_compiled():
    assert run(USES, NUMBA_DISABLE_JIT="1") == 0


def test_there_is_nothing_to_compile_beforehand():
    """If nothing would be kept on disk or compiled, the command says so at once."""
    code = "import sys; from jacobian.__main__ import main; sys.exit(main(['compile']))"
    for before, environment, said in (
        (NOWHERE, {}, "no folder to keep compiled code in; set NUMBA_CACHE_DIR to a folder that can be written to"),
        ("", {"NUMBA_DISABLE_JIT": "1"}, "NUMBA_DISABLE_JIT is set: nothing is to be compiled"),
    ):
        done = subprocess.run(
            [sys.executable, "-c", before + code],
            capture_output=True,
            text=True,
            timeout=100,
            check=False,
            env={**os.environ, **environment},
        )
        assert (done.returncode, done.stdout, done.stderr) == (2, "", f"jacobian: error: {said}\n")
