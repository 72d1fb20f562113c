"""Arrays of divisors equal Cantor's sums row by row, for every pair of small groups and every special case."""

import pickle
from random import Random

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from jacobian import GF, QQ, ArgumentError, CurveMismatch, Divisor, FieldError, HyperellipticCurve, NotOnCurve
from jacobian.batch import DivisorArray, array, compiled_rows, set_threads, threads
from jacobian.batch.block_loops import SCRATCH
from jacobian.batch.multiples import signed_windows
from jacobian.numbers.threads import in_ranges
from jacobian.numbers.words import Lazy32, Lazy64, Wide32, Wide64, word_context
from tests.jacobian.batch.beside_cantor import assert_equal_to_cantor, assert_rows_equal_cantor, random_rows, sums
from tests.jacobian.group_curves import genus_two_rows, random_curve, small_fields, triple
from tests.jacobian.jacobian_rows import ROWS

SMALL = small_fields("GF(2)")
CONTEXTS = {"Lazy32": Lazy32, "Wide32": Wide32, "Lazy64": Lazy64, "Wide64": Wide64}
PRIMES = {"Lazy32": 2**29 - 3, "Wide32": 2**31 - 1, "Double": 2**49 - 81, "Lazy64": 2**61 - 1, "Wide64": 2**63 - 25}
MODELS = ("ramified", "split", "inert")


@pytest.fixture
def context(request, monkeypatch):
    """Makes batches over every prime field use the context of this name."""
    kind = CONTEXTS[request.param]
    monkeypatch.setattr(compiled_rows, "word_context", lambda p: kind(*word_context(p, kind.bits)))
    return kind


