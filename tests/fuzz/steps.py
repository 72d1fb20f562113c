"""Fuzz of the steps: images in 60 digits by the formulas of the additions, written out here.

A point (x', Y') is added on Γ_i = g√(1 − da_i)γ_i, n_i = 2√(1 − da_i)w_i + λΓ_i, w = γ×M, λ = 2gd(Aγ, w): with U =
ΣΓ_i²(x − a_j)(x − a_k), V = ΣΓ_in_i(x − a_j)(x − a_k) and c = (Y' − V(x'))/U(x'),

    Γ̃_i = (n_i + cΓ_i)/(2√(dH2) s_i),    ñ_i = −2√(dH2) s_iΓ_i + cΓ̃_i,    s_i = √(x' − a_i)    (Tsiganov),

two points one after the other, in complex numbers. The keyless map is e = γ×M/|M|, γ̃_i = σ_ie_i/(g̃√(1 − da_i)), M̃ =
|M|γ̃ × (σ_ig√(1 − da_i)γ_i). Multiples of the state's own divisor have no such formula here; they are compared with the
step over MP(60). For tilted states, H1 and H2 are kept. Over GF(p), the differential of a step takes the vector field
of the motion in τ to itself, and that of a multiple m to m times itself; the field is written out here in Python's
ints.
"""

from __future__ import annotations

from random import Random
from typing import Any

import mpmath
import numpy as np

from tests.fuzz import distributions as random
from tests.fuzz.case import Case, Complaint, Undecided
from tests.fuzz.distributions import Motion

C = mpmath.MPContext()
C.dps = 60
KEPT, FACTOR = 1e-11, 300


class Body:
    """a_i, 1 − da_i and d as mp numbers, and a state in the coordinates Γ, n."""

    def __init__(self, inertia: Any, d: Any) -> None:
        self.d = C.convert(d)
        self.a = [1 / (C.convert(x) + self.d) for x in inertia]
        self.r = [C.sqrt(C.convert(x) * a) for x, a in zip(inertia, self.a, strict=True)]

    def pairs(self, gamma: Any, M: Any) -> tuple[list[Any], list[Any]]:
        g = 1 / C.sqrt(sum((r * x) ** 2 for r, x in zip(self.r, gamma, strict=True)))
        w = _cross(gamma, M)
        lean = 2 * g * self.d * sum(a * x * y for a, x, y in zip(self.a, gamma, w, strict=True))
        G = [g * r * x for r, x in zip(self.r, gamma, strict=True)]
        return G, [2 * r * y + lean * x for r, x, y in zip(self.r, G, w, strict=True)]

    def state(self, G: Any, n: Any) -> list[Any]:
        squares = [1 / r**2 for r in self.r]
        g2 = sum(x * x * s for x, s in zip(G, squares, strict=True))
        g, lean = C.sqrt(g2), sum(x * y * s for x, y, s in zip(G, n, squares, strict=True)) / g2
        gamma = [x / (g * r) for x, r in zip(G, self.r, strict=True)]
        w = [(y - lean * x) / (2 * r) for x, y, r in zip(G, n, self.r, strict=True)]
        return [*gamma, *_cross(w, gamma)]

    def height(self, x: Any, h1: Any, h2: Any) -> Any:
        """f(x) = 4(1 − dx)Π(a_i − x)(xh2 − h1)."""
        return 4 * (1 - self.d * x) * C.fprod(a - x for a in self.a) * (x * h2 - h1)

    def energy(self, gamma: Any, M: Any) -> Any:
        lean = sum(a * x * m for a, x, m in zip(self.a, gamma, M, strict=True))
        below = sum((r * x) ** 2 for r, x in zip(self.r, gamma, strict=True))
        return sum(a * m * m for a, m in zip(self.a, M, strict=True)) + self.d * lean**2 / below


def _cross(x: Any, y: Any) -> list[Any]:
    return [x[i - 2] * y[i - 1] - x[i - 1] * y[i - 2] for i in range(3)]


