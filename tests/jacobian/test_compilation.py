"""``python -m jacobian compile``: its list, which covers every library."""

from random import Random

import pytest

from jacobian import CC, GF, QQ, RR, HyperellipticCurve, compilation
from jacobian.__main__ import main
from jacobian.batch import DivisorArray
from jacobian.native.library import Library

QUINTIC, SEXTIC, SEPTIC = [1, 0, 0, 0, 0, 1], [1, 1, 0, 0, 0, 0, 1], [1, 1, 0, 0, 0, 0, 0, 1]
# h in characteristic 2, by the degree of f
WITH_H = {3: [1], 5: [1], 6: [1, 1, 0, 1]}
FIELDS = {
    "p < 2^29": GF(10007),
    "p < 2^31": GF(2**31 - 1),
    "p < 2^49": GF(2**49 - 81),
    "p < 2^61": GF(2**61 - 1),
    "p < 2^63": GF(2**63 - 25),
    "p < 2^128": GF(2**127 - 1),
    "GF(2^k), k ≤ 16": GF(2, 2, (1, 1, 1)),
    "GF(p^k) ≤ 2^16, p odd": GF(3, 2, (2, 2, 1)),
    "GF(2^n), 16 < n < 64": GF(2, 17, [1, 0, 0, 1, *[0] * 13, 1]),
    "GF(2^n), n < 128": GF(2, 127, [1, 1, *[0] * 125, 1]),
    "RR": RR,
    "CC": CC,
}


def curves(K):
    """Curves of every degree that has a library of its own over K, and one of genus 1."""
    others = () if K in (RR, CC) else ([1, 1, 0, 1],) if K.characteristic in (2, 3) else ([1, 1, 0, 1], SEPTIC)
    for f in (QUINTIC, SEXTIC, *others):
        yield HyperellipticCurve(K, f, WITH_H[len(f) - 1] if K.characteristic == 2 else ())


def use(C):
    """Everything that is compiled for single classes and for arrays on C."""
    J = C.jacobian()
    D = J.random(Random(1))
    if C.field.exact:
        J.compile()
        3 * D + D
    A = DivisorArray.stack([D, J.zero(), 2 * D])
    B = DivisorArray.from_arrays(J, A.u, A.v, A.n)
    A + B[::-1], -A, A.double(), 3 * A, A * [1, 2, 3], A.sum(), J.random(Random(1), size=2)


@pytest.fixture
def used(monkeypatch):
    """The names of the libraries that are used."""
    names, load = set(), Library.load
    monkeypatch.setattr(Library, "load", lambda library: (names.add(library.name), load(library))[1])
    # the entries of a library that was loaded before are attributes: these are forgotten
    for library in compilation.libraries():
        for name in library._functions:
            monkeypatch.delitem(library.__dict__, name, raising=False)
    return names


LISTED = [library.name for library in compilation.libraries()]


def test_a_library_is_listed_once():
    assert len(LISTED) == len(set(LISTED))


def test_every_library_of_orders_is_listed(used):
    HyperellipticCurve(GF(1_048_583), QUINTIC).cartier_manin()
    HyperellipticCurve(GF(40_009), QUINTIC).cartier_manin()
    HyperellipticCurve(QQ, QUINTIC).l_polynomials(2000)
    assert {"matrix_products", "Cartier-Manin", "decisions"} <= used <= set(LISTED)


@pytest.mark.slow
def test_the_libraries_of_classes_and_rows_are_those_listed(used):
    for K in FIELDS.values():
        for C in curves(K):
            use(C)
    others = {"decisions", "walks_to_p", "Cartier-Manin", "matrix_products", "miller", "sums_on_kummer_surfaces"}
    assert used == set(LISTED) - others


def test_the_command(monkeypatch, capsys):
    monkeypatch.setattr(compilation, "libraries", lambda: [compilation.product_kernels.kernels()])
    assert main(["compile"]) == 0
    (line,) = capsys.readouterr().out.splitlines()
    assert line.endswith(" s  matrix products")
    assert float(line.split()[0]) >= 0


def test_a_wrong_command_is_named(capsys):
    with pytest.raises(SystemExit):
        main(["compil"])
    assert "compil" in capsys.readouterr().err
