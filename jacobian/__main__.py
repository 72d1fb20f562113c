"""``python -m jacobian compile`` compiles the kernels now, so that no later run waits. ``sato-tate`` computes the
L-polynomials of a curve over QQ, and ``page`` reports its points, torsion, periods, L-polynomials and endomorphisms.
"""

from __future__ import annotations

from jacobian.interrupts import leave, stand

if __name__ == "__main__":
    stand("jacobian")

import sys
from collections.abc import Sequence

from jacobian.arithmetic import command
from jacobian.errors import ArgumentError, JacobianError
from jacobian.page import command as page_command
from jacobian.terminal import CommandParser, write_anything


def main(arguments: Sequence[str] | None = None) -> int:
    """Runs the command line and returns the exit status."""
    parser = CommandParser(prog="python -m jacobian", description="Arithmetic in hyperelliptic Jacobians.")
    write_anything()
    commands = parser.add_subparsers(dest="command", required=True, metavar="COMMAND")
    commands.add_parser("compile", help="compile all loops, keep them on disk, and say how long each library took")
    sato_tate = "L-polynomials at all primes up to a bound, their moments and the Sato–Tate groups that fit"
    command.add_arguments(commands.add_parser("sato-tate", help=sato_tate, description=sato_tate))
    page = "what is known of a curve over QQ: points, torsion, periods, L-polynomials, endomorphisms"
    page_command.add_arguments(commands.add_parser("page", help=page, description=page))
    given = parser.parse_args(arguments)
    try:
        if given.command == "compile":
            _compile()
        elif given.command == "page":
            page_command.run(given)
        else:
            command.run(given)
    except (JacobianError, OSError) as error:
        print(f"jacobian: error: {error}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        print("jacobian: interrupted", file=sys.stderr)
        return 130
    return 0


def _compile() -> None:
    from jacobian.compilation import compile_all
    from jacobian.native.kept import look_for_a_place
    from jacobian.numbers.compiler import interpreted

    if interpreted():
        raise ArgumentError("NUMBA_DISABLE_JIT is set: nothing is to be compiled")
    look_for_a_place(needed=True)
    for name, seconds in compile_all():
        print(f"{seconds:8.2f} s  {name}", flush=True)


if __name__ == "__main__":
    leave(main())
