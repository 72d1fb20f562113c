"""The data set of certified trajectories is complete, follows its schema, and is correct."""

from __future__ import annotations

import hashlib
import json
from importlib.resources import files

import pytest

from integrable.oracles.reference import taylor
from integrable.problems import problem
from integrable.problems.certified import certified, certified_names, schema
from integrable.scene.file import load_scene, scene_names
from jacobian import MP
from jacobian.errors import ArgumentError

DEFORMED = ("tilde", "check", "hat", "gyroscopic")
FOLDER = files("integrable").joinpath("certified")


def test_files_are_those_of_their_checksums():
    lines = FOLDER.joinpath("SHA256SUMS").read_text(encoding="utf-8").splitlines()
    assert {line.split()[1] for line in lines} == {"trajectories.json"}
    for line in lines:
        digest, name = line.split()
        assert hashlib.sha256(FOLDER.joinpath(name).read_bytes()).hexdigest() == digest


def test_the_file_is_what_its_schema_says():
    jsonschema = pytest.importorskip("jsonschema")
    content = json.loads(FOLDER.joinpath("trajectories.json").read_text(encoding="utf-8"))
    jsonschema.Draft202012Validator.check_schema(schema())
    jsonschema.Draft202012Validator(schema()).validate(content)
    assert content["count"] == len(content["motions"]) == len(certified_names()) == 46
    assert all(len(motion["rows"]) == 50 for motion in content["motions"])


def test_a_motion_with_the_name_of_a_scene_is_that_scene():
    """The bodies and descriptions in the file, for readers in other languages, are those of the package's list."""
    for name in set(certified_names()) & set(scene_names()):
        motion, (system, state) = certified(name), load_scene(name).start(15)
        assert motion.about == " ".join(load_scene(name).description.split())
        assert motion.inertia == tuple(map(float, system.body.inertia))
        assert motion.d == float(system.d)
        for row, vector in ((motion.gamma[0], state.gamma), (motion.M[0], state.M)):
            assert max(abs(float(x) - y) for x, y in zip(row, vector, strict=True)) < 1e-15 * max(map(abs, state.M))


@pytest.mark.parametrize("name", ["random_01", "random_06", "heavy"])
def test_the_other_motions_are_problems_too(name):
    """They start from doubles, which differ from the strings of the first row by 1e-16."""
    motion, one = certified(name), problem(name)
    assert one.times == motion.times
    assert one.description == motion.about
    found = one.truth(motion.times[2]).y
    expected = [float(x) for x in (*motion.gamma[2], *motion.M[2])]
    assert abs(found - expected).max() < 1e-12 * max(map(abs, expected))


@pytest.mark.thinned(3)
@pytest.mark.parametrize("name", certified_names())
def test_floats_of_the_flow_agree(name):
    motion = certified(name)
    system, state = motion.start()
    flow = system.motion_through(state) if motion.system in DEFORMED else system.flow(state)
    found = flow.at([motion.times[k] for k in (0, 1, 25, 49)])
    scale = max(abs(float(x)) for x in motion.M[0])
    # here the start is rounded to doubles, and next to a separatrix the rounding error grows
    bound = 1e-4 if "separatrix" in name else 1e-8
    for row, k in enumerate((0, 1, 25, 49)):
        assert max(abs(x - float(y)) for x, y in zip(found.gamma[row], motion.gamma[k], strict=True)) < bound
        assert max(abs(x - float(y)) for x, y in zip(found.M[row], motion.M[k], strict=True)) < bound * scale


@pytest.mark.parametrize("name", ["chaplygin", "tilted_ball", "euler_top", "random_01", "random_04"])
def test_an_integrator_that_shares_no_code_agrees_within_the_bounds(name):
    """Taylor series at 40 digits from the first row; the digits of that row limit the comparison."""
    motion = certified(name)
    system, _ = motion.start()
    exact = type(system)(motion.inertia, **({"d": motion.d} if motion.d else {}), field=MP(40))
    start = exact.state(motion.gamma[0], motion.M[0], tilted=True)
    true = taylor(exact, start, [motion.times[k] for k in (1, 2)], digits=40)
    for row, k in enumerate((1, 2)):
        for x, y in zip(true.gamma[row], motion.gamma[k], strict=True):
            assert abs(x - exact.field.coerce(y)) < 100 * (motion.bound[k] + 1e-33)


@pytest.mark.parametrize("name", ["tilde", "check", "hat", "tilde_poles"])
def test_deformations_are_where_their_curves_say(name):
    """The balls come from Taylor series, with which additions on two elliptic curves at 40 digits share nothing."""
    motion = certified(name)
    system, _ = motion.start()
    exact = system.over(MP(40))
    K = exact.field
    start = exact.state(motion.gamma[0], motion.M[0])
    assert exact.motion_through(start).method == "elliptic curves"
    run = exact.motion_through(start).at([K.coerce(motion.times[k]) for k in (1, 20)])
    scale = max(abs(K.coerce(x)) for x in motion.M[0])
    for row, k in enumerate((1, 20)):
        # the start is known to 34 digits, and the motion magnifies its error
        for x, y in zip(run.gamma[row], motion.gamma[k], strict=True):
            assert abs(x - K.coerce(y)) < 1e-30
        for x, y in zip(run.M[row], motion.M[k], strict=True):
            assert abs(x - K.coerce(y)) < 1e-30 * scale


def test_a_name_that_is_none_gets_the_names():
    with pytest.raises(ArgumentError, match="thin_ball"):
        certified("thin")
    with pytest.raises(ArgumentError, match=r"name = \['thin_ball'\]: give one of"):
        certified(["thin_ball"])


def test_a_damaged_file_is_noticed(monkeypatch):
    from integrable.problems import certified as module

    read = module._text
    monkeypatch.setattr(module, "_text", lambda folder, name: read(folder, name).replace("0.48", "0.49"))
    with pytest.raises(ArgumentError, match="SHA256SUMS"):
        certified_names()