def _plus_point(body: Body, G: Any, n: Any, x: Any, y: Any, h2: Any) -> tuple[list[Any], list[Any]]:
    a = body.a
    others = [(x - a[i - 2]) * (x - a[i - 1]) for i in range(3)]
    U = sum(p * p * o for p, o in zip(G, others, strict=True))
    V = sum(p * q * o for p, q, o in zip(G, n, others, strict=True))
    c, lead = (y - V) / U, 2 * C.sqrt(body.d * h2)
    s = [C.sqrt(x - e) for e in a]
    moved = [(q + c * p) / (lead * t) for p, q, t in zip(G, n, s, strict=True)]
    return moved, [-lead * t * p + c * m for p, t, m in zip(G, s, moved, strict=True)]


def image(start: Motion, gamma: Any, M: Any, points: Any, sheets: Any, factors: Any = (1,) * 4) -> list[Any]:
    """γ̃ and M̃ of a translation, for roots √U'(a_i) > 0; ``factors`` change the moments and d."""
    inertia = [C.convert(x) * f for x, f in zip(start.inertia, factors, strict=False)]
    body = Body(inertia, C.convert(start.d) * factors[3])
    G, n = body.pairs(gamma, M)
    h1, h2 = body.energy(gamma, M), sum(m * m for m in M)
    for x, sheet in zip(points, sheets, strict=True):
        x = C.convert(x)
        G, n = _plus_point(body, G, n, x, sheet * C.sqrt(body.height(x, h1, h2)), h2)
    if len(points) == 2:
        for i, e in enumerate(body.a):
            turned = C.fprod(C.sqrt(C.convert(x) - e) for x in points)
            if C.re(turned) < 0:
                G[i], n[i] = -G[i], -n[i]
    else:
        # for one point the package chooses the other lift
        G, n = [-x for x in G], [-x for x in n]
    return [C.re(x) for x in body.state(G, n)]


def keyless_image(start: Motion, gamma: Any, M: Any, signs: Any, factors: Any = (1,) * 4) -> list[Any]:
    inertia = [C.convert(x) * f for x, f in zip(start.inertia, factors, strict=False)]
    body = Body(inertia, C.convert(start.d) * factors[3])
    size = C.sqrt(sum(m * m for m in M))
    e = [s * x / size for s, x in zip(signs, _cross(gamma, M), strict=True)]
    below = C.sqrt(sum((x / r) ** 2 for x, r in zip(e, body.r, strict=True)))
    g = 1 / C.sqrt(sum((r * x) ** 2 for r, x in zip(body.r, gamma, strict=True)))
    turned = [x / (below * r) for x, r in zip(e, body.r, strict=True)]
    scaled = [s * g * r * x for s, r, x in zip(signs, body.r, gamma, strict=True)]
    return [*turned, *(size * x for x in _cross(turned, scaled))]


# --- kinds


def _start(rng: Random) -> Motion:
    return random.motion(rng, random.general_moments(rng), rolls=True, tilted=False)


def translation(rng: Random) -> Case:
    """Two points beyond 1/d or on one oval, or one point beyond 1/d."""
    start = _start(rng)
    points = _points(rng, start)
    sheets = tuple(rng.choice((1, -1)) for _ in points)
    setup = start.setup + f"step = system.translation({points}, {sheets})\n"
    return _case(setup, start, lambda g, m, f: image(start, g, m, points, sheets, f))


def _points(rng: Random, start: Motion) -> list[float]:
    pole = 1 / start.d
    if rng.random() < 0.5:
        # all the roots √(x' − a_i) are real there
        return [pole * (1 + random.magnitude(rng, -6, 10)) for _ in range(rng.choice((1, 2)))]
    body = Body(start.inertia, start.d)
    height = body.energy(start.gamma, [C.mpf(m) for m in start.M]) / sum(C.mpf(m) ** 2 for m in start.M)
    a = sorted(float(x) for x in body.a)
    low, high = (a[0], min(a[1], float(height))) if rng.random() < 0.5 else (max(a[1], float(height)), a[2])
    return [low + (high - low) * (0.01 + 0.98 * rng.random()) for _ in range(2)]


def keyless(rng: Random) -> Case:
    start = random.motion(rng, random.general_moments(rng), rolls=rng.random() < 0.7, tilted=False)
    signs = tuple(rng.choice((1, -1)) for _ in range(3))
    if start.d and rng.random() < 0.4:
        # the same map, lifted to −γ
        return _case(start.setup + f"step = system.torsion({signs})\n", start, _torsion(start, signs))
    return _case(start.setup + f"step = system.keyless({signs})\n", start, _keyless(start, signs))


def _keyless(start: Motion, signs: Any) -> Any:
    return lambda g, m, f: keyless_image(start, g, m, signs, f)


