"""A type checker on a user's script: it infers the types of values and finds a misspelt name before the script runs."""

from __future__ import annotations

import ast
import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
# an expression of a user, and mypy's answer without module names
KNOWN = {
    "GF(101)": "FiniteField",
    "GF(7, 2)": "FiniteField",
    "MP(30)": "MultiprecisionField",
    "GF(7).inv(3)": "int",
    "GF(7, 2).coerce('2')": "int",
    "QQ.coerce('1/3')": "Fraction",
    "RR.sqrt(2.0)": "float",
    "C.field": "Field[int]",
    "J.field": "Field[int]",
    "ball.field": "Field[float]",
    "C.field.order": "int | None",
    "C.genus": "int",
    "C.f": "tuple[int, ...]",
    "HyperellipticCurve(QQ, ['1/3', 0, 0, 0, 0, 1])": "HyperellipticCurve[Fraction]",
    "over(RR).jacobian().zero().u": "tuple[float, ...]",
    "over(CC).jacobian()(0)": "Divisor[complex]",
    "over(GF(7, 2)).jacobian()": "Jacobian[int]",
    # mpmath has no types
    "over(MP(30)).f": "tuple[Any, ...]",
    "over(QQ).change_ring(GF(7)).jacobian()": "Jacobian[int]",
    "over(QQ).quadratic_twist(5)": "HyperellipticCurve[Fraction]",
    "over(QQ).jacobian()(over(QQ).lift_x(2)).change_ring(RR)": "Divisor[float]",
    "sum_of(over(QQ).jacobian().zero())": "Divisor[Fraction]",
    "C.point(0, 1)": "tuple[int, int, fallback=AffinePoint[int]]",
    "J.order()": "int",
    "J.random(Random(1))": "Divisor[int]",
    "J(C.point(0, 1))": "Divisor[int]",
    "D.support()": "list[tuple[tuple[int, int, fallback=AffinePoint[int]] | PointAtInfinity, int]]",
    "J": "Jacobian[int]",
    "D": "Divisor[int]",
    "D + D": "Divisor[int]",
    "D - D": "Divisor[int]",
    "-D": "Divisor[int]",
    "3 * D": "Divisor[int]",
    "sum([D, D])": "Divisor[int] | Literal[0]",
    "D.double()": "Divisor[int]",
    "D.u": "tuple[int, ...]",
    "D.n": "int | None",
    "J.zero()": "Divisor[int]",
    "C.lift_x(0, all=True)": "list[tuple[int, int, fallback=AffinePoint[int]]]",
    "many": "DivisorArray[int]",
    "many + D": "DivisorArray[int]",
    "many[0]": "Divisor[int]",
    "many[:1]": "DivisorArray[int]",
    "many.u": "ndarray[tuple[int, int], dtype[Any]]",
    "many.degree": "ndarray[tuple[int], dtype[Any]]",
    "ball": "ChaplyginBall[float]",
    "state": "State[float]",
    "state.gamma": "ndarray[tuple[int], dtype[float64]]",
    "state.vectors[0]": "tuple[float, float, float]",
    "exact": "ChaplyginBall[Fraction]",
    "exact.state((1, 0, 0), (0, '1/3', 0)).M": "tuple[Fraction, Fraction, Fraction]",
    "exact.curve(1, 2).jacobian()": "Jacobian[Fraction]",
    "ChaplyginBall((1, 2, 3), 2, field=GF(101)).d": "int",
    "EulerTop((1, 2, 3)).omega(state)": "tuple[float, float, float]",
    "EulerTop.t_handle()[0].hat_map()(state)": "State[float]",
    "ball.divisor(state)": "Divisor[float]",
    "ball.integrals(state)": "tuple[float, float, float, float, fallback=Integrals[float]]",
    "ball.translation([1.8, 2.5])(state)": "State[float]",
    "ball.flow(state)": "Flow",
    "run": "Trajectory",
    "run.gamma": "ndarray[tuple[int, int], dtype[Any]]",
    "run[0]": "State[Any]",
    "run[1:]": "Trajectory",
    "Neumann((1, 2, 4))": "Neumann",
    "RigidBody((1, 2, 3)).motion(np.eye(3), (1, 2, 3)).at([1]).omega": "ndarray[tuple[Any, ...], dtype[Any]]",
    "run.times": "ndarray[tuple[int], dtype[Any]]",
    "run.attitude": "ndarray[tuple[int, int, int], dtype[Any]]",
    "ball.flow(state).at([1], strict=False).status": "ndarray[tuple[int], dtype[Any]]",
    "tilde.flow(start)": "DeformedFlow",
    "tilde.flow(start).at([1])": "Trajectory",
    "tilde.flow(start).at_tau([1]).M": "ndarray[tuple[int, int], dtype[Any]]",
    "Gyroscopic((1, 2, 4), 0.3).motion_through(start).at([1])": "Trajectory",
    "tilde.field": "Field[Any]",
    "tilde.over(MP(30))": "Tilde",
    "tilde.translation([1, None])(start)": "State[Any]",
    "load_scene('chaplygin')": "Scene",
    "integrable.run('chaplygin')": "Trajectory",
    "integrable.sweep('chaplygin', out='chaplygin.zarr')": "Swept",
    "integrable.ensemble(ball, (1, 0, 0), (0, 1, 0))": "Ensemble",
    "integrable.ensemble(ball, (1, 0, 0), (0, 1, 0)).at([1])": "Trajectories",
}
WRONG = {
    "exact.divisor(state)": "incompatible type",
    "ball.state((1, 0, 0), 0.5)": "incompatible type",
    "ChaplyginBall((1, 2, 3), [0.7])": "incompatible type",
    "ball.translation(1.8)": "incompatible type",
    "J.from_pionts([(0, 1)])": "from_pionts",
    "ball.flow(state).at('1')": "incompatible type",
    "ball.flow(state).at([1, None])": "List item 1 has incompatible type",
    "ball.flow(exact.state((1, 0, 0), (0, 1, 0)))": "incompatible type",
    "Neumann((1, 2, 4)).state((0.6, 0, 0.8), 1)": "incompatible type",
    "tilde.flow(start).at_tau('1')": "incompatible type",
    "integrable.ensemble(exact, (1, 0, 0), (0, 1, 0))": "incompatible type",
    "integrable.ensemble(ball, (1, 0, 0), (0, 1, 0)).at('1')": "incompatible type",
    "RigidBody((1, 2, 3)).motion(np.eye(3), 1.0)": "incompatible type",
    "run[0].times": "times",
    "D + 'E'": "Unsupported operand",
    "D * 'E'": "Unsupported operand",
    "D + over(QQ).jacobian().zero()": 'Unsupported operand types for + ("Divisor[int]" and "Divisor[Fraction]")',
    "many + over(RR).jacobian().zero()": "Unsupported operand",
    "J.log(D, over(QQ).jacobian().zero())": "incompatible type",
    "C.lift_x(object())": "No overload",
    "C.change_ring('QQ')": "incompatible type",
    "HyperellipticCurve([1, 0, 0, 1], QQ)": "incompatible type",
    "J.random('seed')": "No overload",
    "D.u[0].denominatr": "denominatr",
    "D.degre": "degre",
    "GF(7).inw(3)": "inw",
    "C.field.coerc(3)": "coerc",
    "ball.field.coerc(3)": "coerc",
    "QQ.add('1', QQ.one)": "incompatible type",
    "C.lift_x(0).yy": "yy",
    "many.w": '"w"',
    "ball.flow(state).att([1])": "att",
    "run.gama": "gama",
    "tilde.flow(start).at([1]).gama": "gama",
    "tilde.motion_through(start).att([1])": "att",
    "tilde.over(MP(30)).integral": "integral",
    "(2 * tilde.translation([1, None])).mulitple": "mulitple",
    "ball.flow(state).at([1], strikt=False)": "strikt",
    "load_scene('chaplygin').tittle": "tittle",
    "integrable.ChaplyginBal": "ChaplyginBal",
}
SCRIPT = """
from random import Random

import integrable
import numpy as np
from integrable import ChaplyginBall, EulerTop, Gyroscopic, RigidBody, Tilde, load_scene
from integrable.classical.neumann import Neumann
from jacobian import CC, GF, MP, QQ, RR, Divisor, Field, HyperellipticCurve
from jacobian.batch import DivisorArray

C = HyperellipticCurve(GF(101), [1, 0, 0, 0, 0, 1])
J = C.jacobian()
D = J.from_points([(0, 1)])
many = DivisorArray.stack([D, D + D])


def over[E](K: Field[E]) -> HyperellipticCurve[E]:
    return HyperellipticCurve(K, [1, 0, 0, 0, 0, 1])


def sum_of[E](*divisors: Divisor[E]) -> Divisor[E]:
    return divisors[0].jacobian.zero() + divisors[-1]


def without_types(D: Divisor, E: Divisor[int]) -> Divisor:
    return D + E


ball = ChaplyginBall(inertia=(1, 2, 3), d=0.7)
exact = ChaplyginBall((1, 2, 3), '1/2', field=QQ)
state = ball.state(gamma=(0.48, 0.6, 0.64), M=(0.384, 1.28, -1.488))
run = ball.flow(state).at([0, 1])
tilde = Tilde((1, 2, 4), 0.7)
start = tilde.state(gamma=(0.48, 0.6, 0.64), M=(0.384, 1.28, -1.488))
"""


