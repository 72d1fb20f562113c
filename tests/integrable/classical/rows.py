"""The systems of ``integrable.classical`` as rows of a table that the tests run over, and an integrator."""

from __future__ import annotations

from random import Random

import pytest

from integrable.classical.ellipsoid import Ellipsoid
from integrable.classical.garnier import Garnier
from integrable.classical.henon_heiles import HenonHeiles
from integrable.classical.kowalevski import KowalevskiTop
from integrable.classical.kuzmin_kutuzov import KuzminKutuzov
from integrable.classical.lagrange import LagrangeTop
from integrable.classical.neumann import Neumann
from integrable.classical.spherical_pendulum import SphericalPendulum
from integrable.classical.toda import TodaLattice
from integrable.classical.two_gaps import TwoGaps
from integrable.classical.veselova import Veselova
from integrable.mumford.flow import Point, element
from integrable.systems.on_layer import BodyOnLayer
from jacobian.inexact.long_field import LongField
from tests.integrable.exact_points import attempt
from tests.integrable.ways import constrained


def different(K, rng, count):
    while True:
        found = [K.random(rng) for _ in range(count)]
        if len({K.key(x) for x in found} | {K.key(K.zero)}) == count + 1:
            return found


def on_sphere(K, rng, size):
    """A random point with Σq² = 1, whose last coordinate is a square root, and a random tangent there."""
    q = [K.random(rng) for _ in range(size - 1)]
    q.append(K.sqrt(K.sub(K.one, K.dot(q, q))))
    p = [K.random(rng) for _ in range(size)]
    along = K.dot(q, p)
    return q, [K.sub(y, K.mul(along, x)) for x, y in zip(q, p, strict=True)]


def exact_neumann(K, rng, n):
    system = Neumann(different(K, rng, n + 1), K)
    return system, attempt(lambda: system.state(*on_sphere(K, rng, n + 1)))


def exact_pendulum(K, rng, n):
    system = SphericalPendulum(K)
    return system, attempt(lambda: system.state(*on_sphere(K, rng, n)))


def exact_lagrange(K, rng, n):
    system = LagrangeTop(K.random(rng), K)
    return system, attempt(lambda: system.state(on_sphere(K, rng, n)[0], [K.random(rng) for _ in range(n)]))


def exact_kowalevski(K, rng, n):
    system = KowalevskiTop(K)
    return system, attempt(lambda: system.state(on_sphere(K, rng, n)[0], different(K, rng, n)))


def exact_two_gaps(K, rng, n):
    """A curve of any kind of genus 2."""
    system = TwoGaps([K.random(rng) for _ in range(3)], K)
    return system, system.state(*([K.random(rng) for _ in range(2)] for _ in range(2)))


def exact_toda(K, rng, n):
    system = TodaLattice(n, K)
    return system, system.state(different(K, rng, n), [K.random(rng) for _ in range(n)])


def exact_ellipsoid(K, rng, n):
    """A random ellipsoid and a point on it, whose last coordinate is a square root, with a tangent there."""

    def make():
        a = different(K, rng, n + 1)
        q = [K.random(rng) for _ in range(n)]
        rest = K.sub(K.one, K.dot([K.div(x, e) for x, e in zip(q, a, strict=False)], q))
        q.append(K.sqrt(K.mul(a[n], rest)))
        normal = [K.div(x, e) for x, e in zip(q, a, strict=True)]
        p = [K.random(rng) for _ in range(n + 1)]
        along = K.div(K.dot(normal, p), K.dot(normal, normal))
        system = Ellipsoid(a, K)
        return system, system.state(q, [K.sub(y, K.mul(along, x)) for x, y in zip(normal, p, strict=True)])

    return attempt(make)


def exact_galaxy(K, rng, n):
    """A random galaxy, and a random star where P and S are in the field."""

    def found():
        system = KuzminKutuzov(different(K, rng, 2), K.random(rng), K)
        state = system.state(different(K, rng, n), different(K, rng, n))
        system.divisor(state)
        return system, state

    return attempt(found)


def exact_garnier(K, rng, n):
    system = Garnier(different(K, rng, n), *different(K, rng, 2), field=K)
    return system, system.state(different(K, rng, n), [K.random(rng) for _ in range(n)])