def _torsion(start: Motion, signs: Any) -> Any:
    def formula(gamma: Any, M: Any, factors: Any) -> list[Any]:
        x1, x2, x3, *moved = keyless_image(start, gamma, M, signs, factors)
        return [-x1, -x2, -x3, *moved]

    return formula


def _case(setup: str, start: Motion, formula: Any) -> Case:
    call = "np.array([*(moved := step(state)).gamma, *moved.M])"
    return Case(setup, call, lambda names: judged(names["got"], start, formula))


def judged(got: np.ndarray, start: Motion, formula: Any) -> Complaint | None:
    """Compares with a formula of (γ, M, factors); the effect of one unit in the last place is found from three changes
    of the inputs.
    """
    gamma, M = _constrained(start.gamma, start.M)
    truth = formula(gamma, M, (1,) * 4)
    size = C.sqrt(sum(m * m for m in M))
    scales = [1, 1, 1, size, size, size]
    errors = [float(abs(C.mpf(x) - y) / s) for x, y, s in zip(got.tolist(), truth, scales, strict=True)]
    if max(errors) <= KEPT:
        return None
    rng, worst = Random(0), [0.0] * 6
    for _ in range(3):
        f = [1 + C.mpf(2) ** -52 * rng.choice((1, -1)) for _ in range(10)]
        moved = formula(
            *_constrained(
                [x * y for x, y in zip(gamma, f, strict=False)], [x * y for x, y in zip(M, f[3:], strict=False)]
            ),
            f[6:],
        )
        worst = [max(w, float(abs(x - y) / s)) for w, x, y, s in zip(worst, moved, truth, scales, strict=True)]
    allowed = KEPT + FACTOR * max(worst)
    if max(errors) <= allowed:
        if allowed > 0.5:
            raise Undecided("one unit in the last place of the inputs decides")
        return None
    row = [float(x) for x in truth]
    return Complaint(
        f"off by {max(errors):.1e}, allowed {allowed:.1e}",
        f"np.array({row})",
        f"(abs(got - expected) <= {allowed:.1e} * np.array({[float(s) for s in scales]})).all()",
    )


def _constrained(gamma: Any, M: Any) -> tuple[list[Any], list[Any]]:
    gamma, M = [C.convert(x) for x in gamma], [C.convert(x) for x in M]
    size = C.sqrt(sum(x * x for x in gamma))
    gamma = [x / size for x in gamma]
    height = sum(x * m for x, m in zip(gamma, M, strict=True))
    return gamma, [m - height * x for x, m in zip(gamma, M, strict=True)]


def multiplication(rng: Random) -> Case:
    """[3] and [5] of the state's own divisor, against the same over MP(60)."""
    start = random.motion(rng, random.general_moments(rng), rolls=rng.random() < 0.7, tilted=False)
    factor = rng.choice((3, 3, -3, 5))
    setup = start.setup + f"step = system.multiplication({factor})\n"
    return _case(setup, start, lambda g, m, f: _wide_multiple(start, g, m, f, factor))


def _wide_multiple(start: Motion, gamma: Any, M: Any, f: Any, factor: int) -> list[Any]:
    from integrable import ChaplyginBall
    from jacobian import MP

    K = MP(60)
    text = lambda values: [C.nstr(x, 58) for x in values]  # noqa: E731
    inertia = [C.convert(x) * y for x, y in zip(start.inertia, f, strict=False)]
    ball = ChaplyginBall(text(inertia), C.nstr(C.convert(start.d) * f[3], 58), field=K)
    moved = ball.multiplication(factor)(ball.state(text(gamma), text(M)))
    return [C.convert(x) for x in (*moved.gamma, *moved.M)]


def tilted(rng: Random) -> Case:
    """Steps of tilted states: |γ̃| = 1, and (γ, M), H1 and H2 are preserved."""
    start = random.motion(rng, random.general_moments(rng), rolls=True, tilted=True)
    points = [1 / start.d * (1 + random.magnitude(rng, -3, 6)) for _ in range(2)]
    step = rng.choice((f"translation({points})", "keyless()", "torsion()"))
    call = "np.array([*(moved := step(state)).gamma, *moved.M])"
    setup = start.setup + f"step = system.{step}\n"
    return Case(setup, call, lambda names: _same_level(names["got"].tolist(), start))