# the files with the names that users call, by folder
PUBLIC = {
    "jacobian": "group poly",
    "jacobian/batch": "array",
    "jacobian/curve": "curve points questions",
    "jacobian/fields": "__init__ finite machine protocol rational",
    "jacobian/finite": "group",
    "jacobian/law": "divisor",
    "integrable/classical": "ellipsoid garnier henon_heiles kdv kowalevski lagrange neumann spherical_pendulum toda "
    "two_gaps veselova",
    "integrable/deformations": "deformation gyroscopic isometric tilde",
    "integrable/ensembles": "ensemble",
    "integrable/files": "exported",
    "integrable/laboratory": "bodies motion",
    "integrable/motion": "flow trajectory",
    "integrable/mumford": "flow system",
    "integrable/phase": "space",
    "integrable/portrait": "diagram portrait",
    "integrable/problems": "catalogue",
    "integrable/scene": "file",
    "integrable/study": "run",
    "integrable/sweeps": "sweep",
    "integrable/systems": "chaplygin_ball euler_top system",
}
# arguments that other rooms or packages made, or that are read whatever they are
ANYTHING = {
    "random.K", "check_scalars.scalars", "DivisorArray.__init__.rows", "DivisorArray.from_arrays.u",
    "DivisorArray.from_arrays.v", "DivisorArray.from_arrays.n", "DivisorArray.__getitem__.key", "check_moving.h2",
    "Motion.__init__.system", "Trajectory.__init__.flow",
    "Trajectory.__getitem__.which", "uhlenbeck.a", "uhlenbeck.first",
    "all_of.N", "all_of.spectral", "MumfordFlow.__init__.system", "long_digits.K", "element.K", "element.x",
    "LaboratoryMotion.__init__.body", "LaboratoryMotion.__init__.contact", "LaboratoryRun.__getitem__.which",
}  # fmt: skip


