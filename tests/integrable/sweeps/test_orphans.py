"""Worker processes end with the process that started them, in whatever way it ends."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

# starts two workers, prints their ids, and does nothing more
POOL = """
import os, time
from integrable.sweeps.sweep import _pool
from jacobian.numbers.threads import set_threads

if __name__ == "__main__":
    set_threads(2)
    with _pool("processes", 2) as (pool, _):
        found = [pool.submit(os.getpid) for _ in range(2)]
        [one.result() for one in found]
        print(*pool._processes, flush=True)
        time.sleep(60)
"""
# like a worker of a study busy with its row
WORKER = """
import multiprocessing
import os
import time
from integrable.study import runner

class Stuck:
    def recv(self):
        print(os.getpid(), flush=True)
        time.sleep(60)

if __name__ == "__main__":
    worker = multiprocessing.get_context("spawn").Process(target=runner._work, args=(Stuck(),))
    worker.start()
    time.sleep(60)
"""


def runs(process: int) -> bool:
    """Whether the process exists and is no zombie."""
    try:
        return Path(f"/proc/{process}/stat").read_text().rsplit(")", 1)[1].split()[0] != "Z"
    except OSError:
        return False


@pytest.mark.skipif(not Path("/proc/self").is_dir(), reason="processes are looked up in /proc")
@pytest.mark.parametrize("script", [POOL, WORKER], ids=["pool", "worker"])
def test_workers_end_with_their_parent(script, tmp_path) -> None:
    path = tmp_path / "script.py"
    path.write_text(script)
    with subprocess.Popen([sys.executable, str(path)], stdout=subprocess.PIPE, text=True) as parent:
        assert parent.stdout is not None
        workers = [int(word) for word in parent.stdout.readline().split()]
        assert workers
        assert all(map(runs, workers))
        parent.send_signal(signal.SIGKILL)
    until = time.monotonic() + 60
    while any(map(runs, workers)) and time.monotonic() < until:
        time.sleep(0.01)
    left = [worker for worker in workers if runs(worker)]
    for worker in left:
        os.kill(worker, signal.SIGKILL)
    assert not left