def _same_level(row: list[float], start: Motion) -> Complaint | None:
    body, found = Body(start.inertia, start.d), []
    for gamma, M in ((start.gamma, start.M), (row[:3], row[3:])):
        gamma, M = [C.mpf(x) for x in gamma], [C.mpf(x) for x in M]
        length = C.sqrt(sum(x * x for x in gamma))
        unit = [x / length for x in gamma]
        found.append((length, C.fdot(unit, M), body.energy(unit, M), C.fdot(M, M)))
    before, after = found
    off = [
        abs(after[0] - 1),
        abs(after[1] - before[1]) / C.sqrt(before[3]),
        abs(after[2] / before[2] - 1),
        abs(after[3] / before[3] - 1),
    ]
    if max(off) < 1e-11:
        return None
    return Complaint(f"|γ|, (γ, M), H1, H2 off by {[float(x) for x in off]}", "system.integrals(state)", "False")


def against_motion(rng: Random) -> Case:
    """A step over GF(p) and the motion in τ, for bodies, states and points whose roots are all in GF(p)."""
    rolls, multiple = rng.random() < 0.6, rng.choice((1, 1, 2, -3, 7, 10**9, 10**400 + 1))
    name = rng.choice(
        ["two points", "keyless", "multiplication"]
        + ["one point", "torsion"] * rolls
        + ["conic at infinity", "conic"] * (not rolls)
    )
    # an even multiple of the own divisor needs √−1
    even = name == "multiplication" and multiple % 2 == 0
    p = rng.choice((101, 10009, 2**61 - 31) if even else (101, 499, 10007, 2**61 - 1))
    is_square = lambda x: pow(x, (p - 1) // 2, p) == 1  # noqa: E731
    for _ in range(200):
        inertia, d = _exact_body(rng, p, rolls, even)
        a = [pow(x + d, -1, p) for x in inertia]
        gamma, M = _exact_state(rng, p)
        h1, h2 = _field(p, a, d, gamma, M, None)[0] if not rolls else (0, sum(m * m for m in M) % p)
        below = 1 - d * sum(x * y * y for x, y in zip(a, gamma, strict=True))
        if not is_square(below) or not is_square(h2):
            continue
        if rolls:
            lean = sum(x * y * z for x, y, z in zip(a, gamma, M, strict=True))
            h1 = (sum(x * m * m for x, m in zip(a, M, strict=True)) + d * lean * lean * pow(below, -1, p)) % p
        step = _exact_step(rng, p, name, multiple, (a, d, gamma, M, h1, h2))
        if step:
            break
    else:
        step = f"multiplication({multiple})"
    # the ratio of the rates of image and state
    factor = {"multiplication": multiple, "conic": 0}.get(step.split("(")[0] if name != "conic at infinity" else "", 1)
    kind = f"ChaplyginBall({inertia}, {d}, field=GF({p}))" if rolls else f"EulerTop({inertia}, field=GF({p}))"
    setup = (
        f"from integrable import {kind.split('(')[0]}\nfrom integrable.phase.brackets import differential\n"
        f"from jacobian import GF\nsystem = {kind}\nstate = system.state({gamma}, {M})\nstep = system.{step}\n"
        "six = lambda x: (*x.gamma, *x.M)\n"
    )
    call = "(state.g, step(state), differential(system, lambda s, x: six(step.over(s)(x)), state))"
    return Case(setup, call, lambda names: _moves_alike(names["got"], p, inertia, d, gamma, M, factor), limit=3)


def _exact_body(rng: Random, p: int, rolls: bool, even: bool) -> tuple[tuple[int, int, int], int]:
    """Three different moments and d with every 1 − da_i a square: I = dt²/(1 − t²). With ``even``, all κ_i are squares
    too.
    """
    while True:
        d = rng.randrange(1, p) if rolls else 0
        t = [rng.randrange(2, p - 1) for _ in range(3)]
        found = [d * x * x * pow(1 - x * x, -1, p) % p if rolls else x for x in t]
        x, y, z = found
        if len({0, x, y, z}) < 4 or 0 in ((x + d) % p, (y + d) % p, (z + d) % p):
            continue
        a = [pow(x + d, -1, p) for x in found]
        kappas = [(1 - d * a[i]) * (a[i] - a[i - 1]) * (a[i] - a[i - 2]) for i in range(3)]
        if not even or all(pow(kappa, (p - 1) // 2, p) == 1 for kappa in kappas):
            return (x, y, z), d


def _exact_state(rng: Random, p: int) -> tuple[tuple[int, ...], tuple[int, ...]]:
    """γ on the sphere, M orthogonal to it."""
    while True:
        x, y = rng.randrange(1, p), rng.randrange(1, p)
        length = 1 + x * x + y * y
        if length % p:
            below = pow(length, -1, p)
            gamma = tuple(c * below % p for c in (2 * x, 2 * y, 1 - x * x - y * y))
            M = tuple(c % p for c in _cross(gamma, [rng.randrange(1, p) for _ in range(3)]))
            return gamma, M


def _exact_step(rng: Random, p: int, name: str, multiple: int, state: Any) -> str | None:
    """A step of that kind under which the state has an image; None where none was found."""
    a, d, gamma, M, h1, h2 = state
    draw = lambda: rng.randrange(1, p)  # noqa: E731
    is_square = lambda x: pow(x, (p - 1) // 2, p) == 1  # noqa: E731
    if name in ("keyless", "torsion"):
        tilde = sum(w * w * pow(1 - d * x, -1, p) for w, x in zip(_cross(gamma, M), a, strict=True))
        return f"{name}()" if not d or is_square(tilde) else None
    if name == "multiplication":
        return f"multiplication({multiple})"
    for _ in range(200):
        if name.startswith("conic"):
            c, x0 = draw(), draw()
            if not is_square(c * c + 4 * h2):
                continue
            if name != "conic":
                return f"conic(None, {c})"
            others = [(x0 - a[i - 2]) * (x0 - a[i - 1]) for i in range(3)]
            U = sum(x * x * o for x, o in zip(gamma, others, strict=True))
            V = sum(2 * x * w * o for x, w, o in zip(gamma, _cross(gamma, M), others, strict=True))
            return f"conic({x0}, {(V + c * U) % p})"
        points = [draw() for _ in range(2 if name == "two points" else 1)]
        heights = [4 * (1 - d * x) * (a[0] - x) * (a[1] - x) * (a[2] - x) * (x * h2 - h1) for x in points]
        # the roots at the branch points, which an even multiple does not need
        places = [*a, pow(d, -1, p)] if d else a
        roots = [(points[0] - e) * (points[-1] - e if len(points) == 2 else 1) for e in places] * (multiple % 2)
        if all(map(is_square, heights + roots)):
            return f"translation({points}, multiple={multiple})"
    return None


def _moves_alike(got: Any, p: int, inertia: Any, d: int, gamma: Any, M: Any, factor: int) -> Complaint | None:
    g, image, rows = got
    a = [pow(x + d, -1, p) for x in inertia]
    first, here = _field(p, a, d, gamma, M, g)
    second, there = _field(p, a, d, image.gamma, image.M, image.g)
    if first != second:
        return Complaint("H1 and H2 are others", "system.integrals(state)", "system.integrals(got[1]) == expected")
    pushed = [sum(x * y for x, y in zip(row, here, strict=True)) % p for row in rows]
    wanted = [x * (factor or 1) % p for x in there]
    # a conic step through a plane point does not change the motion of M
    if pushed[3 if not factor else 0 :] == wanted[3 if not factor else 0 :]:
        return None
    return Complaint("the motion in τ is another", f"{wanted}", f"{pushed} == expected")


def _field(p: int, a: Any, d: int, gamma: Any, M: Any, g: int | None) -> tuple[tuple[int, int], list[int]]:
    """(H1, H2) and (γ, M)' in τ: γ × ω/g and M × ω/g, ω = AM + dg²(γ, AM)Aγ."""
    root = 1 if g is None else g
    lean = sum(x * y * z for x, y, z in zip(a, gamma, M, strict=True))
    w = [x * (m + d * root * root * lean * y) for x, y, m in zip(a, gamma, M, strict=True)]
    slow = pow(root, -1, p)
    h1 = sum(x * m for x, m in zip(w, M, strict=True)) % p
    return (h1, sum(m * m for m in M) % p), [slow * x % p for x in (*_cross(gamma, w), *_cross(M, w))]


KINDS = {
    "translation": translation,
    "keyless": keyless,
    "multiplication": multiplication,
    "tilted step": tilted,
    "step and motion": against_motion,
}
