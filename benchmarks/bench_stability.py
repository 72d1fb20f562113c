"""The growth of errors over 10 … 10⁸ additions of one divisor, for each method of stepping: error and residual of the
curve.

``python -m benchmarks.bench_stability --figure docs/figures/stability`` also draws it, as .png and .svg. The start is
the divisor D of the ball (or the top), the step D' a conjugate pair at x = ±iη; the reference is D + [n]D' at 60
digits. Errors are those of the coefficients of (U, V); the residual is |f − V² mod U| over the size of f.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from math import log10
from pathlib import Path
from time import perf_counter
from typing import Any

import numpy as np

from benchmarks.classical import classical
from benchmarks.figures import command, save
from integrable import ChaplyginBall, EulerTop
from integrable.moving_point import compiled
from jacobian import MP
from jacobian.inexact import genus2_real, retraction
from jacobian.native.kinds import BOOL, FLOAT, FLOATS, INT, WIDES, TupleKind
from jacobian.native.library import Library
from jacobian.numbers.double_double import pack, unpack

SCENES = json.loads((Path(__file__).parents[1] / "tests" / "data" / "trajectories.json").read_text())["scenes"]
K = MP(60)
STEPS = {"S1": (0.3, 1e-4), "S2": (0.3, 1e-4)}
MOST_RESIDUAL = 1e-13
RETRACTED = 16
"""The number of additions between two corrections."""


@dataclass(frozen=True)
class Problem:
    """A curve, a start and a step at 60 digits. The coefficients of f ascend; a divisor (U, V) is (u0, u1, v0, v1)."""

    name: str
    f: tuple[Any, ...]
    a: tuple[Any, ...]
    start: tuple[Any, ...]
    step: tuple[Any, ...]
    group: Any
    divisors: tuple[Any, Any]

    def truth(self, count: int) -> tuple[Any, ...]:
        """The coefficients (u0, u1, v0, v1) of D + [count]D'."""
        D, E = self.divisors
        total = self.group.add(D, count * E)
        return (*total.u[:2], *total.v)

    def doubles(self, digits: int) -> list[tuple[Any, ...]]:
        """The divisors [2^k]D' for k < ``digits``, as (u0, u1, v0, v1)."""
        _, E = self.divisors
        found = []
        for _ in range(digits):
            found.append((*E.u[:2], *E.v))
            E = self.group.add(E, E)
        return found

    @property
    def weights(self) -> list[Any]:
        """The factors κ_i = (a_i − a_j)(a_i − a_k), with which U(a_i) = κ_iΓ_i² and V(a_i) = κ_iΓ_in_i."""
        a = self.a
        return [(a[i] - a[i - 1]) * (a[i] - a[i - 2]) for i in range(3)]

    def pairs(self, divisor: tuple[Any, ...], weights: list[Any]) -> tuple[Any, ...]:
        """The pairs Γ_i and n_i of a divisor, with Γ_i a positive root."""
        u0, u1, v0, v1 = divisor
        roots = [K.sqrt((x * x + u1 * x + u0) / w) for x, w in zip(self.a, weights, strict=True)]
        return (*roots, *((v1 * x + v0) / (w * r) for x, w, r in zip(self.a, weights, roots, strict=True)))


def problem(name: str, eta: float) -> Problem:
    """The start D of a scene, and the step D' = (iη, ·) + (−iη, ·)."""
    scene = SCENES[name]
    numbers = {key: [K.coerce(x) for x in scene[key]] for key in ("I", "gamma0", "M0")}
    d = K.coerce(str(scene["d"]))
    system = ChaplyginBall(numbers["I"], d, field=K) if d else EulerTop(numbers["I"], field=K)
    state = system.state(numbers["gamma0"], numbers["M0"])
    D = system.divisor(state)
    _, _, h1, h2 = system.integrals(state)
    f = (*system.body.polynomial(h1, h2), K.zero, K.zero)[:6]
    context = K.context
    size = K.coerce(eta)
    y = context.sqrt(sum(c * context.mpc(0, size) ** k for k, c in enumerate(f)))
    group = D.jacobian
    E = group.from_mumford((size * size, K.zero, K.one), (y.real, y.imag / size))
    return Problem(name, f, tuple(system.a), (*D.u[:2], *D.v), (*E.u[:2], *E.v), group, (D, E))


# --- methods of stepping: each yields (u0, u1, v0, v1) after each number of additions in ``counts``

Way = Callable[[Problem, list[int]], Iterator[tuple[Any, ...]]]


