"""Single times in every form; the runs and files that a scene may request."""

from decimal import Decimal
from fractions import Fraction

import numpy as np
import pytest

from integrable import ChaplyginBall, Tilde, load_scene
from jacobian import MP, RR, ArgumentError
from tests.integrable.scene_texts import MIXED

SPACED = MIXED.replace('[0, 0.1, "1/3"]', '{ until = "10", count = 400 }')


@pytest.mark.parametrize("K", [RR, MP(20)], ids=str)
@pytest.mark.parametrize(
    "time", ["3/2", "1.5", Fraction(3, 2), Decimal("1.5"), 1.5, np.float32(1.5), np.array(1.5)], ids=repr
)
def test_one_time_in_any_form(K, time):
    gamma, M = ("0.48", "0.6", "0.64"), ("0.384", "1.28", "-1.488")
    for system in (ChaplyginBall((1, 2, 4), "0.7", field=K), Tilde((1, 2, 4), field=K)):
        flow = system.flow(system.state(gamma, M))
        expected = flow.at([K.coerce("3/2")])
        for times in (time, [time]):
            found = flow.at(times)
            assert found.gamma.shape == (1, 3)
            assert (found.gamma == expected.gamma).all()


def test_a_scene_of_too_many_times_says_what_they_would_take(tmp_path):
    path = tmp_path / "long.toml"
    path.write_text(SPACED.replace("count = 400", "count = 1000000000"), encoding="utf-8")
    with pytest.raises(ArgumentError, match=r"count: 1000000000 given; 10000000 is the most, these would take 150 GB"):
        load_scene(path)


def test_a_scene_may_begin_with_a_byte_order_mark(tmp_path):
    path = tmp_path / "marked.toml"
    path.write_text(SPACED, encoding="utf-8-sig")
    assert load_scene(path).times.count == 400
