"""``python -m jacobian compile``: its list, which covers every kernel."""

import pytest

from jacobian import compilation
from jacobian.__main__ import main
from jacobian.addition.calls import context, two_word_context
from jacobian.addition.short import BinaryQuintic, BinarySextic, Quintic, Septic, Sextic, short_equation
from jacobian.batch.array import engine
from jacobian.batch.compiled_rows import CompiledRows
from jacobian.batch.float_rows import FloatRows
from jacobian.batch.two_word_rows import TwoWordRows
from jacobian.finite.matrix_products import Products
from jacobian.numbers.binary import BinaryTwoWords, BinaryWord
from jacobian.numbers.two_words import TwoWords


def test_every_kernel_of_single_classes_is_listed():
    kinds = set()
    for C in compilation.single_curves().values():
        K = context(C.field)
        short = short_equation(C, K.to_word)
        kinds.add((type(K).__name__, type(short).__name__))
    several = {(K, equation) for K in ("Wide64", "OddTable") for equation in ("NoneType", "Quintic", "Sextic")}
    binary = {("BinaryTable", equation) for equation in ("NoneType", "BinaryQuintic", "BinarySextic")}
    assert kinds == several | binary | {("Wide64", "Septic")}


def test_every_kernel_of_arrays_is_listed():
    kinds = set()
    for C in compilation.batch_curves().values():
        rows = engine(C.jacobian())
        assert type(rows) is CompiledRows
        kinds.add((type(rows.K).__name__, type(rows.formulas).__name__))
    contexts = ("Lazy32", "Wide32", "Lazy64", "Wide64", "OddTable")
    several = {(K, equation) for K in contexts for equation in ("Quintic", "Sextic")}
    septics = {(K, "Septic") for K in contexts if K != "OddTable"}
    assert kinds == several | septics | {("BinaryTable", equation) for equation in ("BinaryQuintic", "BinarySextic")}


def test_every_kernel_of_two_words_is_listed():
    curves = compilation.two_word_curves().values()
    assert all(type(engine(C.jacobian())) is TwoWordRows for C in curves)
    kinds = {(type(K := two_word_context(C.field)), type(short_equation(C, K.to_word))) for C in curves}
    of_primes = {(TwoWords, equation) for equation in (Quintic, Sextic, Septic)}
    binary = {(K, equation) for K in (BinaryWord, BinaryTwoWords) for equation in (BinaryQuintic, BinarySextic)}
    assert kinds == of_primes | binary


def test_every_kernel_of_arrays_of_floats_is_listed():
    kinds = set()
    for C in compilation.float_curves().values():
        rows = engine(C.jacobian())
        assert type(rows) is FloatRows
        compilation.batch(C)
        # the loops are compiled for the type of the columns and the number of coefficients
        kinds.add((str(rows.sums.dtype), len(rows.sums._f)))
    assert kinds == {("float64", 6), ("float64", 7), ("complex128", 7)}


def test_the_kernels_of_orders_are_listed(monkeypatch):
    (C,) = compilation.order_curves().values()
    used = []
    monkeypatch.setattr(Products, "last", lambda work, *given: used.append(work.beta) or [1, 2])
    compilation.order(C)
    # so that a doubling occurs
    assert used == [1024, 1024]


def test_the_command(monkeypatch, capsys):
    C = compilation.single_curves()["GF(p), p < 2^63, genus 2, degree 5"]
    monkeypatch.setattr(compilation, "single_curves", lambda: {"one": C})
    monkeypatch.setattr(compilation, "two_word_curves", dict)
    monkeypatch.setattr(compilation, "batch_curves", dict)
    monkeypatch.setattr(compilation, "float_curves", dict)
    monkeypatch.setattr(compilation, "order_curves", dict)
    monkeypatch.setattr(compilation, "rational_curves", dict)
    assert main(["compile"]) == 0
    (line,) = capsys.readouterr().out.splitlines()
    assert line.endswith(" s  single: one")
    assert float(line.split()[0]) >= 0


def test_a_wrong_command_is_named(capsys):
    with pytest.raises(SystemExit):
        main(["compil"])
    assert "compil" in capsys.readouterr().err
