"""Fields of two words, and the special classes, which a kernel adds one by one."""

from jacobian import GF

MODELS = ("ramified", "split", "inert")
PRIMES = (2**63 + 29, 2**64 - 59, 2**64 + 13, 2**89 - 1, 2**127 - 1, 2**128 - 159)
TAILS = {61: 39, 127: 3}
"""M − x^n for irreducible M of degree n over GF(2), as bits."""
BINARY = {f"GF(2^{n})": GF(2, n, [tail >> i & 1 for i in range(n)] + [1]) for n, tail in TAILS.items()}
LONG = {f"GF(p), {p.bit_length()} bits, {p % 1000}": GF(p) for p in PRIMES} | BINARY
SMALL = {"GF(3)": GF(3), "GF(5)": GF(5), "GF(4)": GF(2, 2, (1, 1, 1)), "GF(8)": GF(2, 3, (1, 1, 0, 1))}


def special_classes(C, rng):
    """0, classes with common and opposite points, weights below 2, both points at infinity."""
    J = C.jacobian()
    P, Q, R = (C.random_point(rng) for _ in range(3))
    points = ((P, Q), (P, R), (P, P), (C.involution(P), Q), (C.involution(P), C.involution(Q)), (Q, R))
    classes = [J.zero(), *(J.from_points(some) for some in points)]
    if C.model != "inert":
        classes += [J.from_points([P]), J.from_points([C.involution(P)]), J.from_points([Q])]
    if C.model == "split":
        classes += [J.from_points([point]) for point in C.points_at_infinity()]
        classes += [J.from_mumford([1], [], n) for n in (0, 2)]
    return classes
