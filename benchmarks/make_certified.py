"""Make the data set of certified trajectories: ``python -m benchmarks.make_certified [NAME ...]``.

The data set has motions at 50 times each, as balls of radius at most 10⁻³⁰ that contain them (``enclosure``). Each
finished motion is written to ``build/certified/NAME.json``. The data set is made once all of these exist; an
interrupted run can be resumed. A motion takes some ten seconds, one of DEFORMED a minute or two.
"""

from __future__ import annotations

import hashlib
import json
import sys
import time
from decimal import Decimal, localcontext
from fractions import Fraction
from math import floor, frexp
from pathlib import Path
from random import Random
from typing import Any

from integrable import ChaplyginBall, EulerTop, load_scene

ROOT = Path(__file__).parents[1]
PARTS, OUT = ROOT / "build" / "certified", ROOT / "integrable" / "certified"
DIGITS, COUNT, PRINTED = 30, 50, 34
SCENES = [
    "chaplygin", "euler_top", "tilted_ball", "thin_ball", "tiny_d", "gamma_zero", "branch_point", "fast_spin",
    "slow_spin", "different_moments", "nearly_equal_moments", "almost_equal_moments", "near_separatrix_4",
    "near_separatrix_8", "near_separatrix_14",
]  # fmt: skip
DEFORMED = {"tilde": 3.0, "tilde_potential": 3.0, "tilde_poles": 3.0, "check": 3.0, "hat": 1.0, "gyroscopic": 3.0}
"""Scenes whose equations of motion are enclosed (:mod:`integrable.deformations.enclosed`), and their last times."""
RANDOM = 24
TURNS = {True: 3.0, False: 1.0}
"""The length of scenes (True) and of random motions (False), in turns of the body at its initial angular velocity."""


def motions() -> dict[str, tuple[Any, Any, str]]:
    """The motions by name, each as (system, state, the reason why it is hard); all inputs are doubles."""
    found = {}
    for name in [*SCENES, *DEFORMED]:
        scene = load_scene(name)
        found[name] = (*scene.start(15), " ".join(scene.description.split()))
    heavy = ChaplyginBall((1.0, 2.0, 3.0), 100.0)
    _, start = load_scene("heavy_ball").start(15)
    state = heavy.state(start.gamma, start.M)
    found["heavy"] = (
        heavy,
        state,
        "A heavy ball: the branch points 1/d and 1/(I_i + d) of its curve are close together.",
    )
    rng = Random(18)
    for k in range(RANDOM):
        ratio = 10.0 ** (k % 4)
        inertia = tuple(float(f"{x:.4g}") for x in sorted(rng.uniform(1, 1 + ratio) for _ in range(3)))
        d = 0.0 if k % 2 else float(f"{10 ** rng.uniform(-2, 1):.3g}")
        system = EulerTop(inertia) if d == 0 else ChaplyginBall(inertia, d)
        raw = [rng.gauss(0, 1) for _ in range(3)]
        length = sum(x * x for x in raw) ** 0.5
        gamma = tuple(x / length for x in raw)
        other = [rng.gauss(0, 1) for _ in range(3)]
        lean = 0.0 if k % 3 else rng.uniform(-1, 1)
        part = sum(x * y for x, y in zip(other, gamma, strict=True)) - lean
        M = tuple(y - part * x for x, y in zip(gamma, other, strict=True))
        kind = ("ball" if d else "top") + (", tilted" if lean else "")
        state = system.state(gamma, M, tilted=bool(lean))
        found[f"random_{k + 1:02d}"] = (system, state, f"A {kind} at random, moments of ratio up to {ratio:g}")
    return found


def times(name: str, system: Any, state: Any) -> list[float]:
    """50 equally spaced times that doubles and short decimals hold exactly."""
    span = DEFORMED.get(name)
    if span is None:
        span = 2 * 3.14159265 * TURNS[name in SCENES] / float(sum(x * x for x in system.omega(state))) ** 0.5
    unit = 2.0 ** (frexp(span)[1] - 12)
    step = floor(span / (COUNT - 1) / unit) * unit
    return [k * step for k in range(COUNT)]


def decimal(ball: Any) -> str:
    """The midpoint of a ball to 34 significant digits."""
    mantissa, exponent = (int(x) for x in ball.mid().man_exp())
    exact = Fraction(mantissa) * Fraction(2) ** exponent
    with localcontext() as context:
        context.prec = PRINTED
        return str(Decimal(exact.numerator) / Decimal(exact.denominator)) if exact else "0"


def certified(name: str, system: Any, state: Any, text: str) -> dict[str, Any]:
    """The entry of one motion in the data set."""
    at = times(name, system, state)
    motion = system.motion_through(state) if name in DEFORMED else system.flow(state)
    run = motion.enclosure(at, digits=DIGITS)
    rows = [
        {
            "t": t,
            "gamma": [decimal(x) for x in run.gamma[k]],
            "M": [decimal(x) for x in run.M[k]],
            # the radius of the balls, and the rounding of the printed decimals
            "bound": run.radius[k] + 1e-33,
        }
        for k, t in enumerate(at)
    ]
    return {
        "name": name,
        "about": text,
        **body(name, system),
        "tilted": bool(state.tilted),
        "rows": rows,
    }


def body(name: str, system: Any) -> dict[str, Any]:
    """The entry's description of a system: its kind and constants."""
    if name not in DEFORMED:
        kind = "chaplygin_ball" if system.d else "euler_top"
        return {"system": kind, "inertia": list(map(float, system.inertia)), "d": float(system.d)}
    found = {
        "system": load_scene(name).system,
        "inertia": list(map(float, system.body.inertia)),
        "d": float(system.d),
    }
    if system.potential is not None:
        found["potential"] = list(map(float, (system.potential.a, system.potential.b, *system.potential.poles)))
    if name == "gyroscopic":
        found["c"] = float(system.c)
    return found


def write_all(parts: list[dict[str, Any]]) -> None:
    """Writes the data set and its checksum."""
    head = {"schema": 2, "digits": DIGITS, "count": len(parts)}
    body = ",\n".join(json.dumps(part, ensure_ascii=False) for part in parts)
    text = json.dumps(head)[:-1] + ', "motions": [\n' + body + "\n]}\n"
    OUT.mkdir(exist_ok=True)
    (OUT / "trajectories.json").write_text(text, encoding="utf-8", newline="\n")
    checksum = f"{hashlib.sha256(text.encode()).hexdigest()}  trajectories.json\n"
    (OUT / "SHA256SUMS").write_text(checksum, encoding="utf-8", newline="\n")


def main(names: list[str]) -> None:
    PARTS.mkdir(parents=True, exist_ok=True)
    every = motions()
    for name, given in every.items():
        path = PARTS / f"{name}.json"
        if path.exists() or (names and name not in names):
            continue
        begin = time.process_time()
        path.write_text(json.dumps(certified(name, *given)), encoding="utf-8")
        print(f"{time.process_time() - begin:6.1f} s  {name}", flush=True)
    done = [PARTS / f"{name}.json" for name in every]
    if all(path.exists() for path in done):
        write_all([json.loads(path.read_text(encoding="utf-8")) for path in done])


if __name__ == "__main__":
    main(sys.argv[1:])
