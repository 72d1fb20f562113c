"""Curves for the tests of balls: random ones, and some whose branch points come in clusters."""

from fractions import Fraction

from jacobian import CC, QQ, HyperellipticCurve, poly


def random_curve(rng, g, kind):
    """A curve over QQ with small coefficients, over CC, or over QQ with branch points in clusters 1e-6 wide; never an
    inert one.

    Those over QQ have a rational point, above x = 0 or at a branch point.
    """
    degree = 2 * g + 1 + rng.randrange(2)
    if kind == "complex":
        return HyperellipticCurve(CC, [complex(rng.uniform(-1, 1), rng.uniform(-1, 1)) for _ in range(degree + 1)])
    lead = 1 if degree % 2 == 0 else rng.choice((1, 2, -3))
    if kind == "cluster":
        roots = []
        while len(roots) < degree:
            a = Fraction(rng.randint(-(10**6), 10**6), 10**6)
            roots += [a + Fraction(j * rng.randint(1, 3), 10**6) for j in range(rng.choice((2, 3)))]
            roots = list(dict.fromkeys(roots))
        return HyperellipticCurve(QQ, poly.scale(QQ, Fraction(lead), poly.from_roots(QQ, roots[:degree])))
    while True:
        h = [rng.randint(-2, 2) for _ in range(rng.randrange(1, g + 1))]
        y = rng.randint(0, 3)
        f = [y * y + h[0] * y, *[rng.randint(-9, 9) for _ in range(degree - 1)], lead]
        try:
            return HyperellipticCurve(QQ, f, h)
        except ValueError:
            continue
