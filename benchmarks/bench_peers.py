"""The flow compared with integrators that are built once: twelve scenes at T = 1, 10, 100, 1000; set-up; ensembles; 30
digits.

``ms`` is the clock time of a start with its evaluation, on both sides (:class:`integrable.oracles.method.Spent`): the
median of runs in turn in one process, with all code compiled before. heyoka's integrator is built once for a kind of
system and a tolerance, with the constants as parameters. Each run has 101 times up to T, in the scene's unit of time.

``error`` is the largest error of γ and M/|M|, or of q and p, at T, against 30 digits from the same doubles. Where
``heyoka/flow`` is above 1, the flow is faster. ``fastest`` is the fastest of heyoka, Gauss–Legendre 16 and Taylor,
compiled, whose error is at most ten times the flow's or 1e-15; a dash if there is none. Rows of set-up have the times
spent once per system and once per start; ``machine s`` is the time of building heyoka's integrator in this process.

The benchmark takes two minutes on an idle machine once everything is compiled. The first run compiles on all cores
before it measures, and says so. heyoka is in the extra ``peers``.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from concurrent.futures import ProcessPoolExecutor
from contextlib import suppress
from multiprocessing import get_context
from time import perf_counter
from typing import Any

from benchmarks import bench_ensemble
from integrable.extras import installed
from integrable.oracles.method import Spent
from integrable.oracles.methods import METHODS, time_scale
from integrable.oracles.reference import taylor
from integrable.phase.precisions import FLOAT_DIGITS
from integrable.scene.data import Scene
from integrable.scene.doubles import in_doubles
from integrable.scene.file import load_scene
from integrable.study.rivals import at_times, flow_once, method_once
from integrable.study.timing import Timed, interleaved
from integrable.study.truth import Truth, compute
from jacobian.errors import JacobianError

SCENES = (
    "neumann", "ellipsoid", "toda", "garnier", "lagrange", "spherical_pendulum", "veselova", "henon_heiles_bounded",
    "chaplygin", "tilted_ball", "euler_top", "thin_ball",
)  # fmt: skip
HORIZONS = (1, 10, 100, 1000)
OUTPUTS = 101
PEERS = {
    "heyoka": 1e-15,
    "Gauss-Legendre 16": 0.7,  # time scales
    "Gauss-Legendre 16, adaptive": 1e-17,
    "Taylor, compiled": 1e-16,
}
ENOUGH, FACTOR = 1e-15, 10.0
ROUNDS, PATIENCE = 5, 1.0
Row = dict[str, Any]


def run(smoke: bool) -> list[Row]:
    """Rows (what, T, flow ms, its error, heyoka ms, its error, heyoka/flow, fastest, fastest/flow)."""
    names = SCENES[:1] if smoke else SCENES
    if not smoke:
        compile_on_all_cores(names)
    rows: list[Row] = []
    once: list[Row] = []
    for name in names:
        scene = in_doubles(load_scene(name))
        for T in HORIZONS[:1] if smoke else HORIZONS:
            row, spent = compared(scene, T)
            rows.append(row)
            once += [set_up(name, spent)] if T == 1 else []
    return [*rows, *once, ensembles(smoke), *(() if smoke else (thirty_digits(),))]


def compile_on_all_cores(names: Sequence[str]) -> None:
    """Compiles the code for each kind of system in other processes, so that later runs only load it."""
    print(f"compiling for {len(names)} kinds of systems, once a machine (a minute each) …", end="", flush=True)
    begun = perf_counter()
    with ProcessPoolExecutor(mp_context=get_context("spawn")) as pool:
        list(pool.map(compiled, names))
    print(f" {perf_counter() - begun:.0f} s", flush=True)


def compiled(name: str) -> None:
    """Compiles all code that a scene needs."""
    scene = in_doubles(load_scene(name))
    with suppress(JacobianError, ArithmeticError, RuntimeError):
        for once in runs_of(at_times(scene, grid(1)))[0].values():
            once()


def grid(T: int) -> list[float]:
    """OUTPUTS equally spaced times from 0 to T."""
    return [T * k / (OUTPUTS - 1) for k in range(OUTPUTS)]


def runs_of(scene: Scene) -> tuple[dict[str, Callable[[], Timed]], str]:
    """A run of the flow, named "", and of each peer, built by a first run; and the messages of failed peers."""
    system, state = scene.start(FLOAT_DIGITS)
    runs, said = {"": flow_once(scene, FLOAT_DIGITS, "auto")}, ""
    for name, setting in PEERS.items():
        method = METHODS[name]
        if method.takes(system):
            value = setting * time_scale(system, state) if method.parameter == "step" else setting
            once = method_once(scene, method, value)[1]
            try:
                once()
            except (JacobianError, ArithmeticError, RuntimeError) as error:
                said = f"{name}: {error}"[:60]
                continue
            runs[name] = once
    return runs, said


def compared(scene: Scene, T: int) -> tuple[Row, dict[str, Spent]]:
    """The row for 101 times up to T, and the costs of each method."""
    last = at_times(scene, [T])
    truth = Truth(last, compute(last, 0.0))
    runs, said = runs_of(at_times(scene, grid(T)))
    row: Row = {"what": scene.name, "T": T} | ({"note": said} if said else {})
    runs[""]()
    found = interleaved(runs, ROUNDS, PATIENCE)
    errors = {name: max(truth.errors(x.found.gamma[-1:], x.found.M[-1:]).values()) for name, x in found.items()}
    flow = found[""].total
    row |= {"flow ms": 1e3 * flow, "error": errors[""]}
    if "heyoka" in found:
        theirs = found["heyoka"].total
        row |= {"heyoka ms": 1e3 * theirs, "its error": errors["heyoka"], "heyoka/flow": theirs / flow}
    near = [name for name in found if name and errors[name] <= max(ENOUGH, FACTOR * errors[""])]
    if near:
        fastest = min(near, key=lambda name: found[name].total)
        row |= {"fastest": fastest, "fastest/flow": found[fastest].total / flow}
    return row, {name: timing.spent for name, timing in found.items()}


def set_up(name: str, spent: dict[str, Spent]) -> Row:
    """A row of the times spent once per system and once per start."""
    ours, theirs = (1e3 * (part.system + part.start) if part else None for part in (spent[""], spent.get("heyoka")))
    row: Row = {"what": f"{name}, set-up", "flow ms": ours}
    if theirs and ours:
        row |= {"heyoka ms": theirs, "heyoka/flow": theirs / ours, "machine s": spent["heyoka"].machine}
    return row


def ensembles(smoke: bool) -> Row:
    """The row of an ensemble of a hundred random balls at 101 times up to 100, on one thread, in ms per member."""
    many, times = bench_ensemble.members(4 if smoke else 100), bench_ensemble.np.linspace(0, 100.0, OUTPUTS)
    wanted = bench_ensemble.truth(many, times)
    bench_ensemble.warm(smoke)
    ours = bench_ensemble.ours(many, times, 1, wanted)
    row: Row = {"what": f"{len(many)} balls, of each", "T": 100, "flow ms": ours["ms"], "error": ours["error"]}
    if installed("heyoka") and not smoke:
        theirs = bench_ensemble.heyoka(many, times, 1, wanted)
        row |= {"heyoka ms": theirs["heyoka's ms"], "its error": theirs["its error"]}
        row["heyoka/flow"] = row["heyoka ms"] / row["flow ms"]
    bench_ensemble.set_threads(None)
    return row


def thirty_digits() -> Row:
    """The row of one time of the rolling ball, by the flow and by Taylor series, both at 30 digits on mpmath."""
    scene = at_times(in_doubles(load_scene("chaplygin")), [10])

    def series() -> Timed:
        system, state = scene.start(30)
        begun = perf_counter()
        found = taylor(system, state, [10], digits=30)
        return Spent(0.0, 0.0, 0.0, perf_counter() - begun), found

    found = interleaved({"flow": flow_once(scene, 30, "auto"), "taylor": series}, 3, 20.0)
    flow, theirs = found["flow"].total, found["taylor"].total
    truth = Truth(scene, compute(scene, 0.0))
    error = max(truth.errors(found["flow"].found.gamma, found["flow"].found.M).values())
    row = {"what": "chaplygin, 30 digits, one time", "T": 10, "flow ms": 1e3 * flow, "error": error}
    return {**row, "fastest": "Taylor, multiprecision", "fastest/flow": theirs / flow}
