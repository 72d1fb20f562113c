"""The claims of a study, each with its measurement and verdict."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from integrable.oracles.methods import METHODS
from integrable.scene.tables import plain_power
from integrable.study.findings import SCENE_FLOOR_FACTOR, Behind, Study

__all__ = ["claims"]

FAR = 10_000.0
"""At single times of at least this many time scales the flow should be faster."""
AHEAD = 0.97
"""The flow should be more accurate at equal run time than this fraction of the rows of methods in doubles."""

Claim = tuple[str, str, bool]


def claims(study: Study) -> list[tuple[str, ...]]:
    """The rows (claim, measurement, verdict) of the table of claims; the first row is its head."""
    found = [
        _floor(study),
        *_far(study),
        *_near(study),
        *_ahead(study),
        *_ahead_in_doubles(study),
        _truth(study),
        _no_silence(study),
        *_exact(study),
    ]
    verdicts = ((claim, measured, "holds" if holds else "does not hold") for claim, measured, holds in found)
    return [("claim", "measurement", "verdict"), *verdicts]


def _floor(study: Study) -> Claim:
    known = [(f.scene.name, f.over_floor, f.cause) for f in study.findings if f.over_floor is not None]
    over = [one for one in known if one[1] > SCENE_FLOOR_FACTOR]
    unknown = [f.scene.name for f in study.findings if f.over_floor is None and not f.scene.finite_field]
    return (
        "The flow, or the orbit, in floats is within 10 times the floor on every scene.",
        f"{len(known) - len(over)} of {len(known) + len(unknown)} scenes"
        + "".join(f"; {name}: {_times(factor)}, {cause}" for name, factor, cause in over)
        + "".join(f"; {name}: see the failures" for name in unknown),
        not over and not unknown,
    )


def _times(factor: float) -> str:
    return f"{factor:.0f} times" if factor < 1e4 else f"{factor:.0e} times"


def _far(study: Study) -> list[Claim]:
    found = [(f.scene.name, s) for f in study.motions for s in f.standings if s.T is not None and s.T >= FAR]
    lost = [f"{name} at {s.T:g}: {s.ratio:.2g}" for name, s in found if s.ratio < 1]
    claim = f"At one time T ≥ {plain_power(FAR)} no other method that is as accurate is faster than the flow."
    measured = f"{len(found) - len(lost)} of {len(found)} cases" + "".join(f"; {one}" for one in lost)
    return [(claim, measured, not lost)] if found else []


def _near(study: Study) -> list[Claim]:
    found = [s for f in study.motions for s in f.standings if s.T is not None and s.T <= 1 and s.peer is not None]
    won = sum(s.ratio >= 1 for s in found)
    claim = "At T = 1 an integrator that is already compiled is faster than the flow, wherever one is as accurate."
    return [(claim, f"{len(found) - won} of {len(found)} cases", not won)] if found else []


def _ahead(study: Study) -> list[Claim]:
    far = [f for f in study.motions if f.long]
    names = {f.scene.name for f in far}
    behind = [b for b in study.behind if b.scene in names]
    claim = "On scenes with T ≥ 1000 the flow is more accurate than every other method at equal run time."
    compared = sum(len(f.comparators) for f in far)
    return [(claim, _standing(compared, behind, len(far)), not behind)] if compared else []


def _ahead_in_doubles(study: Study) -> list[Claim]:
    compared = sum(_in_doubles(row) for f in study.motions for row in f.comparators)
    behind = [b for b in study.behind if _in_doubles(b.row)]
    claim = (
        f"The flow is more accurate at equal run time than at least {100 * AHEAD:.0f} % of the rows of methods in "
        "doubles, at any T."
    )
    holds = len(behind) <= (1 - AHEAD) * compared
    return [(claim, _standing(compared, behind, len(study.motions)), holds)] if compared else []


def _in_doubles(row: dict[str, Any]) -> bool:
    return METHODS[row["row"]["method"]].in_doubles


def _standing(compared: int, behind: Sequence[Behind], scenes: int) -> str:
    return (
        f"{compared - len(behind)} of {compared} rows on {scenes} scenes; other rows that finish sooner than the flow: "
        f"{sum(b.cheaper for b in behind)}, that are more accurate: {sum(not b.cheaper for b in behind)}"
    )


def _truth(study: Study) -> Claim:
    truths = [f for f in study.motions if f.truth is not None]
    doubtful = [f.scene.name for f in truths if f.doubtful]
    return (
        "The truth agrees with an independent integrator.",
        f"{len(truths) - len(doubtful)} of {len(study.motions)} scenes" + "".join(f"; not {name}" for name in doubtful),
        not doubtful and len(truths) == len(study.motions),
    )


def _no_silence(study: Study) -> Claim:
    silent = [f.scene.name for f in study.findings if f.silently_wrong]
    failed = [c for f in study.findings for c in f.failures]
    stopped = sum(c["stopped"] and c["row"]["kind"] in ("flow", "horizon") for c in failed)
    refused = sum(c["row"]["kind"] in ("flow", "horizon", "orbit") for c in failed)
    return (
        "No scene crashes, hangs or returns a wrong value without saying so.",
        f"{refused} rows of the flow raised a named error, {stopped} were stopped, {len(silent)} are wrong by more "
        "than 10⁻⁶ and more than 1000 times the floor" + "".join(f"; {name}" for name in silent),
        not silent and not stopped,
    )


def _exact(study: Study) -> list[Claim]:
    exact = [f.orbit for f in study.orbits if f.orbit is not None and f.scene.finite_field]
    wrong = sum(any(orbit["rows"][0]["drift"].values()) or bool(orbit["jump"]) for orbit in exact)
    measured = f"{len(exact) - wrong} of {len(exact)} orbits keep every integral and end where one addition does"
    return [("Orbits over finite fields are exact.", measured, not wrong)] if exact else []
