"""Calls that may take long: each is fast, is refused, or announces how long it takes; Ctrl-C ends it within a second.

The signals are real. Seconds are processor time, since other work delays a process.
"""

import os
import signal
import subprocess
import sys
import time

import pytest

from tests.fuzz.outside import LISTENING

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(not os.path.exists("/proc/self/stat"), reason="processor time of a running process"),
]

QUINTIC = "C = HyperellipticCurve(QQ, [1, 2, 0, 0, 0, 1]); D = C.jacobian().from_points([(0, 1)])"
STATE = "(.48, .6, .64), (.384, 1.28, -1.488)"
WORDS = '("0.48", "0.6", "0.64"), ("0.384", "1.28", "-1.488")'
HEAVY = f"b = ChaplyginBall((1e-4, 1, 1.00001), 1e3); flow = b.flow(b.state({STATE}))"
# the set-up, the call
CALLS = {
    "multiple of a function": (
        "from jacobian.relatives.formal_sum import principal_divisor; "
        "C = HyperellipticCurve(GF(101), [1, 0, 0, 0, 0, 1])",
        "10**9 * principal_divisor(C, [0, 1], [1])",
    ),
    "points of large height": (QUINTIC, "next(iter(C.points(1000)))"),
    "rational torsion": (QUINTIC, "C.jacobian().rational_torsion(1000)"),
    "height to many digits": (
        f"{QUINTIC}; from jacobian.relatives.heights import canonical_height", "canonical_height(D, digits=1000)",
    ),
    "large extension": ("", "GF(3, 500)"),
    "large extension of a long prime": ("", "GF(2**61 - 1, 300)"),
    "order in genus 1": ("C = HyperellipticCurve(GF(2**70 + 25), [3, 5, 0, 1])", "C.jacobian().order()"),
    "order over GF(2^20)": ("C = HyperellipticCurve(GF(2, 20), [1, 0, 0, 3, 0, 1], [1, 1])", "C.jacobian().order()"),
    "primes of bad reduction": ("C = HyperellipticCurve(QQ, [10**40 + 7, 10**39 + 9, 0, 0, 0, 1])", "C.bad_primes()"),
    "large genus": (
        "J = HyperellipticCurve(GF(101), [1] + 2000 * [0] + [1]).jacobian(); from random import Random",
        "J.random(Random(1))",
    ),
    "many points": (QUINTIC, "C.jacobian().from_points([(0, 1)] * 10**6)"),
    "equal points": (QUINTIC, "C.jacobian().from_points([(0, 1)] * 2000)"),
    "all classes": ("J = HyperellipticCurve(GF(2**31 - 1), [1, 0, 0, 0, 0, 1]).jacobian()", "list(J.points())"),
    "fewer classes": ("J = HyperellipticCurve(GF(31607), [1, 0, 0, 0, 0, 1]).jacobian()", "list(J.points())"),
    "all points": ("C = HyperellipticCurve(GF(2**61 - 1), [1, 0, 0, 0, 0, 1])", "list(C.points())"),
    "multiple of 100000 digits": (
        "D = HyperellipticCurve(QQ, [1, 0, 0, 0, 0, 1]).jacobian().from_points([(0, 1)])", "(10**100000) * D",
    ),
    "far time": (
        f'b = ChaplyginBall(("1", "2", "3"), "0.7", field=MP(30)); flow = b.flow(b.state({WORDS}))', "flow.at(1e308)",
    ),
    "sensitivity of a heavy ball": (HEAVY, "flow.sensitivity(1e5)"),
    "sensitivity to many digits": (
        f'b = ChaplyginBall(("1", "2", "3"), "1000", field=MP(30)); flow = b.flow(b.state({WORDS}))',
        "flow.sensitivity(1e5)",
    ),
    "enclosure of a heavy ball": (HEAVY, "flow.enclosure(1e3)"),
    "enclosure of a deformation": (
        "b = Tilde((1, 2, 4), .5, potential=(0, 0, .02, .04, .06)); "
        "flow = b.motion_through(b.state((.48, .6, .64), (76.8, 256, -297.6)))",
        "flow.enclosure(1.0)",
    ),
}  # fmt: skip
PROGRAM = """
import warnings
from jacobian import *
from integrable import *
{before}
print("begun", flush=True)
try:
    {call}
except KeyboardInterrupt:
    print("interrupted")
except JacobianError as error:
    print("refused", error)
else:
    print("quick")
"""
# processor seconds until the signal, and after it: on a machine half as fast as others a call may end after 4.4
# without a message
BEFORE, AFTER = 8.0, 1.0


def spent(pid: int) -> float:
    """The processor seconds of a running process."""
    with open(f"/proc/{pid}/stat") as file:
        fields = file.read().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


@pytest.mark.parametrize("what", CALLS)
def test_a_long_call_speaks_and_stops(what):
    before, call = CALLS[what]
    running = subprocess.Popen(
        [sys.executable, "-c", LISTENING + PROGRAM.format(before=before, call=call)],
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
    )  # fmt: skip
    try:
        assert running.stdout.readline() == "begun\n"
        start = spent(running.pid)
        while running.poll() is None and spent(running.pid) < start + BEFORE:
            time.sleep(0.05)
        if running.poll() is None:
            struck = spent(running.pid)
            running.send_signal(signal.SIGINT)
            while running.poll() is None and spent(running.pid) < struck + AFTER:
                time.sleep(0.02)
            assert running.poll() is not None, "still at work"
        out, err = running.stdout.read(), running.stderr.read()
    finally:
        running.kill()
        running.wait()
        running.stdout.close(), running.stderr.close()
    assert out.split()[0] in ("quick", "refused") or (out == "interrupted\n" and " s left" in err), (out, err)