def _stacked(f: Any, point: Any, step: Any, count: int) -> Any:
    for _ in range(count):
        point = genus2_real.add(f, point, step)[0]
    return point


def _retracted(f: Any, point: Any, step: Any, count: int) -> Any:
    for i in range(count):
        point = genus2_real.add(f, point, step)[0]
        if i % RETRACTED == RETRACTED - 1:
            point = retraction.retracted(f, point)
    return point


def _classical(f: Any, point: Any, step: Any, count: int) -> Any:
    for _ in range(count):
        point = classical(f, point, step)
    return point


def _pairs_alone(a: Any, x: Any, y: Any, step: Any, roots: Any, count: int) -> None:
    """Replaces Γ and n, held in x and y, ``count`` times by Γ̃_i = (n_i + L(a_i)Γ_i)/(b3s'_i) and
    ñ_i = −b3s'_iΓ_i + (b3a_i + β̃)Γ̃_i, without f.

    Here b3 is the leading coefficient of L, s'_i are the ``roots``, and β̃ is such that (Γ̃, ñ) = 0.
    """
    s0, s1, t0, t1 = step
    for _ in range(count):
        u0, u1, v0, v1 = 0.0, 0.0, 0.0, 0.0
        for i in range(3):
            b, c = a[(i + 2) % 3], a[(i + 1) % 3]
            u0 += x[i] * x[i] * b * c
            u1 -= x[i] * x[i] * (b + c)
            v0 += x[i] * y[i] * b * c
            v1 -= x[i] * y[i] * (b + c)
        a0, a1 = u0 - s0, u1 - s1
        b0, b1 = -s0 * a1, a0 - s1 * a1
        r0, r1 = t0 - v0, t1 - v1
        determinant = a0 * b1 - a1 * b0
        l0, l1 = (r0 * b1 - r1 * b0) / determinant, (a0 * r1 - a1 * r0) / determinant
        lean = 0.0
        norm = 0.0
        for i in range(3):
            old = x[i]
            x[i] = (y[i] + (l1 * a[i] + l0) * old) / (l1 * roots[i])
            y[i] = -l1 * roots[i] * old + l1 * a[i] * x[i]
        for i in range(3):
            lean += x[i] * y[i]
            norm += x[i] * x[i]
        for i in range(3):
            y[i] -= lean / norm * x[i]


def _in_double_double(f: Any, first: Any, by: Any, count: int, retract: bool, to: Any) -> None:
    six = (f[0], f[1], f[2], f[3], f[4], f[5])
    moved, four = (first[0], first[1], first[2], first[3]), (by[0], by[1], by[2], by[3])
    for i in range(count):
        moved = genus2_real.add(six, moved, four)[0]
        if retract and i % RETRACTED == RETRACTED - 1:
            moved = retraction.retracted(six, moved)
    to[0], to[1], to[2], to[3] = moved


SIX, FOUR = TupleKind((FLOAT,) * 6), TupleKind((FLOAT,) * 4)
LOOPS = Library(
    "bench_stability",
    {
        "stacked": (_stacked, (SIX, FOUR, FOUR, INT)),
        "retracted": (_retracted, (SIX, FOUR, FOUR, INT)),
        "classical": (_classical, (SIX, FOUR, FOUR, INT)),
        "pairs_alone": (_pairs_alone, (FLOATS, FLOATS, FLOATS, FOUR, FLOATS, INT)),
        "in_double_double": (_in_double_double, (WIDES, WIDES, WIDES, INT, BOOL, WIDES)),
    },
)


def _iterated(once: Callable[..., Any], convert: Callable[[Any], Any]) -> Way:
    def way(problem: Problem, counts: list[int]) -> Iterator[tuple[Any, ...]]:
        f, point, step = (tuple(map(convert, part)) for part in (problem.f, problem.start, problem.step))
        done = 0
        for count in counts:
            point = once(f, point, step, count - done)
            done = count
            yield point

    return way


def _with_signs(problem: Problem, counts: list[int]) -> Iterator[tuple[Any, ...]]:
    weights = problem.weights
    f = tuple(map(float, problem.f))
    axes = tuple(map(float, (*problem.a, *weights, 1, 0)))
    point, step = (
        tuple(map(float, (*divisor, *problem.pairs(divisor, w))))
        for divisor, w in ((problem.start, weights), (problem.step, [K.one] * 3))
    )
    done = 0
    for count in counts:
        point = compiled.LIBRARY.march(f, axes, point, step, count - done)
        done = count
        yield point[:4]


