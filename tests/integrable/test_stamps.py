"""A stamp identifies a system by value: a different parameter gives a different stamp. A repr is the call that makes
the system.
"""

import dataclasses
import json
import warnings
from fractions import Fraction
from inspect import signature

import numpy as np
import pytest

import integrable
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
    sweep,
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
from integrable.files.quantities import stamp
from integrable.phase.made import Made
from integrable.scene.data import Times
from integrable.systems.on_layer import BodyOnLayer
from jacobian import GF, MP, QQ, RR, ArgumentError
from tests.jacobian.test_values import descendants

GAMMA, M = (0.48, 0.6, 0.64), (0.384, 1.28, -1.488)
INERTIA, POTENTIAL = (4, 5, 7), (1, 2, 3, 5, 6)
TENSOR = ((4, Fraction(1, 3), 0), (Fraction(1, 3), 5, 1), (0, 1, 7))
MADE = [
    (ChaplyginBall, {"inertia": INERTIA, "d": 2}),
    (ChaplyginBall, {"inertia": INERTIA, "d": 2, "radius": 3}),
    (ChaplyginBall, {"inertia": INERTIA, "mass": 2, "radius": 3}),
    (EulerTop, {"inertia": INERTIA}),
    (Tilde, {"inertia": INERTIA, "d": 2}),
    (Tilde, {"inertia": INERTIA, "d": 2, "potential": POTENTIAL}),
    (Check, {"inertia": INERTIA, "potential": POTENTIAL}),
    (Hat, {"inertia": INERTIA, "potential": POTENTIAL}),
    (Gyroscopic, {"inertia": INERTIA, "c": 2}),
    (BodyOnLayer, {"inertia": INERTIA, "d": 2}),
    (Ellipsoid, {"a": INERTIA}),
    (Garnier, {"a": INERTIA, "alpha": 2, "beta": 3}),
    (HenonHeiles, {"a": INERTIA, "alpha": 2, "beta": 3, "gamma": 8, "barriers": (1, 2, 3)}),
    (KdV, {"edges": (1, 3, 5)}),
    (KowalevskiTop, {}),
    (KuzminKutuzov, {"axes": (2, 1), "GM": 3}),
    (LagrangeTop, {"j": 2}),
    (Neumann, {"a": INERTIA}),
    (SphericalPendulum, {}),
    (TodaLattice, {"n": 3}),
    (TwoGaps, {"sums": (1, 5, 2)}),
    (Veselova, {"inertia": INERTIA}),
    (RigidBody, {"inertia": TENSOR}),
    (RigidBody, {"inertia": (4, 5, 7)}),
    (RollingBall, {"inertia": (4, 5, 7), "mass": 20, "radius": 3}),
]
FIELDS = {"RR": RR, "MP(30)": MP(30), "MP(40)": MP(40), "QQ": QQ, "GF(10007)": GF(10007), "GF(7^5)": GF(7, 5)}
SWEPT = [(kind, given) for kind, given in MADE[:9]]


def inexact(kind):
    return kind in (KdV, RigidBody, RollingBall)


def changed(given):
    """The arguments with one number changed, for each number in turn."""
    for name, value in given.items():
        if name == "n":
            yield {**given, name: value + 1}
        elif value is TENSOR:
            moved = np.array(value, dtype=object)
            for i, j in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)):
                own = moved.copy()
                own[i, j] += Fraction(1, 3)
                own[j, i] = own[i, j]
                yield {**given, name: own.tolist()}
        elif isinstance(value, tuple):
            for i, x in enumerate(value):
                yield {**given, name: (*value[:i], x + Fraction(1, 3), *value[i + 1 :])}
        else:
            yield {**given, name: value + Fraction(1, 3)}


