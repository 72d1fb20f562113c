"""The ingredients of bad calls: wrong values, right values, callables, operators, all as lines of Python."""

from __future__ import annotations


def listed(text: str) -> tuple[str, ...]:
    """The parts of a text between bars and line ends."""
    return tuple(part.strip() for line in text.strip().splitlines() for part in line.split("¦"))


ZOO = listed(r"""
None ¦ float('nan') ¦ float('inf') ¦ -float('inf') ¦ 0 ¦ -1 ¦ 1 ¦ 2 ¦ 3 ¦ 2.5 ¦ -0.0 ¦ 1e308 ¦ -1e308 ¦ 1e-320
10**9 ¦ -10**9 ¦ 10**30 ¦ -10**30 ¦ 10**400 ¦ 10**5000 ¦ -(10**5000)
True ¦ False ¦ '' ¦ 'x' ¦ '1/3' ¦ '1e5' ¦ 'nan' ¦ 'chaplygin'
'\ud800' ¦ b'ab' ¦ bytearray(b'a') ¦ [] ¦ () ¦ {} ¦ set() ¦ {1: 2} ¦ [1] ¦ [0, 1] ¦ (0, 1) ¦ (0, 1, 2)
[1, 2, 3, 4] ¦ [None] ¦ [float('nan'), 0, 1] ¦ [float('inf')] ¦ [[1, 2], [3]] ¦ [[1, 2], [3, 4]] ¦ ['a', 'b', 'c']
[(0, 1)] ¦ [(0, 1), (0, 1)] ¦ [(0, 100)] ¦ [1j, 2, 3] ¦ range(3) ¦ (x for x in (1, 2, 3)) ¦ iter(()) ¦ np.array(1.5)
np.array([]) ¦ np.ones((2, 2)) ¦ np.array([1.0, np.nan]) ¦ np.array([1, 'a'], object) ¦ np.arange(3) ¦ np.int64(3)
np.float64(0.5) ¦ np.bool_(True) ¦ np.uint64(2**63) ¦ 1j ¦ complex('nan') ¦ Decimal('0.5') ¦ Decimal('NaN')
Decimal('Infinity') ¦ Fraction(1, 3) ¦ object() ¦ int ¦ lambda *a: a ¦ lambda *a: None ¦ NoIter() ¦ NoFloat()
NoIndex() ¦ D ¦ other ¦ B ¦ C ¦ F ¦ Q ¦ J ¦ H ¦ L ¦ A ¦ N ¦ r ¦ state ¦ ball ¦ tilde ¦ flow ¦ motion ¦ step
GF(101) ¦ GF(7, 2) ¦ QQ ¦ RR ¦ CC ¦ MP(20) ¦ MP(20).one ¦ C.points_at_infinity()[0] ¦ F.points_at_infinity()
memoryview(b'abc') ¦ Ellipsis ¦ slice(3) ¦ [D, other] ¦ [D, 1] ¦ (1, 2, 10**400) ¦ (1e308, 1e308, 1e308)
-10**5000 ¦ 2**63 ¦ (1e-320, 0, 0) ¦ (0, 0, 0) ¦ (1, 0, 0) ¦ (0, 0, 1) ¦ (-1, 0, 0)
""")
HOSTILE = """
class NoIter:
    def __iter__(self):
        raise RuntimeError("no iteration")
class NoFloat:
    def __float__(self):
        raise RuntimeError("no float")
class NoIndex:
    def __index__(self):
        raise RuntimeError("no index")
"""
# a right value of each argument; "callable.argument" or "object.argument" where the name alone does not tell
GOOD = dict(
    line.split(": ", 1)
    for line in listed("""
point: (0, 1) ¦ x: 0 ¦ y: 1 ¦ all: True ¦ bound: 3 ¦ rng: Random(1) ¦ D: D ¦ E: E ¦ scalars: [2, 3]
divisors: [D, E] ¦ primes: [2, 3, 5] ¦ window: 4 ¦ power: 1 ¦ u: D.u ¦ v: D.v ¦ n: None ¦ points: [(0, 1)]
multiplicities: [2] ¦ extension: None ¦ m: 5 ¦ base: D ¦ target: D ¦ options: None ¦ multiple: None ¦ J: J
parts: [D, E] ¦ count: 2 ¦ check: True ¦ a: 1 ¦ b: 1 ¦ c: (1, 1) ¦ d: (2, 1) ¦ t: 3 ¦ y0: 3 ¦ x0: 2 ¦ z: [0.1, 0.2]
unit: (1, 1) ¦ sign: 1 ¦ h1: 2 ¦ h2: 4 ¦ state: state ¦ kernel: 'auto' ¦ like: state ¦ p: (1, 2) ¦ signs: (1, 1, 1)
factor: 3 ¦ F: lambda h1, h2: h1 / 2 ¦ gamma: (0.48, 0.6, 0.64) ¦ M: (0.384, 1.28, -1.488) ¦ g: None ¦ tilted: False
sheets: (1, -1) ¦ times: [0, 1.5] ¦ tau: [0, 1.5] ¦ digits: 10 ¦ condition: lambda gamma, M: gamma[:, 2] ¦ start: 0
end: 3 ¦ direction: 0 ¦ counts: [1, 5] ¦ field: RR ¦ K: GF(101) ¦ f: [1, 0, 0, 0, 0, 1] ¦ h: ()
infinity_plus: None ¦ k: 2 ¦ modulus: None ¦ dps: 20 ¦ complex: False ¦ inertia: (1, 2, 3) ¦ mass: None
radius: None ¦ potential: None ¦ curve: C ¦ roots: None ¦ jacobian: J ¦ value: 3 ¦ argument: 'value' ¦ order: None
interval: None ¦ primes_: None ¦ path: 'no such folder/run.npy' ¦ number: 1 ¦ R.C: r ¦ R.add.D: r ¦ G.D: g ¦ G.E: g
L.D: B ¦ L.E: B ¦ G.u: g.u ¦ G.v: g.v ¦ L.u: B.u ¦ L.v: B.v ¦ R.from_mumford.u: (1, 1) ¦ R.from_mumford.v: ()
ball.from_separated.u: (0.4, 0.6) ¦ ball.translation.points: [1.8, 2.5] ¦ tilde.translation.points: [30, -30]
ball.points: [1.8, 2.5] ¦ translation.points: [1.8, 2.5] ¦ tilde.D: tilde.divisor(state) ¦ Gyroscopic.c: 0.5
system: ball ¦ ball.D: ball.divisor(state) ¦ Q.x: 0 ¦ step.system: ball ¦ W.c: 3 ¦ C.x: 0 ¦ GF.p: 101 ¦ U.c: (1, 1)
set_threads.count: 2 ¦ body: ball.body ¦ matrix: [[1, 2], [3, 4]]
trace_hamiltonian.point: (1, 2, 3, 4) ¦ recursion_operator.point: (1, 2, 3, 4) ¦ second_bracket.point: (1, 2, 3, 4)
eigenvalues.point: (1, 2, 3, 4) ¦ principal_divisor.a: [1, 1] ¦ principal_divisor.b: [1]
ensemble.d: 0.7 ¦ member: 0 ¦ sweep.what: many ¦ sweep.out: 'run.zarr' ¦ executor: 'threads' ¦ chunk: 2
progress: False ¦ X: 0.5 ¦ zeta: 0.2 ¦ Z: 0.3 ¦ added.multiple: 3
""")
)
# objects whose methods are called
OBJECTS = listed("""
C ¦ Q ¦ J ¦ L ¦ D ¦ B ¦ A ¦ N ¦ R ¦ r ¦ U ¦ G ¦ g ¦ S ¦ T ¦ Z ¦ W ¦ Y ¦ ball ¦ top ¦ exact ¦ flow ¦ spin ¦ tilde ¦ hat
gyro ¦ bent ¦ many ¦ step ¦ keyless ¦ diagram ¦ rolling
""")
# functions and classes that are called themselves
CALLED = listed("""
T ¦ Z ¦ J ¦ R ¦ step ¦ keyless ¦ ball.multiplication(3) ¦ multiplied ¦ added
""")
FACTORIES = listed("""
GF ¦ MP ¦ HyperellipticCurve ¦ ChaplyginBall ¦ EulerTop ¦ Tilde ¦ Check ¦ Hat ¦ Gyroscopic ¦ set_threads
load_scene ¦ run ¦ sweep ¦ RayClassGroup ¦ AbelMap ¦ GeneralizedJacobian ¦ representative ¦ periods ¦ Jacobian
ensemble ¦ AffinePoint ¦ principal_divisor ¦ intersection ¦ FormalSum.zero ¦ FormalSum.from_points
FormalSum.from_divisor ¦ eigenvalues ¦ second_bracket ¦ recursion_operator ¦ trace_hamiltonian ¦ rank
QQ.coerce ¦ RR.coerce ¦ CC.coerce ¦ GF(101).coerce ¦ GF(7, 2).coerce ¦ MP(20).coerce
""")
# methods whose arguments are raw elements or internal numbers by contract
RAW = listed("""
add ¦ class_of ¦ compile ¦ condition ¦ coordinate ¦ curves_of ¦ double ¦ eigenvalue_sums ¦ is_unit ¦ motion ¦ multiply
negate ¦ norm ¦ normal ¦ omega_at ¦ over ¦ pace ¦ pair ¦ potential_energy ¦ rates_at ¦ rates_in ¦ residual ¦ scalars
translated ¦ value ¦ wider
""")
OPERATORS = listed("""
D + {} ¦ {} + D ¦ D - {} ¦ {} - D ¦ D * {} ¦ {} * D ¦ D == {} ¦ A + {} ¦ {} + A ¦ A - {} ¦ {} * A ¦ A * {} ¦ A == {}
A[{}] ¦ r + {} ¦ {} * r ¦ r == {} ¦ C == {} ¦ J == {} ¦ ball == {} ¦ step @ {} ¦ step * {} ¦ {} * step ¦ state == {}
B + {} ¦ {} * B ¦ Y + {} ¦ {} - Y ¦ {} * Y ¦ Y == {} ¦ N[{}] ¦ flow == {} ¦ tilde == {} ¦ hash({}) ¦ J({}) ¦ J({}, {})
""")
# attributes of values, which cannot be set
FIXED = {
    "C": ("f", "h", "genus", "field", "model"),
    "J": ("curve", "field"),
    "A": ("jacobian",),
    "D": ("u", "v", "n", "jacobian"),
    "r": ("divisor", "unit", "group"),
    "state": ("gamma", "M"),
    "W": ("u", "v"),
    "Y": ("u", "v", "weights"),
}
# names that are not exported at the top of a package
IMPORTED = {
    "RayClassGroup": "jacobian.relatives.ray_class",
    "AbelMap": "jacobian.periods.abel",
    "GeneralizedJacobian": "jacobian.relatives.glued",
    "representative": "jacobian.relatives.conic",
    "FormalSum": "jacobian.relatives.formal_sum",
    "principal_divisor": "jacobian.relatives.formal_sum",
    "intersection": "jacobian.relatives.formal_sum",
    "periods": "jacobian.periods.matrix",
    "eigenvalues": "integrable.phase.recursion",
    "second_bracket": "integrable.phase.recursion",
    "recursion_operator": "integrable.phase.recursion",
    "trace_hamiltonian": "integrable.phase.recursion",
    "rank": "integrable.phase.recursion",
}
