"""``integrable doctor``: what is installed, compiled and cached, the speed of this machine, and any problems."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from time import perf_counter
from typing import NamedTuple

from integrable.extras import command, version_of
from integrable.files.frame import version
from integrable.scene.output import machine, versions
from integrable.scene.tables import aligned

__all__ = ["Findings", "findings"]

EXTRAS = {
    "scipy": "app", "matplotlib": "app", "tqdm": "app", "plotly": "view", "xarray": "io", "pandas": "io", "h5py": "io",
    "h5netcdf": "io", "zarr": "io", "pyarrow": "io", "argcomplete": "completion", "heyoka": "peers",
}  # fmt: skip
"""The libraries that a plain installation lacks, and the extra that installs each."""
LEAST = 0.2
"""Seconds for which an operation is repeated to measure its speed."""


class Findings(NamedTuple):
    """What ``integrable doctor`` reports: facts as pairs (name, value), and one line for each problem."""

    facts: list[tuple[str, str]]
    wrong: list[str]

    def text(self) -> str:
        """The facts as a table, and the problems below it."""
        lines = [*aligned(self.facts, left=2), "", *(self.wrong or ["nothing is wrong"])]
        return "\n".join(lines)


def findings() -> Findings:
    """All findings. The first run on a machine compiles code, which the time of the first motion includes."""
    kept, no_place = _kept()
    where = machine()
    facts = [
        ("jacobian-integrable", f"{version()} in {Path(__file__).parent.parent}"),
        ("system", f"{where['system']}, {where['processor']}, {where['cores']} cores"),
        *_libraries(),
        ("compiled code kept in", kept),
        *_speeds(),
    ]
    return Findings(facts, [*no_place, *_intruders()])


def _libraries() -> list[tuple[str, str]]:
    others = (*EXTRAS, "jacobian-integrable")
    rows = [(name, number or "not installed") for name, number in versions().items() if name not in others]
    return rows + [(name, version_of(name) or f"not installed: {command(extra)}") for name, extra in EXTRAS.items()]


def _kept() -> tuple[str, list[str]]:
    """The folder and size of the cache of compiled code, and any problem with it."""
    from jacobian.native.kept import place
    from jacobian.numbers.compiler import NO_PLACE, REMEDY, interpreted

    folder = place()
    if folder is None:
        return "no folder", [f"{NO_PLACE}: every process compiles anew; {REMEDY}"]
    roots = {folder, *(Path(__file__).parent.parent / name for name in ("jacobian", "integrable"))}
    files = {file for root in roots for kind in ("*.nbc", "*.native") for file in root.rglob(kind)}
    size = sum(file.stat().st_size for file in files)
    off = ["NUMBA_DISABLE_JIT is set: loops are interpreted, a hundred times slower"] if interpreted() else []
    return f"{folder} ({len(files)} pieces, {size / 1e6:.0f} MB)", off


def _speeds() -> list[tuple[str, str]]:
    from integrable.systems.chaplygin_ball import ChaplyginBall
    from jacobian import GF, HyperellipticCurve

    begun = perf_counter()
    ball, state = ChaplyginBall.example()
    times = [float(k) for k in range(1000)]
    ball.flow(state).at(times)
    first = perf_counter() - begun
    motion = _seconds(lambda: ball.flow(state).at(times))
    J = HyperellipticCurve(GF(2**61 - 1), [1, 0, 0, 0, 0, 1]).jacobian()
    D, E = J.from_points([(0, 1)]), J.from_points([(0, -1)])
    D, E = 10**9 * D + 7 * E, 10**8 * D
    addition = _seconds(lambda: D + E)
    return [
        ("first motion of this process", f"{first:.2f} s, with what had to be loaded or compiled"),
        ("a motion at 1000 times", f"{1e3 * motion:.2f} ms"),
        ("an addition, genus 2, GF(2^61 - 1)", f"{1e6 * addition:.2f} µs"),
    ]


def _seconds(act: Callable[[], object]) -> float:
    """The seconds that a call of ``act`` takes, measured over many calls."""
    act()
    count, begun = 0, perf_counter()
    while (spent := perf_counter() - begun) < LEAST:
        act()
        count += 1
    return spent / count


def _intruders() -> list[str]:
    from jacobian.owner import REMEDY, installed

    return [
        f"{other} has a package jacobian too: files of one overwrite the other's; {REMEDY}" for other in installed()
    ]
