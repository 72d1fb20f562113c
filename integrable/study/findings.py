"""Evaluation of a study's rows: the more accurate method in equal run time, error/floor, orders of convergence."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from math import inf, log
from statistics import linear_regression
from typing import Any

from integrable.oracles.methods import METHODS, time_scale
from integrable.phase.precisions import FLOAT_DIGITS
from integrable.scene.data import Scene
from integrable.scene.file import scene_names
from integrable.study.plan import FLOW, NOT_MEASURED

__all__ = [
    "LONG", "SCENE_FLOOR_FACTOR", "Behind", "SceneFindings", "Standing", "Study", "fitted_slope", "gather",
    "study_from",
]  # fmt: skip

LONG = 1000.0
"""The divisor flow should be ahead on scenes whose last time is at least this, in the scene's unit or in time scales of
the motion.
"""
SCENE_FLOOR_FACTOR = 10.0
"""The error of the flow in floats should be within this factor of the floor."""
WRONG, WRONG_FLOORS = 1e-6, 1000.0
"""The flow in floats should raise an exception rather than return a result whose error is above WRONG and above
WRONG_FLOORS times the floor.
"""
OFF_LEVEL = 0.1
"""An error is said to be off the level set if an integral drifts by more than this fraction of the error."""
LOST = 10.0
"""The allowed difference between the truth and an independent integrator of n digits, in units of 10⁻ⁿ times the
conditioning of the motion.
"""
PLATEAU = 30.0
"""Errors within this factor of a method's least error are taken as rounding, and do not enter its slope."""
COARSE = 0.1
"""Errors above this are not asymptotic, and do not enter the slope."""


@dataclass(frozen=True)
class Behind:
    """A comparator's row that is more accurate than all rows of the flow with the same or a shorter run time."""

    scene: str
    row: dict[str, Any]
    flow_error: float | None
    """The least error of the flow in at most the row's run time; None where no row of the flow is as fast."""
    first: dict[str, Any] | None
    """The fastest row of the flow, None where it has none."""
    overtaken: float | None
    """The least run time in which the flow is at least as accurate as the row; None if it never is."""

    @property
    def cheaper(self) -> bool:
        """Whether the row is faster than all rows of the flow, of which there is at least one."""
        return self.flow_error is None and self.first is not None


@dataclass(frozen=True)
class Standing:
    """The flow in floats compared with the fastest other method whose error is at most max(flow's error, floor)."""

    T: float | None
    """The time, in time scales of the motion; None: all times of the scene."""
    flow: dict[str, Any]
    """The flow's "total", the seconds of set-up and evaluation, and its "error_gamma"."""
    peer: dict[str, Any] | None
    """The other method's "total" and "error_gamma", "method" and "setting"; None where no method was accurate enough.
    """
    tried: dict[str, dict[str, Any]]
    """For each method that was tried: its error, the run time that it exceeded, or its error message."""
    strong: Sequence[str]
    """Methods of which at least one must have run before :attr:`outcome` can be "none"."""

    @property
    def ratio(self) -> float:
        """The other method's run time divided by the flow's; infinite if there is none."""
        return inf if self.peer is None else float(self.peer["total"] / self.flow["total"])

    @property
    def least(self) -> float | None:
        """The longest run time that a method exceeded, divided by the flow's; None if none did, or one was accurate."""
        slower = [told["slower"] for told in self.tried.values() if "slower" in told]
        return float(max(slower) / self.flow["total"]) if self.peer is None and slower else None

    @property
    def outcome(self) -> str:
        """The outcome of the comparison: "met", "slower", "none" or "stopped".

        "met" means that another method is accurate enough. "slower" means that none was, but some exceeded their time.
        "none" means that methods of :attr:`strong` ran and none was accurate enough, "stopped" that they could not run.
        """
        if self.peer is not None:
            return "met"
        if self.least is not None:
            return "slower"
        ran = [name for name in self.strong if "error_gamma" in self.tried.get(name, {})]
        return "none" if ran else "stopped"


