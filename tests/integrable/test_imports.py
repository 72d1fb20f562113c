"""Modules that a computation does not need are not imported."""

from __future__ import annotations

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


def test_the_list_of_benchmarks_prints_no_warning():
    """Two benchmarks made bodies that no distribution of mass has when they were imported, and stderr had warnings."""
    clone, words = Path(__file__).parents[2], [sys.executable, "-m", "benchmarks", "--list"]
    done = subprocess.run(words, cwd=clone, capture_output=True, text=True)
    assert (done.returncode, done.stderr) == (0, "")
    assert "flow: The exact flow" in done.stdout
