"""Fuzz of outside influences: other parameters under one name, files that cannot be written, interrupts."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from fractions import Fraction
from random import Random
from tempfile import TemporaryDirectory
from typing import Any, NamedTuple

from tests.fuzz.case import Case, Complaint
from tests.fuzz.run import Suite

SETUP = "from fractions import Fraction\nfrom integrable import *\nfrom integrable.files.quantities import stamp\n"
SETUP += "from jacobian import *\n"
MADE = {
    "ChaplyginBall": ("inertia", "d", "radius"), "EulerTop": ("inertia",), "Tilde": ("inertia", "d", "potential"),
    "Check": ("inertia", "potential"), "Hat": ("inertia", "potential"), "Gyroscopic": ("inertia", "c"),
    "RigidBody": ("inertia",), "RollingBall": ("inertia", "mass", "radius"),
}  # fmt: skip
NUMBERS = {"inertia": 3, "potential": 5}
FIELDS = ("RR", "RR", "RR", "MP(20)", "MP(50)", "QQ", "GF(2**61 - 1)")


def stamp(rng: Random) -> Case:
    """Two systems that differ in one number, by one part in 10 … 10¹²."""
    name = rng.choice(list(MADE))
    laboratory = name in ("RigidBody", "RollingBall")
    K = rng.choice(FIELDS[:5] if laboratory else FIELDS)
    least = 3 if laboratory else 1
    given = {
        key: [Fraction(rng.randrange(10**6, 2 * 10**6), 10**6) + least for _ in range(NUMBERS.get(key, 1))]
        for key in MADE[name]
    }
    key = rng.choice(list(given))
    other = {**given, key: list(given[key])}
    at = rng.randrange(len(other[key]))
    other[key][at] *= 1 + Fraction(1, 10 ** rng.randint(1, 12))
    setup = f"{SETUP}import warnings\nwarnings.simplefilter('ignore')\n"
    setup += f"a, b = {_call(name, given, K)}, {_call(name, other, K)}"
    call = "[stamp(a) == stamp(b), a == b, eval(repr(a)) == a, eval(repr(b)) == b, stamp(eval(repr(b))) == stamp(b)]"
    wanted = "[False, False, True, True, True]"
    why = "not the stamps, or no repr that makes the system"
    judge = lambda names: None if repr(names["got"]) == wanted else Complaint(why, wanted, "got == expected")  # noqa: E731
    return Case(setup, call, judge, ())


def _call(name: str, given: dict[str, list[Fraction]], K: str) -> str:
    words = [f"{key}={_numbers(values, key in NUMBERS)}" for key, values in given.items()]
    return f"{name}({', '.join(words)}, field={K})"


def _numbers(values: list[Fraction], many: bool) -> str:
    texts = [f"'{x}'" for x in values]
    return f"({', '.join(texts)})" if many else texts[0]


class Ended(NamedTuple):
    """How a process ended, and the files it left in its folder."""

    code: int
    out: str
    err: str
    left: list[str]
    seconds: float


LIMITED = """
import resource, sys
import numpy as np
from integrable import EulerTop, ensemble, sweep
from jacobian import JacobianError
count, chunk, limit, name = int(sys.argv[1]), int(sys.argv[2]), int(sys.argv[3]), sys.argv[4]
many = ensemble(EulerTop((1, 2, 3)), (.48, .6, .64), np.tile((.384, 1.28, -1.488), (count, 1)))
if name.startswith("saved"):
    run = many.at([0, 1.0])
    act = lambda: run.save(name)
else:
    act = lambda: sweep(many, times=[0, 1.0], out=name, executor="threads", chunk=chunk)
many.at([0, 1.0])
# a limit would cut short what Python keeps of imported modules as well, for every process after this one
sys.dont_write_bytecode = True
soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
resource.setrlimit(resource.RLIMIT_FSIZE, (limit, hard))
try:
    act()
except JacobianError as error:
    assert "cannot be written: " in str(error) and "\\n" not in str(error), error
    print("refused")
resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))
act()
"""


def limited(*words: str) -> Ended:
    """A sweep or a file under a limit of file sizes, and then without the limit."""
    with TemporaryDirectory() as place:
        begun = time.monotonic()
        done = subprocess.run(
            [sys.executable, "-c", LIMITED, *words], capture_output=True, text=True, timeout=300, check=False, cwd=place
        )
        return Ended(done.returncode, done.stdout, done.stderr, sorted(os.listdir(place)), time.monotonic() - begun)


def limit(rng: Random) -> Case:
    """A limit between no byte and more than are needed."""
    files = ("sweep.h5", "sweep.h5", "sweep.zarr", "saved.h5", "saved.nc", "saved.csv", "saved.mat", "saved.zarr")
    name = rng.choice(files)
    count = rng.choice([1, 7, 50, 400])
    most = 300 + 200 * count
    words = [count, rng.randint(1, count), rng.choice([0, 1, rng.randrange(most), rng.randrange(most)]), name]
    setup, call = "from tests.fuzz.outside import limited", f"limited({', '.join(repr(str(x)) for x in words)})"
    wanted = f"(got.code, got.err, got.left) == (0, '', [{name!r}])"
    return Case(setup, call, _expects("one named error, and the file when there is room", wanted), (), limit=60.0)


COMMANDS = (
    "integrable scenes", "integrable --version", "integrable run chaplygin", "integrable run toda --no-plots",
    "integrable run finite_field", "integrable view chaplygin", "integrable sweep chaplygin --vary d=0:1:2000",
    "integrable sweep chaplygin --vary d=0:1:2000 --executor threads", "integrable report --quick --jobs 2",
    "jacobian compile", "benchmarks --list", "tests.fuzz command --cases 20",
)  # fmt: skip
# under nohup, or in the background of a script, a test run ignores interrupts, and so would its children
LISTENING = """
import signal
signal.signal(signal.SIGINT, signal.default_int_handler)
"""
# the interrupt waits until the command has installed its handler: before that Python and the packages are being loaded
STARTED = """
import os, runpy, sys
import integrable
import jacobian.interrupts as interrupts
stand, known = interrupts.stand, set(sys.modules)
def standing(name):
    more = set(sys.modules) - known - {"benchmarks", "jacobian.__main__", "tests", "tests.fuzz"}
    assert more <= {"integrable.__main__"}, more
    stand(name)
    signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGINT})
interrupts.stand = standing
sys.argv = sys.argv[1:]
signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
os.write(1, b".")
if sys.argv[0] == "integrable":
    integrable._command()
runpy.run_module(sys.argv[0], run_name="__main__", alter_sys=True)
"""


def interrupted(command: str, delay: float, group: bool) -> Ended:
    """A command that is interrupted after ``delay`` seconds, alone or, as by a terminal, with its process group."""
    with TemporaryDirectory() as place:
        words = [sys.executable, "-c", LISTENING + STARTED, *command.split()]
        running = subprocess.Popen(
            words, stdout=subprocess.PIPE, stderr=subprocess.PIPE, cwd=place, start_new_session=True,
            env={**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)},
        )  # fmt: skip
        try:
            assert running.stdout is not None
            os.read(running.stdout.fileno(), 1)
            time.sleep(delay)
            begun = time.monotonic()
            if running.poll() is None:
                (os.killpg if group else os.kill)(running.pid, signal.SIGINT)
            out, err = running.communicate(timeout=120)
        finally:
            running.kill()
        took = time.monotonic() - begun
        return Ended(running.returncode, out.decode(), err.decode(), sorted(os.listdir(place)), took)


# other work delays a process
SECONDS = 3.0


def interrupt(rng: Random) -> Case:
    """Interrupts at once, in the first tenth of a second, or later."""
    command = rng.choice(COMMANDS)
    delay = rng.choice([0.0, rng.random() / 100, rng.random() / 10, rng.random() / 2, 4 * rng.random()])
    call = f"interrupted({command!r}, {round(delay, 4)}, {rng.random() < 0.5})"
    name = command.split()[0].rpartition(".")[2]
    stopped = f"(got.code, got.err) == (130, {name + ': interrupted' + chr(10)!r}) and got.seconds < {SECONDS}"
    whole = "got.code == 0"
    return Case(
        "from tests.fuzz.outside import interrupted", call, _expects("one line and 130", f"({stopped}) or {whole}"), (),
        limit=60.0,
    )  # fmt: skip


def _expects(why: str, check: str) -> Any:
    return lambda names: None if eval(check, {"got": names["got"]}) else Complaint(why, repr(why), check)


SUITE = Suite("outside", {"stamp": stamp, "limit": limit, "interrupt": interrupt}, {"stamp": 4})