def exact_henon_heiles(K, rng, n, barriers=None):
    alpha, beta, gamma = different(K, rng, 3)
    system = HenonHeiles(different(K, rng, n), alpha, beta, gamma, barriers, K)
    return system, system.state(different(K, rng, n + 1), [K.random(rng) for _ in range(n + 1)])


def exact_barriers(K, rng, n):
    """Barriers on all axes but the first."""
    return exact_henon_heiles(K, rng, n, [K.zero, *different(K, rng, n - 1)])


def exact_body(make):
    """A body with three random moments, and a random state at which s has a square root."""

    def case(K, rng, n):
        def found():
            system = make(K, rng, different(K, rng, n))
            state = system.state(*on_sphere(K, rng, n))
            system.divisor(state)
            return system, state

        return attempt(found)

    return case


def garnier(K, n):
    system = Garnier([i * i for i in range(n)], "1/2", "-1/4", K)
    rng = Random(n)
    q, p = ([K.coerce(rng.randint(-9, 9)) / 8 for _ in range(n)] for _ in range(2))
    return system, system.state(q, p)


def henon_heiles(K, n, barriers=None):
    """A small, bounded motion."""
    system = HenonHeiles([i * i + 1 for i in range(n)], "-1/2", "-1/4", 0, barriers, K)
    rng = Random(n)
    q, p = ([K.coerce(rng.randint(-9, 9) or 1) / 128 for _ in range(n + 1)] for _ in range(2))
    return system, system.state(q, p)


def barriers(K, n):
    return henon_heiles(K, n, [0, *["1/512"] * (n - 1)])


def lagrange(K, n):
    system = LagrangeTop("3/4", K)
    return system, system.state(("12/25", "3/5", "16/25"), ("1/4", "-3/8", "9/8"))


def pendulum(K, n):
    system = SphericalPendulum(K)
    return system, system.state(("12/25", "3/5", "-16/25"), ("3/4", "-3/5", 0))


def body(make):
    """A body in motion with numbers of ordinary size."""

    def case(K, n):
        system = make(K)
        gamma, M = ((K.coerce(x) for x in row) for row in (("12/25", "3/5", "16/25"), ("48/125", "32/25", "-186/125")))
        return system, system.state(gamma, M)

    return case


def ellipsoid(K, n):
    system = Ellipsoid([i * i + 2 for i in range(n + 1)], K)
    rng = Random(n)
    q, p = ([K.coerce(rng.randint(-9, 9) or 1) for _ in range(n + 1)] for _ in range(2))
    start = constrained(system, Point(tuple(q), tuple(p)), K)
    speed = K.sqrt(K.dot(start.p, start.p))
    return system, system.state(start.q, [y / speed for y in start.p])


def galaxy(K, n):
    system = KuzminKutuzov(("3/2", 1), 1, K)
    return system, system.state(("11/10", 0, "1/5"), ("1/10", "2/5", "7/20"))


def neumann(K, n):
    system = Neumann([i * i + 1 for i in range(n + 1)], K)
    rng = Random(n)
    q, p = ([K.coerce(rng.randint(-9, 9) or 1) for _ in range(n + 1)] for _ in range(2))
    size = K.sqrt(K.dot(q, q))
    q = [x / size for x in q]
    along = K.dot(q, p)
    return system, system.state(q, [(y - along * x) / 5 for x, y in zip(q, p, strict=True)])


def two_gaps(K, n):
    """The edges are near −1/8, −1/16, 0, 1/16 and 1/8, so that the motion changes within about a unit of time."""
    system = TwoGaps((0, "-5/256", 0), K)
    return system, system.state(("-7/32", "9/128"), ("1/128", "1/256"))


def toda(K, n):
    rng = Random(n)
    q, p = ([K.coerce(rng.randint(-9, 9)) / 8 for _ in range(n)] for _ in range(2))
    return TodaLattice(n, K), TodaLattice(n, K).state(q, p)


