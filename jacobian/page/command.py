"""``python -m jacobian page`` prints a page about a curve over QQ."""

from __future__ import annotations

import argparse

from jacobian.arithmetic.command import bound_of, curve_of
from jacobian.page.lines import summary


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The options of ``page``."""
    parser.add_argument("curve", help='f of y² = f(x), as in "x^5-x+1", or "[f, h]" of y² + h(x)y = f(x)')
    parser.add_argument("--bound", default="2^12", help="the largest prime (default: 2^12)")
    parser.add_argument("--height", type=int, default=1000, help="of x of rational points (default: 1000)")
    parser.add_argument("--digits", type=int, default=20, help="of periods and regulators (default: 20)")
    parser.add_argument("--json", action="store_true", help="print JSON")


def run(arguments: argparse.Namespace) -> None:
    """Prints the page."""
    page = summary(curve_of(arguments.curve), bound_of(arguments.bound), arguments.height, arguments.digits)
    print(page.to_json() if arguments.json else page)