def made(kind, given, K):
    """The system, or None where this field has no such numbers."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        if FIELDS["GF(7^5)"] == K:
            # ints stand for elements of this field
            given = {name: _whole(value) for name, value in given.items()}
        return kind(**given, field=K)


def _whole(value):
    return tuple(map(_whole, value)) if isinstance(value, (tuple, list)) else int(3 * value)


def test_every_system_is_in_the_table():
    ours = {kind for kind in descendants(Made) if kind.__module__.startswith("integrable.")}
    leaves = {kind for kind in ours if not ours & set(kind.__subclasses__())}
    assert leaves | {RigidBody} == {kind for kind, _ in MADE}
    for kind in leaves:
        given = set().union(*(own for other, own in MADE if other is kind))
        assert given == set(signature(kind).parameters) - {"field"}, kind


@pytest.mark.thinned(5)
@pytest.mark.parametrize("name", FIELDS)
@pytest.mark.parametrize(("kind", "given"), MADE, ids=lambda x: x.__name__ if isinstance(x, type) else "-".join(x))
def test_a_stamp_says_every_parameter(kind, given, name):
    K = FIELDS[name]
    if K.exact and inexact(kind):
        pytest.skip("of inexact fields")
    systems = [made(kind, own, K) for own in [given, *changed(given)]]
    stamps = [stamp(system) for system in systems]
    assert len(set(stamps)) == len(stamps)
    assert stamp(made(kind, given, K)) == stamps[0]
    assert json.loads(stamps[0])["version"] == integrable.files.frame.version()
    others = {stamp(made(kind, given, other)) for key, other in FIELDS.items() if not (other.exact and inexact(kind))}
    assert len(others) == sum(not (other.exact and inexact(kind)) for other in FIELDS.values())


@pytest.mark.thinned(5)
@pytest.mark.parametrize("name", FIELDS)
@pytest.mark.parametrize(("kind", "given"), MADE, ids=lambda x: x.__name__ if isinstance(x, type) else "-".join(x))
def test_a_repr_makes_the_system(kind, given, name):
    K = FIELDS[name]
    if K.exact and inexact(kind):
        pytest.skip("of inexact fields")
    for own in [given, *changed(given)]:
        system = made(kind, own, K)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            assert eval(repr(system)) == system, repr(system)


def test_what_a_repr_looks_like():
    assert repr(Gyroscopic((1, 2, 3), 0.5)) == "Gyroscopic(inertia=(1.0, 2.0, 3.0), c=0.5)"
    assert repr(Tilde((1, 2, 3), potential=(0, 0, 1, 1, 1))) == (
        "Tilde(inertia=(1.0, 2.0, 3.0), potential=(0.0, 0.0, 1.0, 1.0, 1.0))"
    )
    assert repr(ChaplyginBall((1, "1/3", 3), "0.1", field=QQ)) == (
        "ChaplyginBall(inertia=(1, '1/3', 3), d='1/10', field=QQ)"
    )
    assert repr(EulerTop((1, 2, "0.3"), field=MP(30))) == "EulerTop(inertia=(1.0, 2.0, '0.3'), field=MP(30))"
    assert repr(EulerTop((1, 2, 3), field=GF(2, 3))) == "EulerTop(inertia=(1, 2, 3), field=GF(2, 3, (1, 1, 0, 1)))"
    assert repr(RigidBody((1, 2, "5/2"))) == "RigidBody(inertia=(1.0, 2.0, 2.5))"


class Heavier(ChaplyginBall):
    """A user's own system, with an argument that ``arguments`` lacks."""

    def __init__(self, inertia, d, extra=0.0, *, field=RR):
        super().__init__(inertia, d, field=field)
        vars(self)["extra"] = extra


def test_a_system_with_an_argument_of_its_own_has_no_stamp():
    assert Heavier((1, 2, 3), 1, 0.5) != Heavier((1, 2, 3), 1, 0.25)
    assert stamp(Heavier((1, 2, 3), 1)) != stamp(ChaplyginBall((1, 2, 3), 1))
    with pytest.raises(ArgumentError, match="its property arguments lacks some"):
        stamp(Heavier((1, 2, 3), 1, 0.5))


@pytest.mark.parametrize("suffix", [".h5", ".zarr"])
def test_a_sweep_of_another_c_is_not_taken_for_this_one(suffix, tmp_path):
    pytest.importorskip("h5py" if suffix == ".h5" else "zarr")
    out = tmp_path / f"c{suffix}"
    a, b = (ensemble(Gyroscopic((1, 2, 3), c), GAMMA, [M] * 3) for c in (0.5, 5.0))
    sweep(a, times=[0, 1, 2], out=out, executor="threads")
    with pytest.raises(ArgumentError, match="another file is there"):
        sweep(b, times=[0, 1, 2], out=out, executor="threads")


@pytest.mark.thinned(2)
@pytest.mark.parametrize(("kind", "given"), SWEPT, ids=lambda x: x.__name__ if isinstance(x, type) else "-".join(x))
def test_a_sweep_sees_every_parameter(kind, given, tmp_path):
    pytest.importorskip("h5py")
    out = tmp_path / "one.h5"
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        sweep(ensemble(kind(**given), GAMMA, M), times=[0.25], out=out, executor="threads")
    for own in changed(given):
        with pytest.raises(ArgumentError, match="another file is there"):
            sweep(ensemble(kind(**own), GAMMA, M), times=[0.25], out=out, executor="threads")


def test_a_stamp_tells_times_from_members(tmp_path):
    """Times and members with the same bytes, divided differently."""
    pytest.importorskip("h5py")
    out, rows = tmp_path / "out.h5", np.tile([*GAMMA, *M, 1, 2, 3], 2)
    sweep(ensemble(EulerTop((1, 2, 3)), GAMMA, M), times=rows[:10], out=out, executor="threads", chunk=1)
    with pytest.raises(ArgumentError, match="another file is there"):
        sweep(ensemble(EulerTop((1, 2, 3)), GAMMA, [M, M]), times=rows[:1], out=out, executor="threads", chunk=1)


