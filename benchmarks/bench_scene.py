"""Error against run time of the shipped scenes: the divisor flow at several costs, beside SciPy's DOP853."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

from integrable.scene.data import Times
from integrable.scene.file import load_scene
from integrable.study.motions import measure

SCENES = ("chaplygin", "euler_top")


def run(smoke: bool) -> list[dict[str, object]]:
    """One row for each scene, method and cost; times in seconds."""
    rows: list[dict[str, object]] = []
    for name in SCENES:
        scene = load_scene(name)
        assert scene.report is not None
        if smoke:
            short = replace(
                scene.report, digits=(15, 20), tolerances=(Fraction("1e-6"),), truth_digits=30, repeat=1, steps=(100,)
            )
            scene = replace(scene, times=Times(given=(Fraction(1), Fraction(2))), report=short)
        report, _ = measure(scene, scene.digits, lambda _label: None)
        if not report.truth.agrees:
            raise AssertionError(f"{name}: the truth disagrees with the Taylor series, {report.truth}")
        for row in report.rows:
            times = {"set-up s": row.setup, "evaluation s": row.evaluation, "total s": row.total}
            errors = {"error gamma": row.error_gamma, "error M": row.error_M}
            rows.append({"scene": name, "method": row.method, "setting": row.setting, **errors, **times})
    return rows
