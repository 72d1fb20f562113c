"""One value of every public class of `integrable`, in floats and multiprecision, for the tests of values."""

import numpy as np

from integrable import (
    ChaplyginBall,
    Check,
    EulerTop,
    Gyroscopic,
    Hat,
    RigidBody,
    RollingBall,
    Tilde,
    ensemble,
    laboratory_ensemble,
    load_scene,
)
from integrable.classical.ellipsoid import Ellipsoid
from integrable.classical.garnier import Garnier
from integrable.classical.henon_heiles import HenonHeiles
from integrable.classical.kdv import KdV
from integrable.classical.kowalevski import KowalevskiTop
from integrable.classical.kuzmin_kutuzov import KuzminKutuzov
from integrable.classical.lagrange import LagrangeTop
from integrable.classical.neumann import Neumann
from integrable.classical.spherical_pendulum import SphericalPendulum
from integrable.classical.toda import TodaLattice
from integrable.classical.two_gaps import TwoGaps
from integrable.classical.veselova import Veselova
from integrable.laboratory.fit import OrientationFit
from integrable.motion.conditioning import conditioning
from integrable.scene.classical import ClassicalSystem
from integrable.scene.orbit import orbit
from integrable.systems.on_layer import BodyOnLayer
from jacobian import GF, MP, RR

FIELDS = {"RR": RR, "MP": MP(30)}
GAMMA, M = ("12/25", "3/5", "16/25"), ("48/125", "32/25", "-186/125")


def curried(h1, h2):
    """A Hamiltonian of the shifts: a function that pickle finds by its name."""
    return h1 / 2 + h2 * 0


def systems_over(K):
    """{what: system}."""
    inertia = (1, 2, 4)
    return {
        "ball": ChaplyginBall(inertia, "0.7", field=K),
        "ball in metres": ChaplyginBall(inertia, mass=2, radius="1/2", field=K),
        "top": EulerTop(inertia, field=K),
        "tilde": Tilde(inertia, field=K),
        "rolling tilde": Tilde(inertia, "0.7", field=K),
        "tilde in poles": Tilde(inertia, potential=(0, 0, 1, 1, 1), field=K),
        "tilde in a field": Tilde(inertia, potential=(1, 0, 0, 0, 0), field=K),
        "check": Check(inertia, field=K),
        "hat": Hat(inertia, field=K),
        "gyroscopic": Gyroscopic(inertia, 1, field=K),
        "ellipsoid": Ellipsoid(inertia, K),
        "garnier": Garnier(inertia, field=K),
        "henon heiles": HenonHeiles(inertia, field=K),
        "kowalevski": KowalevskiTop(K),
        "galaxy": KuzminKutuzov(inertia[:2], 1, K),
        "lagrange": LagrangeTop("3/4", K),
        "neumann": Neumann(inertia, K),
        "pendulum": SphericalPendulum(K),
        "toda": TodaLattice(3, K),
        "two gaps": TwoGaps((0, -5, 0), K),
        "veselova": Veselova(inertia, K),
        "ball on the layer": BodyOnLayer(inertia, "0.7", K),
    }


def steps_of(system, deformed):
    """{what: step} of a ball and of a tilde pair."""
    turned = deformed.translation((30, -30))
    return {
        "torsion": system.torsion(),
        "translation": 2 * system.translation(["9/5", "5/2"]),
        "keyless": system.keyless(),
        "multiplication": system.multiplication(3),
        "shift": system.shift(curried),
        "composition": system.keyless() @ -system.torsion(),
        "curve translation": turned,
    }


