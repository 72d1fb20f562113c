"""The compiled versions of :mod:`jacobian.addition.genus2_words`, including its steps for all models, and of
:mod:`jacobian.addition.genus3_words`.

Importing this module imports numba.
"""

from __future__ import annotations

from typing import Any

from numba.extending import overload, register_jitable

from jacobian.addition import genus3_words
from jacobian.addition.genus2_words import PARTS, STEPS
from jacobian.numbers import tables_compiled, words_compiled  # noqa: F401  # the compiled operations of words and tables
from jacobian.numbers.words_compiled import INLINED


def _register(step: Any, of_models: dict[type, Any]) -> None:
    """Registers the compiled versions of a step, one for each model."""
    for function in set(of_models.values()):
        register_jitable(**INLINED)(function)

    def choose(K, C, *arguments):  # type: ignore[no-untyped-def]
        return of_models[C.instance_class]

    overload(step, jit_options=INLINED, strict=False)(choose)


for _function in (*PARTS, *genus3_words.STEPS):
    register_jitable(**INLINED)(_function)
for _step, _of_models in STEPS.items():
    _register(_step, _of_models)