def _without_curve(problem: Problem, counts: list[int]) -> Iterator[tuple[Any, ...]]:
    weights, ones = problem.weights, [K.one] * 3
    pairs = np.array([float(x) for x in problem.pairs(problem.start, weights)])
    roots = np.array([float(x) for x in problem.pairs(problem.step, ones)[:3]])
    a, step = np.array([float(x) for x in problem.a]), tuple(map(float, problem.step))
    x, y = pairs[:3].copy(), pairs[3:].copy()
    done = 0
    for count in counts:
        LOOPS.pairs_alone(a, x, y, step, roots, count - done)
        done = count
        others = [(a[i - 1], a[i - 2]) for i in range(3)]
        u0 = sum(x[i] ** 2 * b * c for i, (b, c) in enumerate(others))
        u1 = -sum(x[i] ** 2 * (b + c) for i, (b, c) in enumerate(others))
        v0 = sum(x[i] * y[i] * b * c for i, (b, c) in enumerate(others))
        v1 = -sum(x[i] * y[i] * (b + c) for i, (b, c) in enumerate(others))
        yield float(u0), float(u1), float(v0), float(v1)


def _random_access(problem: Problem, counts: list[int]) -> Iterator[tuple[Any, ...]]:
    """Yields D + [n]D' for each count n separately, by the binary digits of n, from a table of [2^k]D' in floats."""
    f, start = tuple(map(float, problem.f)), tuple(map(float, problem.start))
    table = [tuple(map(float, row)) for row in problem.doubles(max(counts).bit_length())]
    for count in counts:
        point = start
        for k, row in enumerate(table):
            if count >> k & 1:
                point = LOOPS.stacked(f, point, row, 1)
        yield point


def _double_double(retract: bool) -> Way:
    def way(problem: Problem, counts: list[int]) -> Iterator[tuple[Any, ...]]:
        f, point, step = (pack([*part]) for part in (problem.f, problem.start, problem.step))
        done = 0
        for count in counts:
            out = np.empty_like(point)
            LOOPS.in_double_double(f, point, step, count - done, retract, out)
            point, done = out, count
            yield tuple(unpack(point, K.context.mpf))

    return way


WAYS: dict[str, tuple[Way, int, str]] = {
    "stacked": (_iterated(lambda *given: LOOPS.stacked(*given), float), 10**8, "(U, V), both congruences, compiled"),
    "retracted": (
        _iterated(lambda *given: LOOPS.retracted(*given), float),
        10**8,
        "(U, V), put back on the curve every 16",
    ),
    "with signs": (_with_signs, 10**7, "(U, V) with the signs of γ, as the flow steps"),
    "classical": (
        _iterated(lambda *given: LOOPS.classical(*given), float),
        10**8,
        "(U, V), one congruence (classical)",
    ),
    "pairs alone": (_without_curve, 10**6, "pairs (Γ, n) alone, without the curve"),
    "random access": (_random_access, 10**8, "random access from a table of [2^k]D′"),
    "interpreted": (_iterated(_stacked, float), 10**5, "(U, V), both congruences, interpreted"),
    "single precision": (_iterated(_stacked, np.float32), 10**4, "(U, V), single precision"),
    "double-double": (_double_double(False), 10**6, "(U, V), double-double"),
    "double-double, retracted": (_double_double(True), 10**6, "double-double, put back every 16"),
}
"""Name: (the method, the largest number of additions, its label in the figure)."""


def measure(problem: Problem, way: str, counts: list[int], truths: dict[int, Any]) -> list[dict[str, Any]]:
    """Rows (n, error, residual, seconds since the previous row); None where a value is no longer a number."""
    rows = []
    with np.errstate(all="ignore"):
        points, begun = WAYS[way][0](problem, counts), perf_counter()
        for count, point in zip(counts, points, strict=True):
            seconds = perf_counter() - begun
            point = [K.context.mpf(float(x)) if isinstance(x, (float, np.floating)) else x for x in point]
            truth = truths[count]
            size = max(1, *map(abs, truth))
            error = max(abs(x - y) for x, y in zip(point, truth, strict=True)) / size
            found = max(map(abs, retraction.remainder(problem.f, point)[:2])) / max(map(abs, problem.f))
            rows.append({"n": count, "error": finite(error), "residual": finite(found), "seconds": seconds})
            begun = perf_counter()
    return rows