@dataclass
class SceneFindings:
    """The rows of a scene by kind, and their evaluation. The time ``total`` of a row includes its set-up."""

    scene: Scene
    flow: list[dict[str, Any]] = field(default_factory=list)
    comparators: list[dict[str, Any]] = field(default_factory=list)
    backlund: list[dict[str, Any]] = field(default_factory=list)
    failures: list[dict[str, Any]] = field(default_factory=list)
    truth: dict[str, Any] | None = None
    floor: dict[str, Any] | None = None
    orbit: dict[str, Any] | None = None
    first_answers: list[dict[str, Any]] = field(default_factory=list)
    horizons: list[dict[str, Any]] = field(default_factory=list)
    missing: list[dict[str, Any]] = field(default_factory=list)
    """Rows that were not measured because the study's time was up."""

    @property
    def moved_by_divisors(self) -> bool:
        """Whether the flow of the scene advances by adding divisors."""
        return any(content["row"]["method"] == FLOW for content in self.flow)

    @property
    def long(self) -> bool:
        """Whether the scene's last time is 1000 or more, in its own unit or in time scales of the motion."""
        if self.scene.steps is not None:
            return False
        last = max(self.scene.times.floats())
        return max(last, last / time_scale(*self.scene.start(FLOAT_DIGITS))) >= LONG

    @property
    def best(self) -> dict[str, Any] | None:
        """The flow's fastest row in floats."""
        rows = [c["result"] for c in self.flow if c["row"]["setting"] in ("floats", "compiled")]
        return min(rows, key=lambda row: row["total"], default=None)

    @property
    def judged(self) -> dict[str, Any] | None:
        """The row that is compared with the floor: :attr:`best`, or the row in floats of an orbit over real numbers."""
        if self.orbit is None:
            return self.best
        rows: list[dict[str, Any]] = self.orbit["rows"]
        return next((row for row in rows if row["digits"] is not None and row["digits"] <= FLOAT_DIGITS), None)

    @property
    def over_floor(self) -> float | None:
        """The larger of error/floor for γ and for M, of the flow or orbit in floats. The study claims that it is at
        most 10.
        """
        if self.floor is None or self.judged is None:
            return None
        row, floor = self.judged, self.floor
        return max(float(row["error_gamma"] / floor["floor_gamma"]), float(row["error_M"] / floor["floor_M"]))

    @property
    def silently_wrong(self) -> bool:
        """Whether the flow returned states with large errors, which rounding of the inputs does not explain."""
        row = self.judged
        if row is None or self.over_floor is None:
            return False
        return max(row["error_gamma"], row["error_M"]) > WRONG and self.over_floor > WRONG_FLOORS

    @property
    def cause(self) -> str:
        """The direction of an error above the floor: off the level set of the integrals, or along the level set."""
        row = self.judged
        if row is None:
            return ""
        drift = max(value for name, value in row["drift"].items() if name not in ("C1", "C2"))
        if drift > OFF_LEVEL * max(row["error_gamma"], row["error_M"]):
            return "additions leave the level set of the integrals"
        way = f" (way: {row['way']})" if self.orbit is None else ""
        return f"on the level set, in the phase{way}"

    @property
    def doubtful(self) -> bool:
        """Whether the truth is unconfirmed.

        A truth is unconfirmed if it differs from the independent integrator by more than its digits allow, or if that
        integrator alone computed it.
        """
        if self.truth is None:
            return False
        check = self.truth["check"]
        if check is None:
            return True
        growth = 1.0 if self.floor is None else max(1.0, self.floor["conditioning_gamma"], self.floor["conditioning_M"])
        return max(check["error_gamma"], check["error_M"]) > LOST * 10.0 ** -check["digits"] * growth

    @property
    def standings(self) -> list[Standing]:
        """The comparisons at single times, the shortest first, then the comparison over all times of the scene."""
        rows = [(content["row"]["value"], content["result"]) for content in self.horizons]
        rows.sort(key=lambda row: (row[0] is None, row[0]))
        return [Standing(T, *(r[key] for key in ("flow", "peer", "tried", "strong"))) for T, r in rows]

    @property
    def refused(self) -> list[float | None]:
        """The times, as in :attr:`Standing.T`, at which the flow raised an error or was stopped."""
        return [content["row"]["value"] for content in self.failures if content["row"]["kind"] == "horizon"]

    def behind(self) -> list[Behind]:
        """The comparators' rows that the flow does not beat."""
        found = []
        for content in self.comparators:
            row = content["result"]
            flow = [self._beside(row, one) for one in self.flow]
            first = min(flow, key=lambda one: float(one["total"]), default=None)
            errors = [r["error_gamma"] for r in flow if r["total"] <= row["total"]]
            least = min(errors, default=None)
            if least is None or least > row["error_gamma"]:
                better = [r["total"] for r in flow if r["error_gamma"] <= row["error_gamma"]]
                found.append(Behind(self.scene.name, content, least, first, min(better, default=None)))
        return found

    @staticmethod
    def _beside(row: dict[str, Any], own: dict[str, Any]) -> dict[str, Any]:
        """A result of the flow for comparison with a row.

        Where the flow in floats was timed alternately with the row's method, its run time is that of this measurement.
        """
        in_turn = own["row"]["setting"] == "floats" and "flow" in row
        result: dict[str, Any] = own["result"]
        return {**result, "total": row["flow"]} if in_turn else result

    def slopes(self) -> list[tuple[str, float, int | None]]:
        """(method, observed order, theoretical order) of the fixed-step methods with enough points."""
        found = []
        for name, method in METHODS.items():
            rows = [c for c in self.comparators if c["row"]["method"] == name]
            if method.parameter != "step":
                continue
            slope = fitted_slope([c["row"]["value"] for c in rows], [c["result"]["error_gamma"] for c in rows])
            if slope is not None:
                found.append((name, slope, method.order))
        return found


