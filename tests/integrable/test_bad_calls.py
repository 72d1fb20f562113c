"""Wrong arguments of the public calls: the error names the argument, its value and what is accepted."""

import numpy as np
import pytest

from integrable import ChaplyginBall, EulerTop, Gyroscopic, Tilde, ensemble, load_scene, run, sweep
from integrable.classical.neumann import Neumann
from integrable.phase.brackets import image_brackets
from integrable.scene.orbit import orbit
from jacobian import CC, GF, QQ, ArgumentError, FieldError
from jacobian.errors import Infeasible, NotASquare, NotRepresentable
from tests.messages import Raising, assert_says

BALL = ChaplyginBall((1, 2, 3), 0.7)
START = (0.48, 0.6, 0.64), (0.384, 1.28, -1.488)
STATE = BALL.state(*START)
FLOW = BALL.flow(STATE)
TILDE = Tilde((1, 2, 4))
TOP = EulerTop((1, 2, 3))
NAN, INFINITE = float("nan"), float("inf")
PAIR = np.arange(2)

NONE = Raising()
CASES = {
    "γ that is zero": (
        lambda: BALL.state((0, 0, 0), START[1]),
        ArgumentError,
        "gamma = (0.0, 0.0, 0.0) ",
        "a unit vector",
    ),
    "an array for a field": (
        lambda: EulerTop((1, 2, 3), field=np.array([])),
        ArgumentError,
        "field = array([], dtype=float64) ",
        "is not a field",
    ),
    "g without a value": (
        lambda: ChaplyginBall((1, 2, 3), 2, field=GF(7)).state((2, 0, 2), (0, 0, 0)),
        NotASquare,
        "gamma = (2, 0, 2): ",
        "g is infinite",
    ),
    "a folder for a stream": (lambda: FLOW.stream("", 0, 1, 5), ArgumentError, "path = '': ", "a .npy file"),
    "a stream beyond any disk": (
        lambda: FLOW.stream("run.npy", 0, 1, 10**400),
        ArgumentError,
        "count = an int of 1329 bits: so many states do not fit, the disk has room for ",
        "of 56 bytes",
    ),
    "a stream of 2⁶³ states": (
        lambda: FLOW.stream("run.npy", 0, 1, 2**63),
        ArgumentError,
        "count = 92233",
        "do not fit",
    ),
    "a name that no file has": (
        lambda: FLOW.stream("\ud800", 0, 1, 5),
        ArgumentError,
        "path = '\\ud800': ",
        "a .npy file",
    ),
    "an enclosure far away": (lambda: FLOW.enclosure(-(10**30)), ArgumentError, "times: ", "enclosure_at_tau"),
    "an enclosure beyond floats": (
        lambda: TOP.flow(TOP.state(*START)).enclosure_at_tau(1e308),
        ArgumentError,
        "tau = 1e+308: ",
        "a nearer time",
    ),
    "digits beyond a memory": (lambda: FLOW.enclosure(1, digits=10**30), ArgumentError, "digits = 1000", "an int"),
    "a search without an end": (
        lambda: FLOW.events(lambda gamma, M: gamma[:, 0], 0, 10**9),
        Infeasible,
        "start = 0.0, end = 1000000000.0: ",
        "part by part",
    ),
    "moments that raise": (lambda: EulerTop(NONE), ArgumentError, "inertia = <raising>: ", "three numbers"),
    "moments without an end": (lambda: EulerTop(iter(int, 1)), ArgumentError, "inertia: more than", "three numbers"),
    "coordinates that raise": (
        lambda: BALL.from_separated(NONE, (1, 2)),
        ArgumentError,
        "u = <raising>: ",
        "two numbers",
    ),
    "points that raise": (lambda: BALL.translation(NONE), ArgumentError, "points = <raising>: ", "abscissas"),
    "signs that raise": (lambda: BALL.keyless(signs=NONE), ArgumentError, "signs = <raising>: ", "3 signs"),
    "signs in a matrix": (lambda: BALL.keyless(signs=np.ones((3, 2))), ArgumentError, "signs = [array(", "3 signs"),
    "times that raise": (lambda: FLOW.at(NONE), ArgumentError, "times = <raising>: ", "a sequence of numbers"),
    "τ that raises": (
        lambda: TILDE.flow(STATE).at_tau(NONE),
        ArgumentError,
        "tau = <raising>: ",
        "a sequence of numbers",
    ),
    "counts that raise": (lambda: FLOW.residual_growth(NONE), ArgumentError, "counts = <raising>: ", "ints ≥ 0"),
    "a factor that raises": (lambda: BALL.multiplication(NONE), ArgumentError, "factor = <raising>: ", "an int"),
    "an even factor over the reals": (lambda: TOP.multiplication(-4), NotASquare, "factor = -4: ", "even factor"),
    "a factor at equal moments": (
        lambda: EulerTop((1, 1, 2)).multiplication(3),
        NotRepresentable,
        "factor = 3: ",
        "moments of inertia are equal",
    ),
    "a point and its opposite": (
        lambda: BALL.translation([1.8, 1.8], sheets=(1, -1)),
        ArgumentError,
        "points = (1.8, 1.8): ",
        "add up to zero",
    ),
    "twice the branch point 1/d": (
        lambda: BALL.translation([1 / 0.7, 1 / 0.7]),
        ArgumentError,
        "points = (1.42857",
        "add up to zero",
    ),
    "an infinite pair": (
        lambda: BALL.translation([complex(1, INFINITE), complex(1, -INFINITE)]),
        ArgumentError,
        "points = [(1+infj), (1-infj)]: ",
        "a conjugate pair (z, z̄) of finite numbers",
    ),
    "an infinite real part": (
        lambda: BALL.translation([complex(INFINITE, 1), complex(INFINITE, -1)]),
        FieldError,
        "points[0].real = inf ",
        "finite",
    ),
    "a fraction of a step on two curves": (
        lambda: 1.5 * TILDE.translation((30, -30)),
        ArgumentError,
        "multiple = 1.5: ",
        "an int",
    ),
    "1/d as a point of a curve": (
        lambda: Tilde((1, 2, 4), 0.1).translation((10.0, None)),
        ArgumentError,
        "points = (10.0, None): ",
        "give None",
    ),
    "a neighbour of 1/d as a point of a curve": (
        lambda: Tilde((1, 2, 4), 0.0024982512241431).translation((400.28000000000003, None)),
        ArgumentError,
        "points = (400.28000000000003, None): ",
        "give None",
    ),
    "no point on two curves": (lambda: TILDE.translation(7.0), ArgumentError, "points = 7.0: ", "two abscissas"),
    "a multiple that raises": (
        lambda: BALL.keyless() and BALL.torsion() * NONE,
        ArgumentError,
        "multiple = <raising>: ",
        "an int",
    ),
    "tilted as an array": (
        lambda: BALL.state(*START, tilted=PAIR),
        ArgumentError,
        "tilted = array([0, 1]): ",
        "True or False",
    ),
    "a sign as an array": (lambda: TOP.conic(2, 3, sign=PAIR), ArgumentError, "sign = array([0, 1]): ", "1 or -1"),
    "a kernel as an array": (lambda: BALL.flow(STATE, PAIR), ArgumentError, "kernel = array([0, 1]): ", "'compiled'"),
    "a direction as an array": (
        lambda: FLOW.events(lambda gamma, M: gamma[:, 0], 0, 1, PAIR),
        ArgumentError,
        "direction = array([0, 1]): ",
        "rising",
    ),
    "H2 as an array": (lambda: BALL.curve(2, PAIR), FieldError, "h2 = array([0, 1]) ", "a real number"),
    "signs of no state": (
        lambda: BALL.from_separated((0.4, 0.6), (1, 2), like=3),
        ArgumentError,
        "state = 3: ",
        "ChaplyginBall.state",
    ),
    "a plain step of no state": (lambda: BALL.keyless().plain(3), ArgumentError, "state = 3: ", "ChaplyginBall.state"),
    "a plain addition of no state": (
        lambda: BALL.torsion().plain(3),
        ArgumentError,
        "state = 3: ",
        "ChaplyginBall.state",
    ),
    "a state of floats in a finite field": (
        lambda: ChaplyginBall((1, 2, 3), 5, field=GF(10007)).upright(STATE),
        FieldError,
        "state = State(",
        "not of GF(10007)",
    ),
    "a complex body": (lambda: EulerTop((1, 2, 3), field=CC), FieldError, "field = CC: ", "not complex"),
    "an orbit without an end": (
        lambda: orbit(BALL.keyless(), STATE, 10**9),
        ArgumentError,
        "count = 1000000000: ",
        "at most",
    ),
    "additions without an end": (
        lambda: FLOW.residual_growth([10**9]),
        ArgumentError,
        "counts = [1000000000]: ",
        "at most",
    ),
    "a state in a matrix": (
        lambda: TOP.divisor(np.ones((2, 2))),
        ArgumentError,
        "state = array([[1., 1.], [1., 1.]]): ",
        "State",
    ),
    "a field that is none": (lambda: ChaplyginBall((1, 2, 3), 1, field=3), ArgumentError, "field = 3 ", "give GF(p)"),
    "a radius over no field": (
        lambda: ChaplyginBall((1, 2, 3), mass=1, radius=2, field=3),
        ArgumentError,
        "field = 3 ",
        "give GF(p)",
    ),
    "a radius over complex numbers": (
        lambda: ChaplyginBall((1, 2, 3), 1, radius=2, field=CC),
        FieldError,
        "field = CC: ",
        "not complex",
    ),
    "the name of a field": (lambda: EulerTop((1, 2, 3), field="RR"), ArgumentError, "field = 'RR' ", "give GF(p)"),
    "a deformation over no field": (lambda: Tilde((1, 2, 4), field=7), ArgumentError, "field = 7 ", "give GF(p)"),
    "d of another field": (lambda: ChaplyginBall((1, 2, 3), 0.7, field=GF(7)), FieldError, "d = 0.7 ", "give an int"),
    "NaN as a moment": (lambda: EulerTop((1, 2, NAN)), FieldError, "inertia[2] = nan ", "finite"),
    "integrals of no state": (lambda: BALL.integrals(3), ArgumentError, "state = 3: ", "ChaplyginBall.state"),
    "ω of no state": (lambda: BALL.omega(START), ArgumentError, "state = (", "ChaplyginBall.state"),
    "motion of no state": (lambda: BALL.vector_field(None), ArgumentError, "state = None: ", "ChaplyginBall.state"),
    "brackets of no state": (lambda: BALL.poisson("x"), ArgumentError, "state = 'x': ", "ChaplyginBall.state"),
    "the body of no state": (lambda: BALL.upright(1), ArgumentError, "state = 1: ", "ChaplyginBall.state"),
    "a deformation's integrals": (lambda: TILDE.integrals(3), ArgumentError, "state = 3: ", "Tilde.state"),
    "a deformation's motion": (lambda: TILDE.vector_field(3), ArgumentError, "state = 3: ", "Tilde.state"),
    "a deformation's flow": (lambda: TILDE.flow(3), ArgumentError, "state = 3: ", "Tilde.state"),
    "a motion through no state": (
        lambda: Gyroscopic((1, 2, 4), 1).motion_through(3),
        ArgumentError,
        "state = 3: ",
        "Gyroscopic.state",
    ),
    "a deformation's step": (lambda: TILDE.translation((30, -30))(3), ArgumentError, "state = 3: ", "Tilde.state"),
    "divisors of a step": (
        lambda: TILDE.translation((30, -30)).divisor(3),
        ArgumentError,
        "state = 3: ",
        "Tilde.state",
    ),
    "tilted as a number": (lambda: BALL.state(*START, tilted=3), ArgumentError, "tilted = 3: ", "True or False"),
    "no divisor": (lambda: BALL.from_divisor(3, like=STATE), ArgumentError, "D = 3: ", "a Divisor"),
    "one coordinate": (lambda: BALL.from_separated((1,), (1, 2)), ArgumentError, "u = (1,): ", "two numbers"),
    "no coordinates": (lambda: BALL.from_separated((1, 2), None), ArgumentError, "p = None: ", "two numbers"),
    "coordinates in letters": (lambda: BALL.from_separated((1, 2), "ab"), ArgumentError, "p = 'ab': ", "two numbers"),
    "no Hamiltonian": (lambda: BALL.shift(3), ArgumentError, "F = 3: ", "function of H1 and H2"),
    "a time in letters": (lambda: FLOW.at(["one"]), FieldError, "times[0] = 'one' ", "a real number"),
    "NaN as a time": (lambda: FLOW.at([0, NAN]), FieldError, "times[1] = nan ", "finite"),
    "times that are none": (lambda: TILDE.flow(STATE).at(None), FieldError, "times[0] = None ", "a real number"),
    "τ that is none": (lambda: TILDE.flow(STATE).at_tau(None), FieldError, "tau[0] = None ", "a real number"),
    "times of no motion": (
        lambda: Tilde((1, 2, 4), potential=(1, 0, 0, 0, 0)).motion_through(STATE).at(None),
        FieldError,
        "times[0] = None ",
        "a real number",
    ),
    "no two points": (lambda: TILDE.from_divisor(3, like=STATE), ArgumentError, "D = 3: ", "TwoPoints"),
    "signs that are none": (lambda: BALL.keyless(signs=3), ArgumentError, "signs = 3: ", "3 signs"),
    "sheets that are none": (lambda: BALL.translation([1.8, 2.5], sheets=3), ArgumentError, "sheets = 3: ", "2 signs"),
    "sheets of two curves": (lambda: TILDE.translation((1, 2), sheets=3), ArgumentError, "sheets = 3: ", "2 signs"),
    "a negative mass": (
        lambda: ChaplyginBall((1, 2, 2.5), mass=-1, radius=1),
        ArgumentError,
        "mass = -1.0 is negative: ",
        "mass ≥ 0",
    ),
    "a negative radius": (
        lambda: ChaplyginBall((1, 2, 2.5), d=1, radius=-1),
        ArgumentError,
        "radius = -1.0 is negative: ",
        "radius ≥ 0",
    ),
    "counts that are none": (lambda: FLOW.residual_growth(5), ArgumentError, "counts = 5: ", "ints ≥ 0"),
    "counts below zero": (lambda: FLOW.residual_growth([1, -3]), ArgumentError, "counts = [1, -3]: ", "ints ≥ 0"),
    "an orbit's count": (lambda: orbit(BALL.keyless(), STATE, -1), ArgumentError, "count = -1: ", "an int ≥ 0"),
    "a count in letters": (
        lambda: orbit(BALL.keyless(), STATE, "x"),
        ArgumentError,
        "count = 'x': ",
        "an int",
    ),
    "an orbit of no step": (lambda: orbit(3, STATE, 1), ArgumentError, "step = 3: ", "a Step"),
    "brackets at no state": (
        lambda: image_brackets(BALL, BALL.keyless(), 3),
        ArgumentError,
        "state = 3: ",
        "ChaplyginBall.state",
    ),
    "brackets of no step": (lambda: image_brackets(BALL, 3, STATE), ArgumentError, "step = 3: ", "a function"),
    "a folder for results": (lambda: run("chaplygin", out=3), ArgumentError, "out = 3: ", "a folder"),
    "a path that is none": (lambda: FLOW.stream(3, 0, 1, 5), ArgumentError, "path = 3: ", "a .npy file"),
    "a folder that is none": (
        lambda: FLOW.stream("/no such folder/run.npy", 0, 1, 5),
        ArgumentError,
        "path = '/no such folder/run.npy': ",
        "a folder that exists",
    ),
    "a chunk of no member": (
        lambda: sweep(ensemble(TOP, *START), times=[0, 1], out="a.h5", chunk=-(10**5000)),
        ArgumentError,
        "chunk = an int of 16610 bits: ",
        "an int ≥ 1",
    ),
    "an ensemble of fractions": (
        lambda: ensemble(EulerTop((10**5000, 2, 3), field=QQ), *START),
        ArgumentError,
        "system = EulerTop(inertia=(0x",
        "an ensemble is of floats",
    ),
    "no name of a scene": (lambda: load_scene(3), ArgumentError, "name_or_path = 3: ", "the path of a .toml file"),
    "no scene": (lambda: run(None), ArgumentError, "scene = None: ", "the path of a .toml file"),
    "digits in letters": (lambda: load_scene("chaplygin").start("x"), ArgumentError, "digits = 'x': ", "an int ≥ 1"),
    "digits below one": (lambda: load_scene("chaplygin").start(-1), ArgumentError, "digits = -1: ", "an int ≥ 1"),
    "no state": (lambda: Neumann((1, 2, 4)).flow(None), ArgumentError, "state = None: ", "state(q, p)"),
}


@pytest.mark.parametrize("case", CASES)
def test_the_message_says_what_and_why(case):
    assert_says(*CASES[case])
