"""Bodies in the laboratory compared with Newton's and Euler's equations of the rotation matrix, at 160 bits.

200 random balls and as many free bodies: inertia tensors of six random masses in arbitrary axes, random orientations,
components of ω with a standard deviation of 3 rad/s. The equations (:mod:`tests.integrable.laboratory.newton_euler`)
share no formula with the package; they are integrated by heyoka's Taylor series in reals of 160 bits (``pip install
'jacobian-integrable[peers]'``), to 10⁻³⁶. Errors are the largest over all bodies: of the elements of the rotation, of ω
relative to its size, of the contact in m.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from benchmarks.curves import least_seconds
from integrable import RigidBody, RollingBall
from integrable.extras import installed
from jacobian import MP, RR
from tests.integrable.laboratory.newton_euler import rates
from tests.integrable.laboratory.test_laboratory import MASS, RADIUS, orthogonal, rotation, tensors

COUNT, BITS, TOLERANCE = 200, 160, "1e-36"
# for each field: seconds of motion, and the promised error
CASES = ((RR, 3, 1e-12), (MP(30), 1, 1e-20))
WIDE = MP(45)
CONTACT = (0.3, -0.2)
SYMMETRIC = ((0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2))


def run(smoke: bool) -> list[dict[str, object]]:
    """A row for each field and kind of body; RuntimeError if an error exceeds the promised one."""
    if not installed("heyoka"):
        return []
    integrate, rows = _integrator(), []
    rng = np.random.default_rng(152)
    count = 1 if smoke else COUNT
    J, omega = tensors(rng, count), 3 * rng.normal(size=(count, 3))
    R = [orthogonal(WIDE, rotation(rng)) for _ in range(count)]
    for ball in (True, False):
        for field, time, promised in CASES:
            worst = np.zeros(3)
            for k in range(count):
                truth = integrate(J[k], R[k], omega[k], ball, time)
                worst = np.maximum(worst, _errors(field, J[k], R[k], omega[k], ball, time, truth))
            if not worst.max() < promised:
                raise RuntimeError(f"{field.name}, ball {ball}: off by {worst.tolist()}")
            kind = "rolling ball" if ball else "free body"
            R_off, omega_off, contact_off = worst.tolist()
            rows.append(
                {
                    "bodies": count, "kind": kind, "field": field.name, "seconds of motion": time, "rotation": R_off,
                    "ω": omega_off, "contact, m": contact_off if ball else None,
                    "ms a body": _milliseconds(field, J[0], R[0], omega[0], ball, time),
                }
            )  # fmt: skip
    return rows


def _integrator() -> Any:
    """A function from (J, R, ω, whether it rolls, time) to the rotation, ω and the displacement of the contact: 14
    numbers of WIDE.
    """
    import heyoka as hy

    def real(x: Any) -> Any:
        return hy.real(str(x), BITS)

    variables = hy.make_vars(*(f"x{i}" for i in range(14)))
    tensor = np.empty((3, 3), dtype=object)
    for n, (i, j) in enumerate(SYMMETRIC):
        tensor[i, j] = tensor[j, i] = hy.par[n]
    d, radius = (np.array([hy.par[n]], dtype=object) for n in (6, 7))
    equations = list(zip(variables, rates(tensor[None], d, radius, np.array([variables]))[0], strict=True))
    begin, pars = [*np.eye(3).ravel(), *[0] * 5], [1, 0, 0, 1, 0, 1, 1, 1]
    begin, pars = (np.array([real(x) for x in v]) for v in (begin, pars))
    stepper = hy.taylor_adaptive(
        equations, begin, fp_type=hy.real, pars=pars, tol=real(TOLERANCE), compact_mode=True, time=real(0)
    )

    def integrate(J: np.ndarray, R: Any, omega: np.ndarray, ball: bool, time: float) -> Any:
        stepper.time = real(0)
        exact = WIDE.coerce(MASS) * WIDE.coerce(RADIUS) ** 2 * ball
        stepper.state[:] = [real(WIDE.coerce(x)) for x in (*R.ravel(), *omega, 0, 0)]
        stepper.pars[:] = [real(WIDE.coerce(x)) for x in (*(J[i, j] for i, j in SYMMETRIC), exact, RADIUS)]
        outcome, *_ = stepper.propagate_until(real(time))
        if outcome != hy.taylor_outcome.time_limit:
            raise RuntimeError(f"heyoka stopped: {outcome}")
        return np.array([WIDE.coerce(str(x)) for x in stepper.state], dtype=object)

    return integrate


def _motion(field: Any, J: np.ndarray, R: Any, omega: np.ndarray, ball: bool) -> Any:
    R = R.astype(float) if field is RR else R
    if ball:
        return RollingBall(J, MASS, RADIUS, field=field).motion(R, omega, CONTACT)
    return RigidBody(J, field=field).motion(R, omega)


def _errors(field: Any, J: np.ndarray, R: Any, omega: np.ndarray, ball: bool, time: float, truth: Any) -> np.ndarray:
    found = _motion(field, J, R, omega, ball).at([time])
    off = [abs(found.matrices[0].ravel() - truth[:9]).max(), abs(found.omega[0] - truth[9:12]).max(), 0]
    off[1] /= abs(omega).max()
    if ball:
        off[2] = abs(found.contact[0] - [WIDE.coerce(x) for x in CONTACT] - truth[12:]).max()
    return np.array(off, dtype=float)


def _milliseconds(field: Any, J: np.ndarray, R: Any, omega: np.ndarray, ball: bool, time: float) -> float:
    """The milliseconds for one body: its set-up, rotation, ω and contact."""

    def once() -> None:
        found = _motion(field, J, R, omega, ball).at([time])
        found.omega  # noqa: B018
        if ball:
            found.contact  # noqa: B018

    return 1e3 * least_seconds(once, 1)