@dataclass(frozen=True)
class Study:
    """The data of a study's page."""

    findings: list[SceneFindings]
    mode: str
    command: str
    versions: dict[str, str | None]
    machine: dict[str, Any]
    dates: Sequence[str]
    """The times of the first and of the last row, ISO 8601."""
    commits: Sequence[str]
    load: float | None
    """The median over the rows of the machine's load, to which this study contributes about 1."""
    figures: dict[str, str]
    """Paths of the figures of the scenes, and of ``floors``, relative to the page."""
    seconds: float
    """The sum of the times of all rows."""
    missing: tuple[str, ...] = ()
    """The package's scenes that are not part of this study."""

    @property
    def motions(self) -> list[SceneFindings]:
        """The findings of the scenes that are motions."""
        return [f for f in self.findings if f.scene.steps is None]

    @property
    def horizons(self) -> list[float | None]:
        """The single times at which flows were compared with others, ascending, and None for all of a scene's times."""
        every = [standing.T for f in self.motions for standing in f.standings]
        return [*sorted({T for T in every if T is not None}), *([None] if None in every else [])]

    @property
    def orbits(self) -> list[SceneFindings]:
        """The findings of the scenes that are orbits and have an orbit's result."""
        return [f for f in self.findings if f.orbit is not None]

    @property
    def behind(self) -> list[Behind]:
        """The rows of comparators that the flow does not beat.

        Rows of scenes that are :attr:`SceneFindings.long` come first. Among these and among the rest, rows that are
        more accurate than the flow in the same time precede rows that are only faster; then run times descend.
        """
        found = [(f, b) for f in self.findings for b in f.behind()]
        order = sorted(
            found, key=lambda one: (not one[0].long, one[1].flow_error is None, -one[1].row["result"]["total"])
        )
        return [b for _, b in order]

    @property
    def behind_by_method(self) -> list[tuple[Behind, int]]:
        """For each scene and method its most accurate row of :attr:`behind`, with the number of its rows there.

        The results are in the order of :attr:`behind`.
        """
        groups: dict[tuple[str, str], list[Behind]] = {}
        for behind in self.behind:
            groups.setdefault((behind.scene, behind.row["row"]["method"]), []).append(behind)
        return [(min(group, key=lambda b: b.row["result"]["error_gamma"]), len(group)) for group in groups.values()]

    def of(self, name: str) -> SceneFindings:
        """The findings of one scene."""
        return next(f for f in self.findings if f.scene.name == name)


def gather(scenes: Sequence[Scene], contents: Iterable[dict[str, Any]]) -> list[SceneFindings]:
    """The findings of each scene, from the contents of the files of its rows."""
    found = {scene.name: SceneFindings(scene) for scene in scenes}
    lists = {"comparator": "comparators", "first answer": "first_answers", "horizon": "horizons"}
    for content in contents:
        kind, scene = content["row"]["kind"], found[content["row"]["scene"]]
        if content["status"] == NOT_MEASURED:
            scene.missing.append(content)
        elif content["status"] != "done":
            scene.failures.append(content)
        elif kind in (*lists, "flow", "backlund"):
            getattr(scene, lists.get(kind, kind)).append(content)
        elif kind in ("truth", "floor", "orbit"):
            setattr(scene, kind, content["result"])
    return list(found.values())


def study_from(data: dict[str, Any], scenes: Sequence[Scene]) -> Study:
    """The study whose ``report.json`` holds ``data``; ``scenes`` are the scenes named there."""
    taken = ("mode", "command", "versions", "machine", "seconds", "dates", "commits", "load")
    missing = [name for name in scene_names() if name not in {scene.name for scene in scenes}]
    return Study(
        findings=gather(scenes, data["rows"]), figures={}, missing=tuple(missing), **{key: data[key] for key in taken}
    )


def fitted_slope(steps: Sequence[float], errors: Sequence[float]) -> float | None:
    """The least-squares slope of log error against log step, for the points above the plateau of rounding.

    The plateau consists of points within 30 times the least error, unless that error is far above rounding. Errors
    above 0.1 are also left out. The result is None with fewer than three points.
    """
    least = min((e for e in errors if e > 0), default=0.0)
    bound = PLATEAU * least if least < 1e-11 else 0.0
    points = [(log(h), log(e)) for h, e in zip(steps, errors, strict=True) if bound < e < COARSE]
    if len(points) < 3:
        return None
    return linear_regression(*zip(*points, strict=True)).slope