def any_arguments(body: list[ast.stmt], owner: str = "") -> set[str]:
    """The arguments of public functions whose annotation has Any in it."""
    found = set()
    for node in body:
        if isinstance(node, ast.ClassDef) and not node.name.startswith("_"):
            found |= any_arguments(node.body, f"{node.name}.")
        if isinstance(node, ast.FunctionDef) and (node.name.startswith("__") or not node.name.startswith("_")):
            given = [*node.args.posonlyargs, *node.args.args, *node.args.kwonlyargs]
            said = {a.arg: ast.unparse(a.annotation) for a in given if a.annotation}
            found |= {f"{owner}{node.name}.{name}" for name, kind in said.items() if re.search(r"\bAny\b", kind)}
    return found


def test_public_functions_say_what_they_take():
    paths = [ROOT / folder / f"{name}.py" for folder, names in PUBLIC.items() for name in names.split()]
    found = set().union(*(any_arguments(ast.parse(path.read_text(encoding="utf-8")).body) for path in paths))
    assert found <= ANYTHING, sorted(found - ANYTHING)


@pytest.mark.slow
def test_what_mypy_knows_of_a_script(tmp_path):
    script = tmp_path / "script.py"
    lines = [*(f"reveal_type({text})" for text in KNOWN), *WRONG]
    script.write_text(SCRIPT + "\n".join(lines) + "\n", encoding="utf-8")
    command = [sys.executable, "-m", "mypy", "--strict", "--follow-imports=silent", "--config-file="]
    # the script writes type parameters as Python does from 3.12 on
    command += ["--python-version", "3.12"]
    command += ["--ignore-missing-imports", "--cache-dir", str(tmp_path / "cache"), str(script)]
    said = subprocess.run(command, capture_output=True, text=True, cwd=ROOT, timeout=600).stdout
    first = SCRIPT.count("\n") + 1
    answers: dict[int, str] = {}
    for line, text in re.findall(r"^.*script\.py:(\d+): (.*)$", said, re.MULTILINE):
        answers[int(line) - first] = answers.get(int(line) - first, "") + text
    # mypy has no complaint about the script itself
    assert min(answers) >= 0, said
    for i, (text, kind) in enumerate(KNOWN.items()):
        found = re.sub(r"\b(?:[a-z_]\w*\.)+(?=[A-Za-z])", "", answers[i])
        assert found == f'note: Revealed type is "{kind}"', text
    for i, (text, word) in enumerate(WRONG.items(), len(KNOWN)):
        assert "error:" in answers[i], text
        assert word in answers[i], text
