"""The table that the tests of the group law run over: field × model at infinity × genus × h, one seeded curve each."""

from dataclasses import dataclass
from functools import cached_property
from random import Random

from jacobian import GF, QQ, ArgumentError, HyperellipticCurve, poly
from jacobian.fields.factor import roots

MERSENNE = 2**61 - 1
FIELDS = {
    "GF(7)": GF(7),
    "GF(101)": GF(101),
    "GF(2^61-1)": GF(MERSENNE),
    "GF(2^8)": GF(2, 8, (1, 0, 1, 1, 1, 0, 0, 0, 1)),
    "GF(3^5)": GF(3, 5, (1, 2, 0, 0, 0, 1)),
    "QQ": QQ,
}
MODELS = ("ramified", "moved", "split", "inert")


@dataclass(frozen=True)
class Row:
    """``model`` "moved" is a ramified model of formal degree 2g+2, added on another equation."""

    field: str
    model: str
    genus: int
    with_h: bool

    def __str__(self):
        return f"{self.field}-{self.model}-g{self.genus}-{'h' if self.with_h else '0'}"

    @property
    def K(self):
        return FIELDS[self.field]

    @cached_property
    def curve(self):
        rng = Random(str(self))
        for _ in range(1000):
            try:
                C = _rational_curve(self, rng) if self.K == QQ else _random_curve(self, rng)
            except ArgumentError:
                continue
            if C.genus == self.genus and C.model == ("ramified" if self.model == "moved" else self.model):
                return C
        raise AssertionError(f"no curve for {self}")

    @cached_property
    def pool(self):
        """Classes of every shape: generic ones, single points, points at infinity, 2-torsion, repeated points, zero."""
        return _pool(self, Random(f"pool {self}"))

    def __reduce__(self):
        return Row, (self.field, self.model, self.genus, self.with_h)


def _rows():
    for name, K in FIELDS.items():
        for genus in range(1, 7):
            for model in MODELS:
                if model == "inert" and genus % 2:
                    continue
                for with_h in (True,) if K.characteristic == 2 else (False, True):
                    # outside characteristic 2, y → y + z x^(g+1) would produce an h of degree g+1
                    if with_h or model != "moved":
                        yield Row(name, model, genus, with_h)


def _random_curve(row, rng):
    K, g = row.K, row.genus
    size = 2 * g + 2 if row.model in ("ramified", "moved") else 2 * g + 3
    f = poly.random(K, size, rng)
    h = poly.random(K, g + 1 if size == 2 * g + 2 else g + 2, rng) if row.with_h else ()
    if row.model != "moved":
        return HyperellipticCurve(K, f, h)
    z = K.zero
    while z == K.zero:
        z = K.random(rng)
    return moved(HyperellipticCurve(K, f, h), z)


def moved(C, z):
    """The curve after y → y − z x^(g+1): its formal degree is 2g+2, and it has one point at infinity."""
    K, move = C.field, poly.monomial(C.field, z, C.genus + 1)
    f = poly.add(K, C.f, poly.mul(K, move, poly.sub(K, C.h, move)))
    return HyperellipticCurve(K, f, poly.sub(K, C.h, poly.add(K, move, move)))


def _rational_curve(row, rng):
    """A curve through g+1 points with small integral x: f = v² + hv − u·w."""
    K, g = QQ, row.genus

    def integers(size):
        return tuple(K.coerce(rng.randrange(-2, 3)) for _ in range(size))

    u = poly.from_roots(K, [K.coerce(x) for x in range(-(g // 2), g + 1 - g // 2)])
    v = poly.trim(K, integers(g + 1 if row.model != "split" else g + 2))
    h = poly.trim(K, integers(g + 1)) if row.with_h else ()
    w = poly.trim(K, integers(g + 2 if row.model == "inert" else g + 1))
    f = poly.sub(K, poly.mul(K, v, poly.add(K, v, h)), poly.mul(K, u, w))
    C = HyperellipticCurve(K, f, h)
    return moved(C, K.coerce(2)) if row.model == "moved" and C.genus == g else C


def _points(C, rng, count):
    if C.field.order is None:
        known = [point for x in range(-3, 4) for point in C.lift_x(x, all=True)]
        return [rng.choice(known) for _ in range(count)] if known else []
    return [C.random_point(rng) for _ in range(count)]


def _pool(row, rng):
    C, K = row.curve, row.K
    J, g = C.jacobian(), row.genus
    most = min(g, 2) if K == QQ else g
    if C.model == "inert":
        shapes = [2, 2, most - most % 2]
        pool = [J.from_points(_points(C, rng, count)) for count in shapes]
    else:
        pool = [J.from_points(_points(C, rng, count)) for count in (most, most, 1)]
        (point,) = _points(C, rng, 1)
        pool.append(J.from_points([point] * min(2, g)))
        pool.append(J.from_points([*C.points_at_infinity()[:1], *_points(C, rng, 1)]))
    pool += [J.zero(), pool[0] + pool[1]]
    if C.model == "split":
        plus, minus = C.points_at_infinity()
        pool += [J(plus, minus), J(plus), J(minus)]
    if K.order is not None:
        pool += [J.random(rng) for _ in range(2 if g < 5 else 1)]
        pool += _two_torsion(C, J)
    return pool


def _two_torsion(C, J):
    """The class of two branch points, or of one, where they are rational."""
    K = C.field
    locus = C.h if K.characteristic == 2 else C.discriminant
    xs = roots(K, locus)[:2] if len(locus) > 1 else []
    points = [C.lift_x(x) for x in xs]
    return [J.from_points(points)] if points and not (C.model == "inert" and len(points) % 2) else []


ROWS = list(_rows())
