"""The compiled versions of :mod:`jacobian.addition.genus2_words`, and its steps under one name for both models.

Importing this module imports numba.
"""

from __future__ import annotations

from typing import Any

from numba.extending import overload, register_jitable

from jacobian.addition import genus2_words as formulas
from jacobian.numbers import tables_compiled, words_compiled  # noqa: F401  # the compiled operations of words and tables
from jacobian.numbers.words_compiled import INLINED


def tangent(K: Any, C: Any, first: Any) -> Any:
    """The tangent of the model of C, in compiled code; so are the four functions that follow."""
    raise NotImplementedError


def product(K: Any, C: Any, quotient: Any) -> Any:
    """What is to be inverted."""
    raise NotImplementedError


def cubic(K: Any, C: Any, quotient: Any, inverse: Any, first: Any) -> Any:
    """The cubic through both divisors."""
    raise NotImplementedError


def sum_u(K: Any, C: Any, cubic: Any, first: Any, second: Any) -> Any:
    """The u of the sum."""
    raise NotImplementedError


def sum_v(K: Any, C: Any, cubic: Any, u: Any, first: Any) -> Any:
    """The v of the sum."""
    raise NotImplementedError


def _register(step: Any, quintic: Any, sextic: Any) -> None:
    """The compiled versions of a step, one for each model."""
    compiled = {formulas.Quintic: quintic, formulas.Sextic: sextic}
    for function in compiled.values():
        register_jitable(**INLINED)(function)

    def choose(K, C, *arguments):  # type: ignore[no-untyped-def]
        return compiled[C.instance_class]

    overload(step, jit_options=INLINED, strict=False)(choose)


for _function in (formulas.chord, formulas.over_tangent):
    register_jitable(**INLINED)(_function)
_register(tangent, formulas.tangent_quintic, formulas.tangent_sextic)
_register(product, formulas.product_quintic, formulas.product_sextic)
_register(cubic, formulas.cubic_quintic, formulas.cubic_sextic)
_register(sum_u, formulas.sum_u_quintic, formulas.sum_u_sextic)
_register(sum_v, formulas.sum_v_quintic, formulas.sum_v_sextic)
