"""After a command has called :func:`stand`, Ctrl-C ends it with one line and exit code 130.

A command calls :func:`stand` before it imports anything but this file and the two packages: some 12 ms after the
process begins, of which Python takes 9. Python handles an earlier interrupt. The command ends with :func:`leave`.

The interrupt raises an exception in the main thread, which cleans up. But an exception raised in a callback is lost,
in an import it may be replaced by another, and it is delayed until compiled code returns and other threads end. So a
separate thread receives the signal too. This thread prints the line, silences later output, and ends the process when
the main thread takes too long.
"""

from __future__ import annotations

import _signal  # type: ignore[import-not-found]  # importing signal takes as long as all other imports
import os
import sys
from _thread import allocate_lock, start_new_thread
from time import sleep

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, NoReturn

__all__ = ["leave", "shielded", "stand"]

CODE = 130
SAYING, MOMENT = 0.1, 0.7
"""The seconds allowed for printing the line, and for the main thread's clean-up, so that every command ends within a
second.
"""


class _Standing:
    """What the handler of interrupts knows: the command's name, whether its work is ``over``, locks for printing."""

    name = ""
    over = False
    said, silent = allocate_lock(), allocate_lock()


def stand(name: str) -> None:
    """From now on an interrupt ends the command ``name``, unless the caller ignores interrupts (nohup)."""
    if _signal.getsignal(_signal.SIGINT) is not _signal.default_int_handler:
        return
    _Standing.name = name
    _Standing.silent.acquire()
    sys.excepthook = _hook
    if os.name == "posix":
        seen, woken = os.pipe()
        os.set_blocking(woken, False)
        start_new_thread(_watch, (seen,))
        _signal.set_wakeup_fd(woken, warn_on_full_buffer=False)
    _signal.signal(_signal.SIGINT, _interrupt)


def leave(code: int) -> NoReturn:
    """Ends the command; after an interrupt at once, without waiting for threads that still compute."""
    _Standing.over = True
    if code == CODE or _Standing.said.locked():
        _say()
        _end()
    if _signal.getsignal(_signal.SIGINT) is _interrupt:
        import atexit

        # Python's shutdown restores the default handler, with which an interrupt would kill the finished process
        atexit.register(_signal.signal, _signal.SIGINT, _signal.SIG_IGN)
    sys.exit(code)


def _end() -> NoReturn:
    """Ends the process without Python's own shutdown, which joins threads, but releases the resources of
    :mod:`multiprocessing`.
    """
    import atexit

    try:
        atexit._run_exitfuncs()
    finally:
        os._exit(CODE)


def _watch(seen: int) -> None:
    while _signal.SIGINT not in os.read(seen, 64):
        pass
    _say()
    if not _Standing.over:
        sleep(MOMENT)
    os._exit(CODE)


def _interrupt(*_: Any) -> None:
    _say()
    if _Standing.over:
        os._exit(CODE)
    raise KeyboardInterrupt


def _say() -> None:
    """Prints the line ``name: interrupted`` once; afterwards no thread and no library can write."""
    if not _Standing.name:
        return
    if not _Standing.said.acquire(blocking=False):
        # another thread is writing the line, which must not be cut off
        _Standing.silent.acquire(timeout=SAYING)
        return
    # this clears the terminal's line, which may show a progress bar
    clear = "\r\x1b[K" if os.isatty(2) else ""
    try:
        os.write(2, f"{clear}{_Standing.name}: interrupted\n".encode())
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, 1)
        os.dup2(nowhere, 2)
    except OSError:
        # the caller has closed the output
        pass
    _Standing.silent.release()


def _hook(*error: Any) -> None:
    if _Standing.said.locked():
        _end()
    sys.__excepthook__(*error)


class shielded:
    """A context in which started processes do not receive interrupts: an interrupt ends their parent, and the parent
    ends them.
    """

    def __enter__(self) -> None:
        import signal

        self._mask: Any = None
        if hasattr(signal, "pthread_sigmask"):
            self._mask = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})

    def __exit__(self, *_: object) -> None:
        import signal

        if self._mask is not None:
            signal.pthread_sigmask(signal.SIG_SETMASK, self._mask)