def finite(x: Any) -> float | None:
    """x as a float; None for NaN and numbers of 1e300 or more."""
    return float(x) if abs(x) < 1e300 else None


def slope(rows: list[dict[str, Any]], key: str) -> float | None:
    """The exponent of the growth over the counts where the value is below 10^-2."""
    kept = [(log10(row["n"]), log10(row[key])) for row in rows if row[key] and row[key] < 1e-2]
    return float(np.polyfit(*np.array(kept).T, 1)[0]) if len(kept) >= 3 else None


def run(smoke: bool) -> list[dict[str, object]]:
    """A row for every scene, η and way: error and residual after 10, 100 … additions, and fitted exponents."""
    table: list[dict[str, object]] = []
    last = 4 if smoke else 8
    for name, etas in STEPS.items():
        for eta in etas[:1] if smoke else etas:
            task = problem(name, eta)
            counts = [10**k for k in range(1, last + 1)]
            truths = {count: task.truth(count) for count in counts}
            for way, (_, most, _) in WAYS.items():
                chosen = [n for n in counts if n <= (1000 if smoke and most < 10**6 else most)]
                rows = measure(task, way, chosen, truths)
                if way == "retracted" and not max(r["residual"] or 1 for r in rows) < MOST_RESIDUAL:
                    raise AssertionError(
                        f"{name}, η = {eta}: residual {rows[-1]['residual']} after {rows[-1]['n']} steps"
                    )
                row: dict[str, object] = {"scene": name, "eta": eta, "way": way}
                row |= {f"error {_power(r['n'])}": r["error"] for r in rows}
                row |= {"error ~ n^": slope(rows, "error")}
                row |= {f"residual {_power(r['n'])}": r["residual"] for r in rows}
                row |= {"residual ~ n^": slope(rows, "residual")}
                if way != "random access":
                    row |= {"ns a step": 1e9 * rows[-1]["seconds"] / (chosen[-1] - (chosen[-2] if chosen[1:] else 0))}
                table.append(row)
    return table


def _power(n: int) -> str:
    return f"1e{round(log10(n))}"


def draw(table: list[dict[str, Any]], stem: Path) -> None:
    """Draws the rows of the first η as stem.png and stem.svg: error and residual against the number of additions."""
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot

    # Okabe and Ito's colours, each with its own marker
    styles = dict(zip(
        WAYS,
        (("#0072B2", "o"), ("#332288", "D"), ("#009E73", "^"), ("#D55E00", "s"), ("#CC79A7", "v"), ("#000000", "h"),
         ("#56B4E9", "x"), ("#E69F00", "P"), ("#999999", "*"), ("#555555", "<")), strict=True,
    ))  # fmt: skip
    names = {"S1": "Chaplygin ball (genus 2)", "S2": "Euler top (generalized Jacobian)"}
    figure, panels = pyplot.subplots(2, 2, figsize=(11, 9), sharex=True, sharey="row", layout="constrained")
    for column, (name, title) in enumerate(names.items()):
        for line, (key, label) in enumerate((("error", "error of (U, V)"), ("residual", "|f − V² mod U| / |f|"))):
            panel = panels[line][column]
            for way, (colour, marker) in styles.items():
                row = next(r for r in table if (r["scene"], r["eta"], r["way"]) == (name, STEPS[name][0], way))
                shown = [(n, row.get(f"{key} 1e{n}")) for n in range(1, 9)]
                points = [(10.0**n, max(value, 1e-34)) for n, value in shown if value]
                if points:
                    panel.loglog(
                        *zip(*points, strict=True), color=colour, marker=marker, markersize=6, linewidth=1.3,
                        label=WAYS[way][2], fillstyle="none" if marker in "oD" else "full",
                    )  # fmt: skip
            grid = np.array([1e1, 1e8])
            if key == "error":
                panel.loglog(
                    grid, 1e-16 * grid, color="0.6", linewidth=0.9, linestyle="--", label="10⁻¹⁶·n, to compare"
                )
                panel.set_title(title, fontsize=11)
            else:
                panel.set_xlabel("additions n")
            panel.set_ylim(1e-34, 1e6 if key == "error" else 1e2)
            panel.grid(alpha=0.25)
            panel.set_ylabel(f"{label} (lower is better)" if column == 0 else "")
    figure.legend(*panels[0][0].get_legend_handles_labels(), loc="outside lower center", ncols=3, fontsize=9)
    save(figure, stem)
    pyplot.close(figure)


if __name__ == "__main__":
    command(__doc__, run, draw)
