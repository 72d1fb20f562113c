"""Sums of divisors in floats, of points of any size and of clusters, against sums at hundreds of digits. Columns:
refusals, and the error in units of the effect of the summands' last bits on the sum.

``python -m benchmarks.bench_inexact --sums 2000 --seed 1`` tries that many sums for each row.
"""

from __future__ import annotations

from random import Random
from time import perf_counter
from typing import Any

from jacobian import RR, HyperellipticCurve, PrecisionLoss
from jacobian.terminal import CommandParser
from tests.jacobian.inexact import inexact_oracle as oracle

# every size: |x| in 1e-9 … 1e9; one size: |x| in 0.1 … 10; cluster: points at relative distances of 1e-8 … 1e-1
KINDS = ("every size", "one size", "cluster")
# if the last bits of the summands change a coefficient of the sum by this fraction, they may decide its degree
DECIDED = 1 / 50


def summands(kind: str, genus: int, rng: Random) -> tuple[list[float], list[list[Any]]]:
    """f and the points (x, y) of two divisors of up to g points."""
    low, high = {"every size": (-9.0, 9.0), "one size": (-1.0, 1.0), "cluster": (-1.0, 1.0)}[kind]
    f = [rng.uniform(0.5, 4)]
    for _ in range(2 * genus + 1):
        root = -(10 ** rng.uniform(low, high))
        f = [a - root * b for a, b in zip([0.0, *f], [*f, 0.0], strict=True)]
    wide, found = [oracle.wide(c) for c in f], []
    middle = 10 ** rng.uniform(low, high)
    count, other = rng.randint(1, genus), rng.randint(1, genus)
    while len(found) < count + other:
        if kind == "cluster":
            x = middle * (1 + rng.uniform(-1, 1) * 10 ** rng.uniform(-8, -1))
        else:
            x = 10 ** rng.uniform(low, high) * rng.choice((1, 1, -1))
        square = oracle.value(wide, oracle.wide(x))
        if square > 0 and all(x != known for known, _ in found):
            found.append((oracle.wide(x), rng.choice((1, -1)) * oracle.WIDE.sqrt(square)))
    return f, [found[:count], found[count:]]


def outcome(f: list[float], parts: list[list[Any]], genus: int, rng: Random) -> tuple[str, float, float]:
    """The outcome of a sum as a word, the error in units of the sum's conditioning, and the seconds taken."""
    J = HyperellipticCurve(RR, f).jacobian()
    try:
        D, E = (J.from_points([(float(x), float(y)) for x, y in points]) for points in parts)
    except PrecisionLoss:
        return "points refused", 0.0, 0.0
    begin = perf_counter()
    try:
        found = D + E
    except PrecisionLoss:
        return "sum refused", 0.0, perf_counter() - begin
    seconds = perf_counter() - begin
    wide, eps = [oracle.wide(c) for c in f], oracle.wide(RR.eps)
    exact, shift = oracle.conditioning(wide, genus, parts, eps, rng)
    if len(found.u) != len(exact[0]) or shift is None:
        m = len(exact[0])
        decided = shift and all(
            by < DECIDED * abs(c)
            for by, c in zip([*shift[: m - 1], *shift[m:]], [*exact[0][:-1], *exact[1]], strict=True)
        )
        return ("wrong" if decided else "undecided"), 0.0, seconds
    error = oracle.share((found.u, found.v), exact, shift, eps)
    return ("right" if error < 1e4 else "wrong"), error, seconds


def run(smoke: bool, sums: int = 200, seed: int = 0) -> list[dict[str, object]]:
    """A row for each genus and each kind of summands."""
    table: list[dict[str, object]] = []
    for genus in (2, 3) if smoke else (2, 3, 4, 5, 6):
        for kind in KINDS:
            rng = Random(f"{kind} {genus} {seed}")
            found = [outcome(*summands(kind, genus, rng), genus, rng) for _ in range(4 if smoke else sums)]
            names = [name for name, _, _ in found]
            if "wrong" in names:
                raise AssertionError(f"genus {genus}, {kind}: sum {names.index('wrong')} of seed {seed} is wrong")
            errors = sorted(error for name, error, _ in found if name == "right") or [0.0]
            row: dict[str, object] = {"genus": genus, "points": kind, "sums": len(found)}
            row |= {name: names.count(name) for name in ("right", "undecided", "points refused", "sum refused")}
            row |= {"median error": errors[len(errors) // 2], "worst": errors[-1]}
            table.append(row | {"slowest, ms": 1e3 * max(seconds for _, _, seconds in found)})
    return table


if __name__ == "__main__":
    parser = CommandParser(description=__doc__)
    parser.add_argument("--sums", type=int, default=200)
    parser.add_argument("--seed", type=int, default=0)
    arguments = parser.parse_args()
    for row in run(False, arguments.sums, arguments.seed):
        print(row, flush=True)
