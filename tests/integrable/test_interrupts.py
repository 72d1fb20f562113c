"""Ctrl-C: from the moment the handler is installed it gives one line and exit code 130, whatever is running, and leaves
nothing behind.
"""

import os
import signal
import subprocess
import sys

import pytest

from jacobian.interrupts import shielded
from tests.fuzz.outside import COMMANDS, LISTENING, interrupted

pytestmark = pytest.mark.skipif(os.name != "posix", reason="an interrupt of one process is sent to a process of POSIX")


@pytest.mark.parametrize("command", COMMANDS)
def test_at_once(command):
    """An interrupt right after the handler is installed: one line, exit code 130, nothing left behind.

    In the first quarter of a second, interrupts used to give tracebacks or exit code −2, or had no effect.
    """
    found = interrupted(command, 0.0, group=True)
    name = command.split()[0].rpartition(".")[2]
    assert (found.code, found.err, found.out, found.left) == (130, f"{name}: interrupted\n", "", [])


@pytest.mark.parametrize(
    "delay", [0.05, pytest.param(0.15, marks=pytest.mark.slow), 0.4, pytest.param(2.0, marks=pytest.mark.slow)]
)
@pytest.mark.parametrize("executor", ["threads", "processes"])
def test_a_sweep(executor, delay):
    """A sweep stops without tracebacks of its workers; threads used to continue for six seconds."""
    command = f"integrable sweep chaplygin --vary d=0:1:100000 --chunk 5000 --out out.zarr --executor {executor}"
    found = interrupted(command, delay, group=True)
    assert (found.code, found.err, found.out) == (130, "integrable: interrupted\n", "")
    assert set(found.left) <= {"out.zarr.part"}


ODD = """
import sys, time
from jacobian.interrupts import leave, stand
stand("odd")
class Loud:
    def __del__(self):
        print("up", flush=True)
        {inside}
{work}
leave(0)
"""
WAIT = "time.sleep(60)"
LOST = {
    "in a destructor": ("Loud()", WAIT),
    "taken for something else": (
        f"try:\n    print('up', flush=True); {WAIT}\nexcept BaseException: raise ImportError",
        "",
    ),
    "caught": (f"while True:\n    try:\n        print('up', flush=True); {WAIT}\n    except BaseException: pass", ""),
    "in a thread": (
        f"import threading\nthreading.Thread(target=lambda: {WAIT}).start(); print('up', flush=True); {WAIT}",
        "",
    ),
    "in a worker": (
        "from integrable.sweeps.orphans import processes\nwith processes(2) as pool:\n"
        "    pool.submit(pow, 2, 2).result()\n    print('up', flush=True)\n    pool.submit(time.sleep, 60).result()",
        "",
    ),
}


def interrupted_when_up(program):
    """(exit code, stderr) of a program that is interrupted, with its group, once it has written "up"."""
    running = subprocess.Popen(
        [sys.executable, "-c", LISTENING + program],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        start_new_session=True,
    )
    try:
        assert running.stdout.readline() == b"up\n"
        os.killpg(running.pid, signal.SIGINT)
        _, err = running.communicate(timeout=60)
    finally:
        running.kill()
    return running.returncode, err


@pytest.mark.parametrize("what", LOST)
def test_no_interrupt_is_lost(what):
    work, inside = LOST[what]
    program = ODD.format(work=work, inside=inside or "pass")
    assert interrupted_when_up(program) == (130, b"odd: interrupted\n")


IGNORED = """
import os, signal
from jacobian.interrupts import leave, stand
signal.signal(signal.SIGINT, signal.SIG_IGN)
stand("x")
os.kill(os.getpid(), signal.SIGINT)
print("on")
leave(3)
"""


def test_what_these_tests_start_listens_where_they_themselves_ignore_interrupts():
    """Under ``nohup`` the tests failed, after ten minutes of waiting for processes that did not end."""
    before = signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        assert interrupted("integrable scenes", 0.0, group=True).code == 130
    finally:
        signal.signal(signal.SIGINT, before)


def test_interrupts_that_are_ignored_stay_so():
    """As under ``nohup``, or in a command started with &."""
    done = subprocess.run([sys.executable, "-c", IGNORED], capture_output=True, text=True, timeout=60, check=False)
    assert (done.returncode, done.stdout, done.stderr) == (3, "on\n", "")


def test_a_process_that_is_started_behind_a_shield_sees_no_interrupt():
    program = "import os, signal; os.kill(os.getpid(), signal.SIGINT); print('on')"
    with shielded():
        done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, timeout=60, check=False)
    assert (done.returncode, done.stdout, done.stderr) == (0, "on\n", "")
    assert signal.SIGINT not in signal.pthread_sigmask(signal.SIG_BLOCK, ())


SLOW_END = """
import os, time
from jacobian.interrupts import leave, stand
stand("odd")
class Last:
    def __del__(self, sleep=time.sleep, write=os.write):
        write(1, b"up\\n")
        sleep(0.5)
last = Last()
leave(0)
"""


def test_a_command_that_is_over_is_not_killed():
    """Python's shutdown restores the default handler: a signal in the last 20 ms used to give exit code −2."""
    assert interrupted_when_up(SLOW_END) == (0, b"")