EXACT = {
    "ball": exact_body(lambda K, rng, moments: BodyOnLayer(moments, K.random(rng), K)),
    "barriers": exact_barriers,
    "ellipsoid": exact_ellipsoid,
    "galaxy": exact_galaxy,
    "garnier": exact_garnier,
    "henon_heiles": exact_henon_heiles,
    "kowalevski": exact_kowalevski,
    "lagrange": exact_lagrange,
    "neumann": exact_neumann,
    "pendulum": exact_pendulum,
    "toda": exact_toda,
    "top": exact_body(lambda K, rng, moments: BodyOnLayer(moments, 0, K)),
    "two_gaps": exact_two_gaps,
    "veselova": exact_body(lambda K, rng, moments: Veselova(moments, K)),
}
REAL = {
    "ball": body(lambda K: BodyOnLayer((1, 2, 3), "7/10", K)),
    "barriers": barriers,
    "ellipsoid": ellipsoid,
    "galaxy": galaxy,
    "garnier": garnier,
    "henon_heiles": henon_heiles,
    "lagrange": lagrange,
    "neumann": neumann,
    "pendulum": pendulum,
    "toda": toda,
    "top": body(lambda K: BodyOnLayer((1, 2, 3), 0, K)),
    "two_gaps": two_gaps,
    "veselova": body(lambda K: Veselova(("1/2", 2, "3/2"), K)),
}
# (system, size) with genus 1 to 4, both parities of the model and of the genus
CASES = [
    ("ball", 3),
    ("barriers", 2),
    ("ellipsoid", 2),
    ("ellipsoid", 3),
    ("galaxy", 3),
    ("garnier", 1),
    ("garnier", 3),
    ("henon_heiles", 1),
    ("lagrange", 3),
    ("pendulum", 3),
    ("neumann", 1),
    ("neumann", 2),
    ("neumann", 3),
    ("toda", 2),
    ("toda", 3),
    ("toda", 4),
    ("toda", 5),
    ("top", 3),
    ("two_gaps", 2),
    ("veselova", 3),
]
# every day one case of a system and genus: the others take the same paths
OTHERS = (("ellipsoid", 3), ("neumann", 2), ("toda", 2), ("toda", 5))
over_cases = pytest.mark.parametrize(
    ("name", "n"), [pytest.param(*case, marks=pytest.mark.slow if case in OTHERS else ()) for case in CASES]
)
# includes systems without the inverse map from divisors
over_formulas = pytest.mark.parametrize(("name", "n"), [*CASES, ("kowalevski", 3)])


def integrated(system, state, time, steps, order=20):
    """q and p of a system over MP at a time, by its vector field only."""
    K, size = system.field, len(state.q)

    def point(z):
        return Point(tuple(z[:size]), tuple(z[size:]))

    with LongField(K.context.prec + 8) as L:

        def rate(z):
            found = system._vector_field(L, point(z))
            return [*found.q, *found.p]

        def constrained(z):
            # off the constraints, which rounding violates, the equations of motion on spheres are unstable
            found = system._constrained(L, point(z))
            return [*found.q, *found.p]

        start = [L.coerce(x) for x in (*state.q, *state.p)]
        z = extrapolated(L, rate, start, L.coerce(time), steps, order, constrained)
    z = [element(K, x) for x in z]
    return z[:size], z[size:]


def extrapolated(K, rate, z, time, steps, order, constrained=lambda z: z):
    """z at a time, z' = rate(z), by Gragg's method, extrapolated (Bulirsch & Stoer 1966)."""
    step = time / steps
    for _ in range(steps):
        last: list = []
        first = rate(z)
        for j in range(1, order + 1):
            count = 2 * j
            h = step / count
            a, b = z, [x + h * y for x, y in zip(z, first, strict=True)]
            for _ in range(count - 1):
                a, b = b, [x + 2 * h * y for x, y in zip(a, rate(b), strict=True)]
            row = [[(x + y + h * w) / 2 for x, y, w in zip(a, b, rate(b), strict=True)]]
            for m in range(1, j):
                factor = (K.one * j / (j - m)) ** 2 - 1
                row.append([p + (p - o) / factor for p, o in zip(row[m - 1], last[m - 1], strict=True)])
            last = row
        z = constrained(last[-1])
    return z


def distance(K, found, expected):
    pairs = [pair for a, b in zip(found, expected, strict=True) for pair in zip(a, b, strict=True)]
    return max(abs(K.coerce(x) - K.coerce(y)) for x, y in pairs)
