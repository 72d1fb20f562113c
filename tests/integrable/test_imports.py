"""Modules that a computation does not need are not imported."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

HEAVY = ("numpy", "galois", "numba", "matplotlib", "mpmath", "scipy")
BALL = "from integrable import ChaplyginBall; ball = ChaplyginBall((1, 2, 3), 0.7); "
STATE = "state = ball.state((0.48, 0.6, 0.64), (0.384, 1.28, -1.488)); "


@pytest.mark.parametrize(
    ("code", "allowed"),
    [
        ("import integrable", ()),
        (BALL + STATE + "ball.translation([1.8, 2.5])(state)", ()),
        (BALL + STATE + "ball.divisor(state) + ball.divisor(state)", ()),
        (BALL + STATE + "ball.flow(state).at([1.0]).gamma", ("numpy",)),
        (
            "from jacobian import GF; from integrable import EulerTop; top = EulerTop((1, 2, 4), field=GF(10007)); "
            "top.state((1, 0, 0), (0, 1, 0))",
            (),
        ),
    ],
    ids=["import", "one step", "divisor", "flow", "finite field"],
)
def test_only_what_is_needed_is_loaded(code, allowed) -> None:
    check = f"{code}\nimport sys\nprint(sorted(name for name in {HEAVY!r} if name in sys.modules))"
    done = subprocess.run([sys.executable, "-c", check], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == str(sorted(allowed))


@pytest.mark.parametrize(("code", "field"), [("", "RR"), (".at([1.0])", "RR"), ("", "MP(30)")])
def test_llvm_is_loaded_only_where_something_is_compiled(code, field) -> None:
    """The flow of a body loaded it on import, although interpreted motions and flows over MP do not compile."""
    ball = f"from jacobian import MP, RR; {BALL.replace('0.7', '1, field=' + field)}"
    state = STATE.replace("0.48, 0.6, 0.64", "0, 0, 1").replace("0.384, 1.28, -1.488", "1, 2, 0")
    check = f"{ball}{state}ball.flow(state){code}; import sys; print('llvmlite' in sys.modules)"
    environment = os.environ | {"NUMBA_DISABLE_JIT": "1"}
    done = subprocess.run([sys.executable, "-c", check], capture_output=True, text=True, check=True, env=environment)
    assert done.stdout.strip() == "False"


def test_the_list_of_benchmarks_prints_no_warning():
    """Two benchmarks made bodies that no distribution of mass has when they were imported, and stderr had warnings."""
    clone, words = Path(__file__).parents[2], [sys.executable, "-m", "benchmarks", "--list"]
    done = subprocess.run(words, cwd=clone, capture_output=True, text=True)
    assert (done.returncode, done.stderr) == (0, "")
    assert "flow: The exact flow" in done.stdout
