"""``python -m jacobian compile``: compile the kernels now, so that no later run waits for it."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence

from jacobian.errors import ArgumentError
from jacobian.terminal import write_anything


def main(arguments: Sequence[str] | None = None) -> int:
    """The command line of the engine; returns the exit status."""
    parser = argparse.ArgumentParser(prog="python -m jacobian", description="Arithmetic in hyperelliptic Jacobians.")
    write_anything()
    commands = parser.add_subparsers(dest="command", required=True)
    commands.add_parser("compile", help="compile the kernels into numba's cache, and say how long each took")
    parser.parse_args(arguments)

    from jacobian.compilation import compile_all
    from jacobian.numbers.compiler import interpreted, look_for_a_place

    try:
        if interpreted():
            raise ArgumentError("NUMBA_DISABLE_JIT is set: nothing is to be compiled")
        look_for_a_place(needed=True)
    except ArgumentError as error:
        print(f"jacobian: error: {error}", file=sys.stderr)
        return 2
    for name, seconds in compile_all():
        print(f"{seconds:8.2f} s  {name}", flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
