"""One oval of a motion's curve as a circle of nodes: its periods, and integrals of functions times Fourier modes.

:mod:`integrable.torus.oval_modes` uses the ovals and defines the root R in some integrands. Numbers are flint's balls.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import ceil, log
from types import ModuleType
from typing import TYPE_CHECKING, NamedTuple, Protocol

from integrable.torus.series import powers
from jacobian.errors import PrecisionLoss

if TYPE_CHECKING:
    from flint import acb, arb

# −NOTHING stands for the decimal exponent of 0
NOTHING = 1e9
# the n-th harmonic of an integrand is about e^(−decay·n); a larger decay is replaced by this one: few nodes suffice
LARGEST_DECAY = 40.0


class OvalPair(Protocol):
    """The data of both ovals that an :class:`Oval` uses. ``low`` says whether ζ is below the middle α_i; both are
    branch points (:mod:`integrable.torus.states`).
    """

    flint: ModuleType
    pi: arb
    d: arb
    low: bool
    digits: int

    def phases(self, first: arb, second: arb) -> tuple[arb, arb]:
        """The phases (θ₁, θ₂), in turns, from the integrals ``first`` of dx/y and ``second`` of x dx/y."""


class Part(NamedTuple):
    """The values of an integrand at the nodes in 0 ≤ φ ≤ π, and whether it is even in φ."""

    values: list[arb]
    even: bool


class Node(NamedTuple):
    """A point u of an oval [a, b]: u, u − a, b − u, 1/√(1 − d·u), and 1/Y, where the differential dx/y is dφ/Y; then
    (∫dx/y, ∫x dx/y) from a to u.
    """

    u: arb
    below: arb
    above: arb
    light: arb
    slow: arb
    sums: tuple[arb, arb]


class Oval:
    """One oval [a, b] between the neighbouring branch points c < a and e > b on the real projective line.

    With sn²(z, k) = (u − a)(b − c)/((u − c)(b − a)), k² = (e − c)(b − a)/((e − a)(b − c)) and φ = πz/K, u is analytic
    in a strip that narrows with the logarithm of the gaps only. The first oval has c = ∞, the second e = 1/d.
    """

    def __init__(self, pair: OvalPair, ends: Sequence[arb], others: Sequence[arb], first: bool) -> None:
        self.flint, self.pi, self._d, self._first = pair.flint, pair.pi, pair.d, first
        self._others, self._low, self._ends = others, pair.low, (ends[0], ends[1])
        arb, acb, (a, b), d = self.flint.arb, self.flint.acb, ends, pair.d
        if first:
            near = others[0] - a
            self._part, rest = (b - a) / near, (others[0] - b) / near
        else:
            near = (1 - d * a) * (b - others[1])
            self._part, rest = (1 - d * others[1]) * (b - a) / near, (1 - d * b) * (a - others[1]) / near
        self._quarter = self.pi / (2 * arb.agm(arb(1), rest.sqrt()))
        self._scale = 2 * self._quarter / (self.pi * near.sqrt())
        # where the oval is a point, sn is the sine
        self._nome, self.decay = None, LARGEST_DECAY
        if float(self._part.mid()) > 1e-300:
            other = self.pi / (2 * arb.agm(arb(1), self._part.sqrt()))
            self._nome = acb(0, other / self._quarter)
            _, *self._null = (x.real for x in acb.modular_theta(acb(0), self._nome))
            self.decay = min(LARGEST_DECAY, float(self.pi * other / self._quarter))
        self._integrate(ceil((pair.digits + 4) * log(10) / self.decay) + 2)

    def _integrate(self, count: int) -> None:
        """Computes the periods and the cosine series, to ``count`` terms, of 1/Y and u/Y with Y of :class:`Node`."""
        arb, mat = self.flint.arb, self.flint.arb_mat
        self.harmonics = count
        waves = [(arb(i) / count).cos_pi() for i in range(2 * count)]
        weights = [arb(1 if i in (0, count) else 2) / (2 * count) for i in range(count + 1)]
        table = [waves[i * n % (2 * count)] * w for n in range(count + 1) for i, w in enumerate(weights)]
        nodes = [self._placed(arb(i) / count) for i in range(count + 1)]
        values = [x for u, *_, slow in nodes for x in (slow, u * slow)]
        series = mat(count + 1, count + 1, table) * mat(count + 1, 2, values)
        self._mean = series[0, 0], series[0, 1]
        self.period = [2 * self.pi * x for x in self._mean]
        self._waves = mat(count, 2, [2 * series[n, j] / n for n in range(1, count + 1) for j in (0, 1)])

    def sample(self, half: int) -> None:
        """Computes the ``half`` + 1 equidistant nodes in 0 ≤ φ ≤ π."""
        self.nodes = self._round(range(half + 1), half)
        self._weights = [self.pi * (1 if i in (0, half) else 2) / half for i in range(half + 1)]

    def _round(self, numbers: range, half: int) -> list[Node]:
        """The nodes at φ = πi/half, for the numbers i."""
        arb, mat = self.flint.arb, self.flint.arb_mat
        sines = [(arb(i) / half).sin_pi() for i in range(2 * half)]
        table = [[sines[i * n % (2 * half)] for n in range(1, self.harmonics + 1)] for i in numbers]
        rests = (mat(table) * self._waves).table()
        return [self._node(arb(i) / half, rest) for i, rest in zip(numbers, rests, strict=True)]

    def node(self, x: arb) -> Node:
        """The node at φ = πx."""
        wave = self.flint.acb(x.cos_pi(), x.sin_pi())
        waves = powers(wave, wave, self.harmonics)
        return self._node(x, (self.flint.arb_mat([[z.imag for z in waves]]) * self._waves).table()[0])

    def _node(self, x: arb, rest: list[arb]) -> Node:
        angle = self.pi * x
        return Node(*self._placed(x), (self._mean[0] * angle + rest[0], self._mean[1] * angle + rest[1]))

    def _placed(self, x: arb) -> tuple[arb, arb, arb, arb, arb]:
        """The fields of a :class:`Node` at φ = πx, without the integrals ``sums``."""
        (a, b), others = self._ends, self._others
        below, above = self._squares(x)
        length = b - a
        if self._first:
            below, above, rest = length * below, length * above, others[1]
        else:
            low, high, rest = a - others[1], b - others[1], others[0]
            bottom = high - length * below
            below, above = length * low * below / bottom, length * high * above / bottom
        u = a + below
        light = 1 / (1 - self._d * u).sqrt()
        slow = self._scale / abs(rest - u).sqrt()
        return u, below, above, light, slow * light if self._first else slow

    def _squares(self, x: arb) -> tuple[arb, arb]:
        """sn² and cn² at z = Kx, 0 ≤ x ≤ 1."""
        arb, acb, place = self.flint.arb, self.flint.acb, x / 2
        if x == 0 or x == 1:
            return arb(x), 1 - arb(x)
        if self._nome is None:
            return place.sin_pi() ** 2, place.cos_pi() ** 2
        t2, t3, t4 = self._null
        one, two, _, four = (t.real for t in acb.modular_theta(acb(place), self._nome))
        return (t3 * one / (t2 * four)) ** 2, (t4 * two / (t2 * four)) ** 2

    def angle(self, u: arb, y: arb) -> tuple[arb, float]:
        """φ/π of the point (u, y), in (−1, 1], with φ of :class:`Oval`, and an estimate of the error of φ/π. The
        estimate is 1 if the oval has shrunk to a point.
        """
        (a, b), others, arb = self._ends, self._others, self.flint.arb
        length = b - a
        if self._nome is None:
            return arb(0), 1.0
        light = (1 - self._d * u).sqrt()
        # sine and cosine of twice the amplitude of sn; near the ends y has the digits that u lacks
        if self._first:
            sine = 2 * y / (light * ((others[0] - u) * (others[1] - u)).sqrt() * length)
            cosine = ((b - u) - (u - a)) / length
        else:
            low, high = a - others[1], b - others[1]
            bottom = (u - others[1]) * length
            sine = 2 * y * (low * high).sqrt() / (light * ((u - others[0]) * (u - others[1])).sqrt() * bottom)
            cosine = ((b - u) * low - (u - a) * high) / bottom
        amplitude = arb.atan2(sine.mid(), cosine.mid()) / 2
        found = self.flint.acb.elliptic_f(self.flint.acb(amplitude), self.flint.acb(self._part.mid())).real
        return found / self._quarter, float(max(sine.rad(), cosine.rad()))

    def turn(self, pair: OvalPair, size: tuple[int, int]) -> None:
        """Makes tables of e^(2πikθ₁) for k ≤ size[0], and of e^(2πimθ₂) for m ≤ size[1], at the nodes."""
        acb, mat = self.flint.acb, self.flint.arb_mat
        self._size, angles = size, [pair.phases(*node.sums) for node in self.nodes]
        self._halves = [[acb(x.cos_pi(), x.sin_pi()) for x in row] for row in zip(*angles, strict=True)]
        one = acb(1)
        down, across = ([powers(one, z * z, n + 1) for z in row] for row, n in zip(self._halves, size, strict=True))
        self._down = list(zip(*down, strict=True))
        # ``halved`` is e^(πi(2m + 1)θ₂)
        halved = [[z * h for z in row] for row, h in zip(across, self._halves[1], strict=True)]
        self._across = [
            (mat([[z.real for z in row] for row in table]), mat([[z.imag for z in row] for row in table]))
            for table in (across, halved)
        ]

    def alias(self, pair: OvalPair, size: tuple[int, int]) -> float:
        """The decimal exponent of the aliasing error of the highest modes at the nodes: half of the change when
        intermediate nodes are added.
        """
        half, acb = len(self.nodes) - 1, self.flint.acb
        between = self._round(range(1, 2 * half, 2), 2 * half)
        totals = [acb(0)] * 4
        size0, (rows, columns) = acb(0), size
        signed = [(w, node) for w, node in zip(self._weights, self.nodes, strict=True)]
        signed += [(-2 * self.pi / half, node) for node in between]
        for w, node in signed:
            first, second = pair.phases(*node.sums)
            one, other = (acb((2 * x).cos_pi(), (2 * x).sin_pi()) for x in (rows * first, columns * second))
            found = (one * other, one * other.conjugate(), one, other)
            totals = [t + w * node.slow * z.real for t, z in zip(totals, found, strict=True)]
            size0 += abs(w) * node.slow
        return max(map(exponent, totals)) - exponent(size0)

    def moments(self) -> list[Part]:
        """The integrands 1/(Y√(1 − du)) and u/(Y√(1 − du)) with Y of :class:`Node`."""
        values = [node.light * node.slow for node in self.nodes]
        return [Part(values, True), Part([node.u * x for node, x in zip(self.nodes, values, strict=True)], True)]

    @property
    def _at_end(self) -> bool:
        """Whether the root R of :mod:`integrable.torus.oval_modes` vanishes at the end b only, as on a second oval
        that begins at ζ and not at an α_i.
        """
        return not (self._first or self._low)

    def sign(self, angle: arb) -> int:
        """The sign of the root R of :mod:`integrable.torus.oval_modes` at a point, whose φ/π is ``angle``."""
        return 1 if self._at_end or angle.mid() > 0 else -1

    def roots(self) -> list[Part]:
        """The integrands y/R and R, both divided by Y√(1 − du), with Y of :class:`Node` and R of
        :mod:`integrable.torus.oval_modes`.
        """
        others, first, second = self._others, [], []
        for u, below, above, light, slow, _ in self.nodes:
            if self._first == self._low:
                # one end is ζ, the other an α_i
                axis, ratio = (below, above) if self._first else (above, below)
                square = axis * abs((u - others[0]) * (u - others[1]))
            else:
                zeta, outer = others if self._first else others[::-1]
                ratio, square = abs(u - zeta), below * above * abs(u - outer)
            first.append(ratio.sqrt() * slow)
            second.append(square.sqrt() * slow * light)
        return [Part(first, not self._at_end), Part(second, self._at_end)]

    def integrals(self, part: Part, half_row: int, half_column: int) -> list[list[acb]]:
        """∮ of a part times e^(−2πi(kθ₁ + mθ₂)), k = 0, …, rows and m = −columns, …, columns. With ``half_row`` k + ½
        replaces k; with ``half_column`` m + ½ replaces m, and m begins at −columns − 1.
        """
        mat = self.flint.arb_mat
        weights = [x * w for x, w in zip(part.values, self._weights, strict=True)]
        if half_row:
            weights = [w * z for w, z in zip(weights, self._halves[0], strict=True)]
        left = [[w * z for w, z in zip(weights, row, strict=True)] for row in self._down]
        real, imaginary = mat([[z.real for z in row] for row in left]), mat([[z.imag for z in row] for row in left])
        if not part.even:
            real, imaginary = imaginary, real
        right, below = self._across[half_column]
        cosines, sines = real * right, imaginary * below
        # cos and sin of 2π(kθ₁ + mθ₂) by the addition theorems, whose second term changes its sign for −m
        sign = -1 if part.even else 1
        plus, minus = (cosines + sign * sines).table(), (cosines - sign * sines).table()
        first, unit = 0 if half_column else 1, self.flint.acb(1 if part.even else -1j)
        return [
            [unit * x for x in low[: first - 1 if first else None : -1] + high]
            for low, high in zip(minus, plus, strict=True)
        ]


def exponent(c: acb) -> float:
    """log10 |c|; PrecisionLoss if c is not a number."""
    size = abs(c).mid()
    if not size.is_finite():
        raise PrecisionLoss("a mode of 1/g is no number; use more digits")
    return float(size.log()) / log(10) if size > 0 else -NOTHING