def assert_every_pair(K, genus, model, with_h):
    J = random_curve(K, genus, "batch", model=model, with_h=with_h).jacobian()
    classes = list(J.points())
    assert len(classes) == J.order()
    assert_equal_to_cantor(J, classes[:: max(1, len(classes) // 250)])


@pytest.mark.thinned(4)
@pytest.mark.parametrize(("name", "model", "with_h"), genus_two_rows(SMALL))
def test_every_pair_of_a_small_group(name, model, with_h):
    assert_every_pair(SMALL[name], 2, model, with_h)


@pytest.mark.thinned(3)
@pytest.mark.parametrize("context", CONTEXTS, indirect=True)
@pytest.mark.parametrize("model", MODELS)
def test_every_pair_on_every_context(context, model):
    for K in (GF(3), GF(7)):
        J = random_curve(K, 2, "contexts", model=model, with_h=True).jacobian()
        assert type(array.engine(J).K) is context
        assert_equal_to_cantor(J, list(J.points()))


@pytest.mark.thinned(2)
@pytest.mark.parametrize("name", ["GF(3)", "GF(4)"])
@pytest.mark.parametrize("model", ["ramified", "split"])
@pytest.mark.parametrize("genus", [1, 3])
def test_every_pair_of_other_genera(name, model, genus):
    assert_every_pair(SMALL[name], genus, model, name == "GF(4)")


POOLS = [pytest.param(row, id=str(row)) for row in ROWS if row.genus < 4 or row.field == "GF(101)"]


@pytest.mark.thinned(3)
@pytest.mark.parametrize("row", POOLS)
def test_pools_of_special_classes(row):
    J = row.curve.jacobian()
    assert_equal_to_cantor(J, row.pool if row.K != QQ else row.pool[:4])


# --- large primes: explicit formulas compared with Cantor


def large_curve(name, model, monic=False):
    rng = Random(f"{name} {model}")
    K = GF(PRIMES[name])
    while True:
        f = [K.random(rng) for _ in range(6 if model == "ramified" else 7)]
        C = HyperellipticCurve(K, [*f[:-1], 1] if monic else f)
        if C.model == model and C.genus == 2:
            return C


@pytest.mark.thinned(2)
@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize("name", PRIMES)
def test_rows_over_large_primes(name, model):
    assert_rows_equal_cantor(large_curve(name, model).jacobian(), 4000, 50)


@pytest.mark.slow
@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize("name", PRIMES)
def test_many_rows(name, model):
    """All rows are compared with the compiled Cantor, a sample with Cantor in Python: residual 0."""
    assert_rows_equal_cantor(large_curve(name, model).jacobian(), 200_000, 1000)


@pytest.mark.parametrize("count", [1, 255, 256, 257, 513])
def test_ends_of_blocks(count):
    J = large_curve("Lazy64", "ramified").jacobian()
    A, B = random_rows(J, count, 3), random_rows(J, count, 4)
    assert (A + B).to_list() == sums(J, A, B)


# --- multiples and sums


@pytest.mark.thinned(2)
@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize("name", PRIMES)
def test_multiples(name, model):
    J = large_curve(name, model).jacobian()
    A = DivisorArray.stack([*random_rows(J, 5, 5), J.zero()])
    rng = Random(6)
    for m in (0, 1, -1, 2, 3, -7, 8, 100, rng.getrandbits(122), -rng.getrandbits(130)):
        assert (m * A).to_list() == [m * D for D in A]
    scalars = [0, -1, 6, rng.getrandbits(122), -rng.getrandbits(200), 1]
    expected = [m * D for m, D in zip(scalars, A, strict=True)]
    assert (scalars * A).to_list() == (A * scalars).to_list() == expected
    assert (np.arange(-3, 3) * A).to_list() == [m * D for m, D in zip(range(-3, 3), A, strict=True)]


@pytest.mark.parametrize("name", SMALL)
def test_multiples_in_a_small_group(name):
    K = SMALL[name]
    J = random_curve(K, 2, "multiples", model="split", with_h=True).jacobian()
    A = DivisorArray.stack(list(J.points()))
    scalars = [i * 7 - 60 for i in range(len(A))]
    assert (scalars * A).to_list() == [m * D for m, D in zip(scalars, A, strict=True)]
    assert not any(J.order() * A)


def test_multiples_of_odd_genus():
    row = next(row for row in ROWS if str(row) == "GF(101)-split-g3-h")
    A = DivisorArray.stack(row.pool)
    scalars = list(range(-5, len(A) - 5))
    assert (scalars * A).to_list() == [m * D for m, D in zip(scalars, A, strict=True)]
    assert (-12345 * A).to_list() == [-12345 * D for D in A]


def test_windows_give_the_scalar_back():
    scalars = [1, 3, 7, 9, 2**64 - 1, 2**200 + 1]
    windows = signed_windows(scalars)
    for i, m in enumerate(scalars):
        assert sum((2 * int(w) - 7) * 8**j for j, w in enumerate(windows[:, i])) == m


def test_sums():
    J = large_curve("Wide32", "ramified").jacobian()
    A = random_rows(J, 37, 7)
    total = J.zero()
    for D in A:
        total = total + D
    assert A.sum() == total
    assert A[:1].sum() == A[0]
    assert A[:0].sum() == J.zero()


# --- mixes of special rows

SPECIAL = HyperellipticCurve(GF(2**31 - 1), [0, 6, 11, 6, 1, 1]).jacobian()


def special_classes(J):
    rng = Random(8)
    C = J.curve
    P, Q, R = (C.random_point(rng) for _ in range(3))
    branch = C.point(0, 0)
    D = J.from_points([P, Q])
    points = ([P], [branch], [P, R], [P, branch], [Q, R], [P, C.involution(Q)], [P, P], [branch, R])
    return [J.zero(), D, -D, *(J.from_points(some) for some in points), J.random(rng), J.random(rng)]


POOL = special_classes(SPECIAL)
NUMBERS = st.integers(0, len(POOL) - 1)


@settings(max_examples=60)
@given(st.lists(st.tuples(NUMBERS, NUMBERS), min_size=1, max_size=600), st.integers(0, 20))
def test_mixes_of_special_rows(pairs, repeat):
    pairs = pairs + [pairs[0]] * repeat
    A, B = (DivisorArray.stack([POOL[pair[side]] for pair in pairs]) for side in (0, 1))
    known = {pair: SPECIAL._sum_of(triple(POOL[pair[0]]), triple(POOL[pair[1]])) for pair in set(pairs)}
    assert [triple(D) for D in A + B] == [known[pair] for pair in pairs]


def test_equal_rows_are_doubled():
    """A + A as two arrays: the only rows of full weight that Cantor adds have a branch point."""
    A = DivisorArray.stack(POOL * 50)
    B = DivisorArray.stack(POOL * 50)
    assert (A.double() == (A + B)).all()
    run = A._engine
    rows = np.empty(len(A), np.int64)
    out = run.empty(len(A))
    count = run._sums.add_rows(
        *run._constants,
        *((C._rows.data, C._rows.degree) for C in (A, B)),
        out.data,
        (0, len(A)),
        (rows, np.zeros(SCRATCH, run.dtype)),
    )
    special = {A[int(i)] for i in rows[:count]}
    assert special == {D for D in POOL if D.degree < 2 or D.u[0] == 0 or D.double().degree < 2}


# --- threads


def test_threads():
    J = large_curve("Wide32", "split").jacobian()
    A, B = random_rows(J, 40_000, 9), random_rows(J, 40_000, 10)
    try:
        results = []
        for count in (1, 2, 3):
            set_threads(count)
            assert threads() == count
            results.append((A + B, A.double(), -A, np.arange(len(A)) * A))
        for other in results[1:]:
            assert all((a == b).all() for a, b in zip(results[0], other, strict=True))
    finally:
        set_threads(None)
    assert threads() >= 1


@pytest.mark.parametrize("total", [0, 1, 999, 1000, 1001, 5000, 123_456])
@pytest.mark.parametrize("count", [1, 2, 3])
def test_ranges(total, count):
    try:
        set_threads(count)
        ranges = in_ranges(total, 1024, lambda begin, end: (begin, end))
    finally:
        set_threads(None)
    assert [i for begin, end in ranges for i in range(begin, end)] == list(range(total))
    lengths = [end - begin for begin, end in ranges]
    assert all(0 < length <= 1024 for length in lengths)
    if total > 1024 and count > 1:
        # every thread has the same number of ranges
        assert len(ranges) % count == 0
        assert max(lengths) - min(lengths) < len(ranges)


@pytest.mark.parametrize("count", [0, -1, "2", 1.5, True])
def test_a_wrong_number_of_threads(count):
    with pytest.raises(ArgumentError, match="count"):
        set_threads(count)


# --- as a container


@pytest.fixture
def A():
    return DivisorArray.stack(POOL)


def test_reading(A):
    assert len(A) == len(POOL) == len(list(A))
    assert A.u.shape == (len(A), 3)
    assert A.v.shape == (len(A), 2)
    assert A.n is None
    assert A.status.tolist() == [0] * len(A)
    assert A.degree.tolist() == [D.degree for D in POOL]
    for D, u, v in zip(POOL, A.u, A.v, strict=True):
        assert tuple(u[: len(D.u)]) == D.u
        assert tuple(v[: len(D.v)]) == D.v
        assert not u[len(D.u) :].any()
        assert not v[len(D.v) :].any()
    assert repr(A[:2]) == f"DivisorArray([{POOL[0]!r}, {POOL[1]!r}], 2 rows)"
    assert repr(A).endswith(f", …], {len(A)} rows)")


def test_weights():
    row = next(row for row in ROWS if str(row) == "GF(101)-split-g3-0")
    A = DivisorArray.stack(row.pool)
    assert A.n.tolist() == [D.n for D in row.pool]
    again = DivisorArray.from_arrays(A.jacobian, A.u, A.v, A.n)
    assert (again == A).all()
    shared = DivisorArray.from_arrays(A.jacobian, A.u, A.v)
    assert shared.n.tolist() == [(3 - D.degree + 1) // 2 for D in row.pool]


def test_indexing(A):
    assert A[1] == POOL[1]
    assert A[-1] == POOL[-1]
    assert A[np.int64(2)] == POOL[2]
    assert A[2:5].to_list() == POOL[2:5]
    assert A[::-2].to_list() == POOL[::-2]
    assert A[[3, 0, 3]].to_list() == [POOL[3], POOL[0], POOL[3]]
    assert A[A.degree == 2].to_list() == [D for D in POOL if D.degree == 2]
    assert A[[]].to_list() == A[:0].to_list() == []
    for i in (len(A), -len(A) - 1):
        with pytest.raises(IndexError):
            A[i]
    for key in ("a", 1.5, np.zeros((2, 2), int), [True], [0.5], None):
        with pytest.raises(ArgumentError, match="index"):
            A[key]


def test_stacking(A):
    B = DivisorArray.stack([A[:3], POOL[3], A[4:]])
    assert (A == B).all()
    assert DivisorArray.stack([], SPECIAL).to_list() == []
    assert DivisorArray.zeros(SPECIAL, 3).to_list() == [SPECIAL.zero()] * 3
    with pytest.raises(ArgumentError, match="parts"):
        DivisorArray.stack([])
    with pytest.raises(ArgumentError, match=r"parts\[1\]"):
        DivisorArray.stack([POOL[0], 7])
    with pytest.raises(ArgumentError, match="count"):
        DivisorArray.zeros(SPECIAL, -1)


def test_one_divisor_beside_an_array(A):
    D = POOL[1]
    assert (A + D).to_list() == (D + A).to_list() == [E + D for E in POOL]
    assert (A - D).to_list() == [E - D for E in POOL]
    assert (D - A).to_list() == [D - E for E in POOL]
    assert (A == D).tolist() == (D == A).tolist() == [E == D for E in POOL]
    assert (A != D).tolist() == [E != D for E in POOL]
    assert (+A).to_list() == POOL


def test_pickle(A):
    assert (pickle.loads(pickle.dumps(A)) == A).all()


# galois compiles its arithmetic for seconds, once for each characteristic
@pytest.mark.parametrize("field", [pytest.param("GF(101)", marks=pytest.mark.slow), "GF(2^8)"])
def test_galois_arrays(field):
    row = next(row for row in ROWS if row.field == field and row.genus == 2 and row.model == "split")
    A = DivisorArray.stack(row.pool)
    u, v = A.to_galois()
    assert isinstance(u, row.K.galois)
    assert (DivisorArray.from_arrays(A.jacobian, u, v, A.n) == A).all()
    other = GF(7).galois(np.zeros((len(A), 3), int))
    with pytest.raises(FieldError, match="u"):
        DivisorArray.from_arrays(A.jacobian, other, v, A.n)


def test_lists_and_large_ints(A):
    p = 2**31 - 1
    u, v = A.u.tolist(), [[c - 5 * p for c in row] for row in A.v.tolist()]
    assert (DivisorArray.from_arrays(SPECIAL, u, v) == A).all()
    assert (DivisorArray.from_arrays(SPECIAL, A.u.astype(np.uint64), A.v - p) == A).all()


def test_wrong_arrays(A):
    u, v = A.u, A.v
    make = DivisorArray.from_arrays
    with pytest.raises(ArgumentError, match=r"u: .*\(N, 3\)"):
        make(SPECIAL, u[:, :2], v)
    with pytest.raises(ArgumentError, match="rows beside"):
        make(SPECIAL, u[1:], v)
    with pytest.raises(ArgumentError, match="not monic"):
        make(SPECIAL, 2 * u, v)
    with pytest.raises(ArgumentError, match="lower degree"):
        make(SPECIAL, u, v + (A.degree < 2)[:, None])
    with pytest.raises(ArgumentError, match="n: a ramified"):
        make(SPECIAL, u, v, np.zeros(len(A), int))
    wrong = v.copy()
    wrong[5, 0] += 1
    with pytest.raises(NotOnCurve, match=r"row 5|row 3"):
        make(SPECIAL, u, np.where(A.degree[:, None] == 2, wrong, v))
    with pytest.raises(FieldError):
        make(SPECIAL, [["a", 0, 1]], [[0, 0]])


def test_wrong_elements_of_an_extension():
    row = next(row for row in ROWS if row.field == "GF(2^8)" and row.genus == 2 and row.model == "split")
    A = DivisorArray.stack(row.pool)
    with pytest.raises(FieldError, match="ints 0"):
        DivisorArray.from_arrays(A.jacobian, A.u + 256, A.v, A.n)
    with pytest.raises(ArgumentError, match=r"n\[0\] = 3"):
        DivisorArray.from_arrays(A.jacobian, A.u, A.v, np.full(len(A), 3))
    with pytest.raises(ArgumentError, match="n: an array"):
        DivisorArray.from_arrays(A.jacobian, A.u, A.v, [0.5] * len(A))


def test_an_odd_u_on_an_inert_model():
    C = random_curve(GF(7), 2, "inert", model="inert")
    with pytest.raises(ArgumentError, match="inert"):
        DivisorArray.from_arrays(C.jacobian(), [[0, 1, 0]], [[0, 0]])


def test_wrong_operands(A):
    other = large_curve("Lazy32", "ramified").jacobian()
    with pytest.raises(CurveMismatch):
        A + other.zero()
    with pytest.raises(CurveMismatch):
        DivisorArray.zeros(other, len(A)) != A  # noqa: B015
    with pytest.raises(CurveMismatch):
        DivisorArray.stack([A, other.zero()])
    with pytest.raises(ArgumentError, match="other: 2 rows"):
        A + A[:2]
    with pytest.raises(ArgumentError, match="scalar"):
        [1, 2] * A
    with pytest.raises(ArgumentError, match="scalar"):
        1.5 * A
    with pytest.raises(ArgumentError, match="scalar"):
        A * ([1.5] * len(A))
    with pytest.raises(TypeError):
        A * A
    with pytest.raises(TypeError):
        A + 1
    with pytest.raises(TypeError):
        hash(A)
    assert (A == 3) is False


# --- fields without a compiled kernel: the Jacobian itself


@pytest.mark.parametrize("K", [QQ, GF(2**89 - 1), GF(2**128 + 51), GF(2)], ids=str)
def test_rows_of_objects(K):
    C = HyperellipticCurve(K, [0, 24, 0, 1, 0, 1], [1] if K.characteristic == 2 else [])
    J = C.jacobian()
    rng = Random(11)
    pool = [J.zero(), *(J.from_points([P]) for P in [C.point(0, 0), C.lift_x(0)]), J.random(rng)]
    A = DivisorArray.stack(pool)
    B = A[::-1]
    assert (A + B).to_list() == [D + E for D, E in zip(pool, pool[::-1], strict=True)]
    assert ([1, -2, 3, 4] * A).to_list() == [m * D for m, D in zip([1, -2, 3, 4], pool, strict=True)]
    assert (A.double() == 2 * A).all()
    assert A.sum() == pool[0] + pool[1] + pool[2] + pool[3]
    assert (DivisorArray.from_arrays(J, A.u, A.v) == A).all()
    assert A.degree.tolist() == [D.degree for D in pool]
    assert all(isinstance(D, Divisor) for D in A)
    assert (DivisorArray.zeros(J, 2) == DivisorArray.stack([A[0], A[0]])).all()
    assert A.n is None
    if K == QQ:
        with pytest.raises(FieldError, match="galois"):
            A.to_galois()
    wrong = A.v.copy()
    wrong[0, 0] = K.one
    with pytest.raises(ArgumentError, match="lower degree"):
        DivisorArray.from_arrays(J, A.u, wrong)
    if K.characteristic != 2:
        wrong = A.u.copy()
        wrong[1, 0] = K.one
        with pytest.raises(NotOnCurve):
            DivisorArray.from_arrays(J, wrong, A.v)