def values_over(K):
    """{what: value} for a field of FIELDS."""
    systems = systems_over(K)
    ball, top = systems["ball"], systems["top"]
    state = ball.state(GAMMA, M)
    flow = ball.flow(state)
    tilted = ball.state(GAMMA, ("1/2", 1, "-1"), tilted=True)
    values = systems | steps_of(ball, systems["tilde"]) | {"state": state, "tilted state": tilted, "body": ball.body}
    values |= {
        "conic step": top.conic(0, 1),
        "hat map": top.hat_map(),
        "isometric step": systems["check"].translation((30, -30)),
        "flow": flow,
        "lattice flow": systems["toda"].flow(systems["toda"].state((0, 1, 2), (1, 0, 0))),
        "pendulum flow": systems["pendulum"].flow(systems["pendulum"].state((0, "3/5", "4/5"), ("1/2", 0, 0))),
        "star": systems["galaxy"].flow(systems["galaxy"].state((1, 0, "1/2"), (0, "1/2", 0))),
        "sphere flow": systems["veselova"].flow(systems["veselova"].state(GAMMA, M)),
        "path": systems["toda"].flow(systems["toda"].state((0, 1, 2), (1, 0, 0))).at([0, 1]),
        "enclosed path": systems["toda"].flow(systems["toda"].state((0, 1, 2), (1, 0, 0))).enclosure([0, 1]),
        "tilted flow": ball.flow(tilted),
        "flow on the layer": systems["ball on the layer"].flow(systems["ball on the layer"].state(GAMMA, M)),
        "kdv": KdV((0, 1, 2), K),
        "run": flow.at([0, "1/3", 2]),
        "run in tau": flow.at_tau([1, 2]),
        "certified run": flow.certify([1]),
        "enclosure": flow.enclosure([1, 2]),
        "orbit": orbit(ball.keyless(), state, 3),
        "integrals": ball.integrals(state),
        "transformation": ball.upright(tilted)[2],
        "separated": ball.separated(state),
        "divisor": ball.divisor(state),
    }
    turned = RigidBody([[1, "0.1", 0], ["0.1", 2, 0], [0, 0, 2]], field=K)
    rolling = RollingBall((1, 2, 2), 5, 1, field=K).motion(np.eye(3), (1, 2, 3))
    values |= {
        "rigid body": turned,
        "rolling ball": rolling.body,
        "motion in the laboratory": turned.motion(np.eye(3), (1, 2, 3)),
        "rolling motion": rolling,
        "flow in the laboratory": rolling.flow,
        "run in the laboratory": rolling.at([0, 1]),
        "portrait": flow.portrait,
        "portrait of any genus": systems["toda"].flow(systems["toda"].state((0, 1, 2), (1, 0, 0))).portrait,
    }
    if K is RR:
        values["fit"] = OrientationFit(turned.motion(np.eye(3), (1, 2, 3)), np.array([0.5, 1.0]), 1e-3, np.eye(8))
        values["diagram"] = ball.diagram()
        values["section"] = ball.flow(state).section(3)
        toda = systems["toda"].flow(systems["toda"].state((0, 1, 2), (1, 0, 0)))
        values["section of any genus"] = toda.section(3)
        values["spectrum"] = ball.flow(state).spectrum()
        values["sensitivity"] = ball.flow(state).sensitivity([0, 1.0])
        values["conditioning"] = conditioning(ball, state, [1.0])
    for name in ("tilde", "rolling tilde", "tilde in poles", "tilde in a field", "check", "hat", "gyroscopic"):
        motion = systems[name].motion_through(state)
        values |= {f"motion of {name}": motion, f"run of {name}": motion.at(["1/10"])}
    return values


def other_values():
    """Values that belong to no field of FIELDS."""
    exact = ChaplyginBall((1, 2, 4), 1, field=GF(10007))
    many = ensemble(ChaplyginBall((1, 2, 4), 0.7), (0.48, 0.6, 0.64), (0.384, 1.28, -1.488), d=(0.7, -1, 0.5))
    values = {"scene": load_scene("chaplygin"), "exact ball": exact, "exact step": exact.torsion()}
    bodies = laboratory_ensemble(RollingBall((1, 2, 2), 5, 1), [np.eye(3), 2 * np.eye(3)], (1, 2, 3))
    lattice = ClassicalSystem(TodaLattice(3))
    values["run without a body"] = lattice.motion_through(lattice.state((0, 1, 2), (1, 0, 0))).at([0, 1])
    chains = ensemble(lattice.system, (0, 1, 2), [(1, 0, 0), (0, 1, 0)])
    values |= {"ensemble of a system": chains, "paths": chains.at([0, 1])}
    values |= {"ensemble in the laboratory": bodies, "runs in the laboratory": bodies.at([0, 1])}
    return values | {"ensemble": many, "trajectories": many.at([0, 1, 1e30])}
