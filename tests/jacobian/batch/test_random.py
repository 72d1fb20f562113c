"""Random classes in arrays: on the curve, uniform in the group, reproducible from the seed."""

from functools import cache
from random import Random

import numpy as np
import pytest

from jacobian import GF, QQ, RR, ArgumentError, HyperellipticCurve, NotRepresentable
from jacobian.batch import DivisorArray, set_threads
from jacobian.batch.array import engine
from jacobian.batch.compiled_rows import CompiledRows
from jacobian.batch.random_rows import CHUNK, DISTANCE, sampler, windows
from jacobian.batch.two_word_rows import TwoWordRows
from jacobian.models.standard import move_to_infinity
from jacobian.relatives.glued import GeneralizedJacobian
from tests.jacobian.group_curves import random_curve

FIELDS = {
    "Wide64": GF(2**61 - 1),
    # p − 1 is divisible by 2^56, so that the algorithm of Tonelli and Shanks takes all its steps
    "27·2^56+1": GF(27 * 2**56 + 1),
    "Wide32": GF(2**31 - 1),
    "Double": GF(2**49 - 81),
    "2^64+13": GF(2**64 + 13),
    "2^127-1": GF(2**127 - 1),
    "GF(2^6)": GF(2, 6, (1, 1, 0, 0, 0, 0, 1)),
    "GF(3^5)": GF(3, 5, (1, 2, 0, 0, 0, 1)),
}


@pytest.mark.thinned(4)
@pytest.mark.parametrize("model", ["ramified", "split", "inert"])
@pytest.mark.parametrize("name", FIELDS)
def test_rows_are_classes(name, model):
    J = random_curve(FIELDS[name], 2, "random", model=model, with_h=True).jacobian()
    A = J.random(Random(1), size=40)
    again = DivisorArray.from_arrays(J, A.u, A.v, A.n)
    assert again.to_list() == A.to_list()
    assert [J.from_mumford(D.u, D.v, D.n) for D in A] == A.to_list()
    assert len(set(A)) > 35


@pytest.mark.parametrize("genus", [1, 3, 5])
def test_other_genera(genus):
    J = random_curve(GF(10007), genus, "random", model="ramified").jacobian()
    A = J.random(np.random.default_rng(1), size=50)
    assert [J.from_mumford(D.u, D.v) for D in A] == A.to_list()
    if genus < 5:
        assert not any(J.order() * A)


@cache
def cyclic_group(model):
    """A cyclic Jacobian of genus 2 with all its classes, ordered as multiples of a generator."""
    for seed in range(50):
        J = random_curve(GF(53), 2, seed, model=model).jacobian()
        structure = J.structure()
        if len(structure.invariants) == 1:
            multiples = [J.zero()]
            while (following := multiples[-1] + structure.generators[0]) != multiples[0]:
                multiples.append(following)
            return J, {D: i for i, D in enumerate(multiples)}
    raise AssertionError


@pytest.mark.thinned(3)
@pytest.mark.parametrize(
    ("model", "rows"),
    [
        # rows of two words take seconds
        pytest.param(model, rows, marks=pytest.mark.slow if rows is TwoWordRows else ())
        for model in ("ramified", "split", "inert")
        for rows in (CompiledRows, TwoWordRows)
    ],
)
def test_classes_are_uniform(model, rows, monkeypatch):
    """χ² over all classes of a group: all are equally frequent. Two words draw points by square roots."""
    J, logarithms = cyclic_group(model)
    monkeypatch.setitem(J.__dict__, "_rows", rows(J))
    assert sampler(engine(J)).possible
    each = 3 if rows is CompiledRows else 2
    A = J.random(Random(5), size=each * len(logarithms))
    seen = np.bincount([logarithms[D] for D in A], minlength=len(logarithms))
    freedom = len(logarithms) - 1
    chi_square = float(((seen - each) ** 2).sum()) / each
    assert abs(chi_square - freedom) < 4.5 * (2 * freedom) ** 0.5


@pytest.mark.parametrize("model", ["ramified", "split"])
def test_the_bound_of_weil_on_all_characters_of_a_group(model):
    """The bound proven in the docstring holds for all characters of a cyclic group. Their sums over the affine points
    are the discrete Fourier transform of the points' multiplicities; for k-fold sums these are its k-th powers.
    """
    J, logarithms = cyclic_group(model)
    C, found = J.curve, sampler(engine(J))
    order, infinite = len(logarithms), len(C.points_at_infinity())
    affine = list(C.points())[infinite:]
    one = np.bincount([logarithms[J(P)] for P in affine], minlength=order)
    sizes = np.abs(np.fft.fft(one))[1:]
    assert sizes.max() <= 2 * 53**0.5 + infinite
    distance = ((sizes / len(affine)) ** (4 * found.sets)).sum() ** 0.5 / 2
    assert distance < 2.0**-DISTANCE


def test_equal_seeds_give_equal_classes_on_any_number_of_threads():
    J = random_curve(GF(2**31 - 1), 2, "random", model="ramified").jacobian()
    count = 2 * CHUNK + 100
    try:
        set_threads(1)
        alone = J.random(np.random.default_rng(3), size=count)
        set_threads(2)
        assert bool((J.random(np.random.default_rng(3), size=count) == alone).all())
    finally:
        set_threads(None)
    assert not bool((J.random(np.random.default_rng(4), size=count) == alone).any())
    assert len(J.random(Random(1), size=0)) == 0


def test_where_nothing_is_compiled_classes_are_drawn_one_by_one():
    for K in (GF(2**130 - 5), GF(5), QQ, RR):
        J = HyperellipticCurve(K, [1, 0, 0, 0, 0, 1] if K is not GF(5) else [1, 1, 0, 0, 0, 1]).jacobian()
        A = J.random(Random(2), size=3)
        assert A.to_list() == [J.random(rng) for rng in [Random(2)] for _ in range(3)]


def test_what_has_no_random_arrays_is_refused():
    J = HyperellipticCurve(GF(7), [1, 1, 0, 0, 0, 0, 0, 0, 3]).jacobian()
    with pytest.raises(NotRepresentable, match="inert of odd genus"):
        J.random(Random(1), size=5)
    moved = move_to_infinity(J.curve, J.curve.random_point(Random(1))).target.jacobian()
    assert not any(J.order() * moved.random(Random(1), size=5))
    J = HyperellipticCurve(GF(7), [1, 2, 0, 0, 0, 1]).jacobian()
    for size in (-1, 1.5, "2", 10**9):
        with pytest.raises(ArgumentError, match="size = "):
            J.random(Random(1), size=size)
    glued = GeneralizedJacobian(HyperellipticCurve(GF(10007), [1, 2, 3, 4, 1]))
    with pytest.raises(NotRepresentable, match="size = 2: the classes of a generalized Jacobian"):
        glued.random(Random(1), size=2)
    with pytest.raises(ArgumentError, match="J = Generalized Jacobian"):
        DivisorArray.stack([glued.random(Random(1))])
    with pytest.raises(ArgumentError, match="rng = 3"):
        J.random(3, size=2)


@pytest.mark.parametrize("exponent", [0, 1, 2, 13, 2**59 - 1, 0xDEADBEEF12345])
def test_windows_of_an_exponent(exponent):
    found = [int(d) for d in windows(exponent)]
    assert sum(d << i for i, d in enumerate(reversed(found))) == exponent
    assert all(d == 0 or (d % 2 and d < 16) for d in found)
