"""Moments that no distribution of mass has: a one-line warning names the inequality, and the motion is still
computed.
"""

import warnings
from fractions import Fraction
from importlib.resources import files

import pytest

from integrable import ChaplyginBall, EulerTop, Tilde, load_scene
from integrable.laboratory.bodies import RigidBody, RollingBall
from integrable.phase.body import UnphysicalMoments
from integrable.scene.file import scene_names
from jacobian import GF, MP, QQ

KINDS = {
    "top": lambda moments, **field: EulerTop(moments, **field),
    "ball": lambda moments, **field: ChaplyginBall(moments, 1, **field),
    "free body": lambda moments, **field: RigidBody(moments, **field),
    "rolling ball": lambda moments, **field: RollingBall(moments, 100, 1, **field),
}


@pytest.mark.parametrize("kind", KINDS)
def test_a_moment_above_the_sum_of_the_others_is_accepted_with_a_warning(kind):
    with pytest.warns(
        UnphysicalMoments, match=r"no distribution of mass has these moments, for .*5.* > 1.* \+ 3"
    ) as said:
        KINDS[kind]((1, 5, 3))
    assert len(said) == 1
    assert said[0].filename == __file__ or kind not in ("top", "ball")
    assert "\n" not in str(said[0].message)


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("moments", [(1, 2, 3), (0.1, 0.7, 0.8), (2, 2, 2)])
def test_a_flat_body_is_no_reason_to_warn(kind, moments):
    KINDS[kind](moments)
    if kind in ("top", "ball"):
        KINDS[kind]([Fraction(str(x)) for x in moments], field=QQ)


@pytest.mark.filterwarnings("error")
def test_nothing_is_said_where_there_is_no_order_nor_twice():
    EulerTop((1, 5, 3), field=GF(101))
    # these are parameters of a Hamiltonian, not moments of a body
    Tilde((1, 2, 4)).over(MP(20))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        top = EulerTop((1, 2, 5))
    state = top.state((0.48, 0.6, 0.64), (0.384, 1.28, -1.488))
    run = top.flow(state).at([0.0, 2.0])
    assert run.integrals.H2[1] == pytest.approx(run.integrals.H2[0], rel=1e-14)
    assert repr(top) == "EulerTop(inertia=(1.0, 2.0, 5.0))"
    assert top.identity["type"].endswith("EulerTop")


def test_scenes_of_that_kind_say_so(tmp_path):
    for name in scene_names():
        scene = load_scene(name)
        if scene.system in ("chaplygin_ball", "euler_top") and not scene.finite_field:
            least, middle, most = sorted(scene.inertia)
            said = "No distribution of mass has these moments: " in " ".join(scene.description.split())
            assert said == (most > least + middle), name
    text = (files("integrable") / "scenes" / "euler_top.toml").read_text(encoding="utf-8")
    path = tmp_path / "own.toml"
    path.write_text(text.replace('inertia = ["1", "2", "3"]', 'inertia = ["1", "2", "5"]'), encoding="utf-8")
    with pytest.warns(UnphysicalMoments, match="5 > 1 "):
        load_scene(path)
