"""The flow at 30 to 1000 digits compared with integrators of any precision: processor seconds, error against more
digits.
"""

from __future__ import annotations

import subprocess
import sys
from time import process_time
from typing import Any

from integrable import load_scene
from integrable.motion.precise import PreciseFlow
from integrable.oracles.methods import METHODS
from integrable.study.timing import TooLong, at_most
from jacobian import MP

DIGITS = (30, 50, 100, 200, 500, 1000)
# seconds after which a peer is given up
PATIENCE = 60
# the run to which errors refer has this many digits more
MORE = 20

# a script that prints its seconds, without Python's start, and the largest difference of γ and M from its input
TAYLOR = """
import sys
from time import process_time
from math import exp
import flint
digits, T = int(sys.argv[1]), int(sys.argv[2])
flint.ctx.dps = digits + 10
arb = flint.arb
I, d = [arb(x) for x in (1, 2, 3)], arb("0.7")
a = [1 / (x + d) for x in I]
y = [arb(x) for x in ("0.48", "0.6", "0.64", "0.384", "1.28", "-1.488")]
order = int(1.2 * digits) + 8
def series(y):
    # g and M as Taylor series by their recurrences: N = d(g, AM)/(1 - d(g, Ag)) = P/Q, w = AM + N*Ag
    g, M = [[x] for x in y[:3]], [[x] for x in y[3:]]
    P, Q, N, w = [], [], [], [[], [], []]
    def product(x, z, k):
        return sum((x[i] * z[k - i] for i in range(k + 1)), arb(0))
    for k in range(order):
        P.append(d * sum((a[i] * product(g[i], M[i], k) for i in range(3)), arb(0)))
        Q.append((1 if k == 0 else 0) - d * sum((a[i] * product(g[i], g[i], k) for i in range(3)), arb(0)))
        N.append((P[k] - sum((Q[k - i] * N[i] for i in range(k)), arb(0))) / Q[0])
        for i in range(3):
            w[i].append(a[i] * (M[i][k] + product(N, g[i], k)))
        for v in (g, M):
            new = [product(v[i - 2], w[i - 1], k) - product(v[i - 1], w[i - 2], k) for i in range(3)]
            for i in range(3):
                v[i].append(new[i] / (k + 1))
    return g + M
t = arb(0)
start = process_time()
while t < T:
    y = [x.mid() for x in y]
    rows = series(y)
    # Jorba & Zou 2005: the radius from the last coefficients, a step of radius/e^2
    size = max(max(abs(r[-1]), abs(r[-2])) for r in rows)
    h = arb(float((1 / size) ** (arb(1) / order)) / exp(2)).mid()
    h = min(h, T - t)
    y = [flint.arb_poly(r)(h) for r in rows]
    t = (t + h).mid()
seconds = process_time() - start
truth = [arb(x) for x in sys.stdin.read().split()]
print(seconds, max(abs(x - z) for x, z in zip(y, truth)).mid().str(3, radius=False))
"""


def run(smoke: bool) -> list[dict[str, object]]:
    """Rows: seconds of set-up and of one state, its error against a run with MORE digits; peers at the same digits."""
    rows: list[dict[str, object]] = []
    cases = [(30, 1)] if smoke else [*((digits, 10) for digits in DIGITS), (50, 1000), (200, 1000)]
    for digits, T in cases:
        rows.append(_ours(digits, T))
        if T <= 10:
            rows.extend(_peers(digits, T, 10 if smoke else PATIENCE))
    rows.extend(_enclosures(smoke))
    return rows


def _ours(digits: int, T: int) -> dict[str, object]:
    seconds = []
    for _ in range(3 if digits <= 200 else 1):
        body, state = load_scene("chaplygin").start(digits)
        start = process_time()
        flow = body.flow(state)
        ready = process_time()
        found = flow.at([T])
        done = process_time()
        seconds.append((ready - start, done - ready))
    # the run with more digits begins from the same start, rounded to the digits of the measured run
    K = MP(digits + MORE)
    more = PreciseFlow(body.body, state, K.dps)
    gamma, M = more.vectors(more.at([T])[1])[0]
    truth = (*gamma, *M)
    error = max(abs(K.coerce(x) - y) for x, y in zip((*found.gamma[0], *found.M[0]), truth, strict=True))
    setup, state_seconds = (min(column) for column in zip(*seconds, strict=True))
    return _row("flow", digits, T, setup, state_seconds, K.context.nstr(error, 3))


def _row(run: str, digits: int, T: int, setup: object, state: object, error: str) -> dict[str, object]:
    return {"run": run, "digits": digits, "T": T, "set-up [s]": setup, "state [s]": state, "error": error}


def _truth(digits: int, T: int) -> tuple[list[Any], Any]:
    """γ and M from the exact decimals of the start, as for the peers."""
    body, state = load_scene("chaplygin").start(digits + MORE)
    run = body.flow(state).at([T])
    return [*run.gamma[0], *run.M[0]], MP(digits + MORE)


def _peers(digits: int, T: int, patience: float) -> list[dict[str, object]]:
    truth, K = _truth(digits, T)
    text = " ".join(K.context.nstr(x, digits + MORE) for x in truth)

    def odefun() -> tuple[float, str]:
        body, state = load_scene("chaplygin").start(digits + 5)
        start = process_time()
        with at_most(patience):
            found = METHODS["mpmath odefun"].solve(body, state, [T], digits)
        seconds = process_time() - start
        gaps = (abs(K.coerce(x) - y) for x, y in zip((*found.gamma[0], *found.M[0]), truth, strict=True))
        return seconds, K.context.nstr(max(gaps), 3)

    def series() -> tuple[float, str]:
        command = [sys.executable, "-c", TAYLOR, str(digits), str(T)]
        options: dict[str, Any] = {"capture_output": True, "text": True, "check": True}
        seconds, error = subprocess.run(command, input=text, timeout=patience, **options).stdout.split()
        return float(seconds), error

    rows = []
    for name, peer in (("mpmath.odefun", odefun), ("Taylor series in python-flint", series)):
        try:
            rows.append(_row(name, digits, T, "", *peer()))
        except (TooLong, subprocess.TimeoutExpired):
            rows.append(_row(name, digits, T, "", f"given up after {patience:g}", ""))
    return rows


def _enclosures(smoke: bool) -> list[dict[str, object]]:
    rows: list[dict[str, object]] = []
    # digits, time, and whether it is t and not τ
    cases = (30, 10, True), (50, 10, True), (50, 10, False), (50, 1000, False), (200, 10, False)
    for digits, place, at in ((20, 2, True),) if smoke else cases:
        body, state = load_scene("chaplygin").start(digits)
        flow = body.flow(state)
        start = process_time()
        found = flow.enclosure([place]) if at else flow.enclosure_at_tau([place])
        name = "enclosure at t" if at else "enclosure at τ"
        seconds = process_time() - start
        rows.append(_row(name, digits, place, "", seconds, f"radius {found.radius[0]:.1e}"))
    return rows
