"""Public objects are values: they are immutable, compare by content, and survive pickle and copy."""

import copy
import pickle
from functools import cached_property
from itertools import combinations

import numpy as np
import pytest

import jacobian
from jacobian import GF, MP, QQ, RR, CurveMismatch, HyperellipticCurve, JacobianError
from jacobian.batch import DivisorArray
from jacobian.immutable import Immutable, Record
from jacobian.relatives.ray_class import RayClassGroup
from tests.jacobian.public_values import FIELDS, curve_over, values_over

VALUES = {f"{name} over {kind}": value for kind, K in FIELDS.items() for name, value in values_over(K).items()}


def descendants(kind):
    for child in kind.__subclasses__():
        yield child
        yield from descendants(child)


def same(x, y):
    found = x == y
    return bool(found.all()) if isinstance(found, np.ndarray) else found is True


def attributes(value):
    """The public attributes that a value holds, computed ones and slots included."""
    names = set(getattr(value, "__dict__", ()))
    for cls in type(value).__mro__:
        names |= {*vars(cls).get("__slots__", ()), *vars(cls).get("__annotations__", ())}
        names |= {name for name, x in vars(cls).items() if isinstance(x, (cached_property, property))}
    return sorted(name for name in names if not name.startswith("_") or name == "_sum_of")


def assert_sealed(value):
    """No attribute of a value can be set or deleted, and the error names the attribute."""
    for name in (*attributes(value), "something_new"):
        for change in (lambda name=name: setattr(value, name, None), lambda name=name: delattr(value, name)):
            with pytest.raises((AttributeError, TypeError)) as error:
                change()
            # named tuples have Python's own messages
            assert name in str(error.value) or isinstance(value, tuple)
            if isinstance(value, Immutable) and not hasattr(type(value), "__dataclass_fields__"):
                assert "make a new one" in str(error.value)


def test_the_table_holds_every_public_class():
    kinds = {type(value) for value in VALUES.values()}
    bases = {cls for kind in kinds for cls in kind.__mro__}
    for name in jacobian.__all__:
        named = getattr(jacobian, name)
        if isinstance(named, type) and not issubclass(named, JacobianError) and named is not jacobian.Field:
            assert named in bases, name
    ours = {kind for kind in descendants(Immutable) if kind.__module__.startswith("jacobian.")} - {Record}
    assert {kind.__name__ for kind in ours if not kind.__name__.startswith("_")} <= {kind.__name__ for kind in bases}


@pytest.mark.parametrize("what", VALUES)
def test_pickles_and_copies_are_equal(what):
    value = VALUES[what]
    for again in (pickle.loads(pickle.dumps(value)), copy.deepcopy(value), copy.copy(value)):
        assert type(again) is type(value)
        assert same(again, value)
        if not isinstance(value, DivisorArray):
            assert hash(again) == hash(value)
    assert (value == "something else") is False


def test_values_of_one_type_that_differ_compare_as_different():
    for (one, x), (other, y) in combinations(VALUES.items(), 2):
        if type(x) is type(y) and not isinstance(x, (DivisorArray, tuple)):
            kinds = {one.split(" over ")[1], other.split(" over ")[1]}
            names = {one.split(" over ")[0], other.split(" over ")[0]}
            if len(kinds) == 2 and names != {"point at infinity"}:
                assert x != y, (one, other)


def test_a_value_says_what_it_is():
    """Extended and signed groups and five other classes had Python's default text."""
    for what, value in VALUES.items():
        assert " object at 0x" not in repr(value), what


@pytest.mark.parametrize("what", VALUES)
def test_nothing_can_be_set_or_deleted(what):
    assert_sealed(VALUES[what])


def test_what_is_computed_later_is_kept():
    C = curve_over(GF(101))
    assert C.discriminant is C.discriminant
    assert C.jacobian() is C.jacobian()
    assert "discriminant" not in C.__getstate__()


def test_two_curves_do_not_become_one():
    C, other = curve_over(GF(101)), HyperellipticCurve(GF(101), [2, 0, 0, 3, 0, 1])
    D, E = C.jacobian().from_points([C.lift_x(0)]), other.jacobian().random(np.random.default_rng(1))
    for change in (
        lambda: setattr(other, "f", C.f),
        lambda: setattr(other.jacobian(), "curve", C),
        lambda: setattr(DivisorArray.stack([E]), "jacobian", C.jacobian()),
        lambda: setattr(E, "jacobian", C.jacobian()),
    ):
        with pytest.raises(AttributeError, match="cannot be set"):
            change()
    with pytest.raises(CurveMismatch):
        D + E


@pytest.mark.parametrize("K", [GF(101), GF(7, 2), QQ, RR, MP(30)], ids=str)
def test_arrays_that_went_in_or_came_out_are_not_those_inside(K):
    C = curve_over(K)
    D = C.jacobian().from_points([(0, 1)])
    A = DivisorArray.stack([D, D.jacobian.zero()])
    for array in (A.u, A.v):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 0
    u, v = A.u.copy(), A.v.copy()
    B = DivisorArray.from_arrays(C.jacobian(), u, v)
    u[:], v[:] = K.one, K.one
    assert same(B, A)
    f = [K.coerce(x) for x in (1, 0, 0, 3, 0, 1)]
    curve = HyperellipticCurve(K, f)
    f[0] = K.coerce(5)
    assert curve == C
    assert A.n is None


@pytest.mark.parametrize("kind", FIELDS)
def test_sums_start_with_the_int_zero(kind):
    K = FIELDS[kind]
    J = curve_over(K).jacobian()
    D = VALUES[f"divisor over {kind}"]
    A = DivisorArray.stack([D, D])
    assert sum([D, D]) == D + D == np.sum([D, D])
    assert 0 + D == D + 0 == D - 0 == np.int64(0) + D == D
    assert 0 - D == -D
    assert sum([D, -D]) == J.zero()
    assert np.sum(A) == A.sum() == np.sum(A, axis=0)
    assert same(sum([A, A]), A + A)
    assert same(0 - A, -A)
    for other in (1, 0.0, "0", None, False):
        for add in (lambda x=other: x + D, lambda x=other: D + x, lambda x=other: x - D, lambda x=other: A + x):
            with pytest.raises(TypeError, match=r"unsupported operand|can only concatenate"):
                add()
    if K.exact:
        c = RayClassGroup(curve_over(K)).lift(D)
        assert sum([c, c]) == c + c
        assert 0 - c == -c