SHOWN = {"title": "x", "reference": "x", "description": "x", "report": None, "pictures": ("x",), "place": "x"}
TWICE = ("gamma", "M", "inertia", "d", "mass", "radius", "potential", "c")
REFUSED = {"digits", "steps", "finite_field", "constants", "sphere"}
"""Entries of a scene that a sweep refuses, or leaves out."""


def scenes():
    """Scenes that differ from each other in one entry each, in several systems."""
    ball = dataclasses.replace(load_scene("chaplygin"), times=Times(given=(Fraction(1, 4),)), d=Fraction(7, 10))
    top = dataclasses.replace(ball, system="euler_top", d=None)
    bases = [
        ball,
        top,
        dataclasses.replace(ball, d=None, mass=Fraction(3), radius=Fraction(1, 2)),
        dataclasses.replace(top, system="tilde", potential=tuple(map(Fraction, POTENTIAL))),
        dataclasses.replace(top, system="gyroscopic", c=Fraction(1)),
    ]
    other = {"tilted": True, "name": "x", "times": Times(given=(Fraction(1, 3),))}
    yield from bases
    yield from (dataclasses.replace(ball, **{name: value}) for name, value in other.items())
    for base in bases:
        for name in TWICE:
            value = getattr(base, name)
            if value is not None:
                factor = -1 if name == "gamma" else 2
                own = tuple(factor * x for x in value) if isinstance(value, tuple) else factor * value
                yield dataclasses.replace(base, **{name: own})


def test_the_sweep_of_a_scene_sees_every_entry(tmp_path):
    pytest.importorskip("h5py")
    plain, *others = scenes()
    seen = {*SHOWN, *TWICE, *REFUSED, "system", "name", "times", "tilted"}
    assert {field.name for field in dataclasses.fields(plain)} == seen
    out = tmp_path / "out.h5"
    found = sweep(plain, out=out, executor="threads")
    for name, value in SHOWN.items():
        assert sweep(dataclasses.replace(plain, **{name: value}), out=out, executor="threads") == found
    for other in others:
        with pytest.raises(ArgumentError, match="another file is there"):
            sweep(other, out=out, executor="threads")


def test_numbers_that_python_does_not_write():
    """Ints of more than 4300 digits: a repr and a stamp raised Python's ValueError, and so did the repr of a state."""
    long = 10**5000
    systems = [EulerTop((x, 2, 3), field=QQ) for x in (long, long + 1, Fraction(1, long), Fraction(1, long + 1))]
    assert len({stamp(system) for system in systems} | {repr(system) for system in systems}) == 8
    for system in systems[:2]:
        assert eval(repr(system)) == system
    assert "10000000…00000000[5001 digits]" in repr(systems[0].state((1, 0, 0), (0, long, 0)))
    state = systems[0].state((1, 0, 0), (0, Fraction(1, 2), 0))
    assert repr(state.M) == "(Fraction(0, 1), Fraction(1, 2), Fraction(0, 1))"
    assert repr(state) == f"State(gamma={state.gamma!r}, M={state.M!r}, g=None, tilted=False)"


@pytest.mark.thinned(2)
@pytest.mark.parametrize("suffix", [".h5", ".nc", ".csv"])
@pytest.mark.parametrize(
    ("kind", "given"), [*SWEPT, *MADE[-3:]], ids=lambda x: x.__name__ if isinstance(x, type) else "-".join(x)
)
def test_a_file_says_what_has_moved(kind, given, suffix, tmp_path):
    pytest.importorskip("xarray")
    system, path = made(kind, given, RR), tmp_path / f"run{suffix}"
    if isinstance(system, RigidBody):
        laboratory_ensemble(system, [np.eye(3)], (1, 2, 3)).at([0, 0.1]).save(path)
    else:
        system.motion_through(system.state(GAMMA, M)).at([0, 0.1]).save(path)
    found = attributes(path)
    assert found["system_stamp"] == stamp(system)
    again = json.loads(found["system_stamp"])
    assert kind(**again["arguments"], field=eval(again["field"])) == system
    for name in set(given) - {"mass", "inertia"}:
        np.testing.assert_array_equal(found[name], np.array(given[name], dtype=float))


def attributes(path):
    if path.suffix == ".csv":
        lines = [line[2:].split(": ", 1) for line in path.read_text(encoding="utf-8").split("\n") if line[:1] == "#"]
        return {name: json.loads(value) for name, value in lines}
    if path.suffix == ".nc":
        xarray = pytest.importorskip("xarray")
        with xarray.open_dataset(path) as data:
            return dict(data.attrs)
    h5py = pytest.importorskip("h5py")
    with h5py.File(path) as file:
        return dict(file.attrs)
