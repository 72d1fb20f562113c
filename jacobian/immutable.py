"""Immutable values: the base class of fields, curves, groups, divisors, bodies, systems, steps, motions and results.

Curves that compare equal must stay equal, since divisors on equal curves are added. A cached value
(``functools.cached_property``) must stay valid for the numbers it was computed from.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable
from functools import cached_property, wraps
from typing import TYPE_CHECKING, Any, ClassVar, TypeVar

if TYPE_CHECKING:
    import numpy as np

Kind = TypeVar("Kind")
Array = TypeVar("Array", bound="np.ndarray")
Made = TypeVar("Made", bound=Callable[..., None])
Value = TypeVar("Value")

_MADE: dict[Hashable, Any] = {}


class Immutable:
    """Attributes can be set only while ``__init__`` runs (``_open`` is set meanwhile); afterwards AttributeError is
    raised.

    Cached results go into ``vars(self)``, where ``cached_property`` puts them; a class names its other caches in
    ``_caches`` and gives them a default. Comparison, hash and pickles leave caches out: values are equal when they have
    the same type and the same :meth:`_value`. A copy is the value itself. A class without ``__dict__`` sets its slots
    by their descriptors or by ``object.__setattr__``.
    """

    # the flag is a slot: a temporary entry of __dict__ would make later reads of attributes slower
    __slots__ = ("_open",)
    _caches: ClassVar[tuple[str, ...]] = ()

    def __init_subclass__(cls, **options: Any) -> None:
        super().__init_subclass__(**options)
        if "__init__" in vars(cls) and cls.__dictoffset__ and not hasattr(cls.__init__, "_at_once"):
            cls.__init__ = _opened(cls.__init__)  # type: ignore[method-assign]

    def __setattr__(self, name: str, value: Any) -> None:
        if not hasattr(self, "_open"):
            raise AttributeError(_refusal(self, name, "set"))
        object.__setattr__(self, name, value)

    def __delattr__(self, name: str) -> None:
        raise AttributeError(_refusal(self, name, "deleted"))

    def _value(self) -> tuple[object, ...]:
        """The data that distinguish this value from others of its type: by default all attributes except caches."""
        return tuple(_without_caches(self).items())

    def __eq__(self, other: object) -> bool:
        if self is other:
            return True
        if type(self) is not type(other):
            return NotImplemented
        return bool(self._value() == other._value())

    def __hash__(self) -> int:
        return hash((type(self).__name__, self._value()))

    def __getstate__(self) -> Any:
        return _without_caches(self)

    def __copy__(self: Kind) -> Kind:
        return self

    def __deepcopy__(self: Kind, memo: object) -> Kind:
        return self


def _refusal(value: Any, name: str, verb: str) -> str:
    return f"{type(value).__name__}.{name} cannot be {verb}: values are immutable, make a new one"


def _opened(initialize: Callable[..., None]) -> Any:
    @wraps(initialize)
    def __init__(self: Any, *args: Any, **options: Any) -> None:
        if hasattr(self, "_open"):
            # a subclass's __init__ has called this one; the wrapper of the subclass's __init__ deletes _open at its end
            return initialize(self, *args, **options)
        _set_open(self, True)
        try:
            initialize(self, *args, **options)
        finally:
            _close(self)

    return __init__


def at_once(initialize: Made) -> Made:
    """Marks an ``__init__`` that sets attributes by ``vars(self)``. :class:`Immutable` does not set ``_open`` for it,
    which would double its time.
    """
    initialize._at_once = True  # type: ignore[attr-defined]
    return initialize


_set_open = Immutable.__dict__["_open"].__set__
_close = Immutable.__dict__["_open"].__delete__


def _without_caches(value: Any) -> dict[str, Any]:
    kind = type(value)
    caches = getattr(kind, "_caches", ())
    return {
        name: x
        for name, x in vars(value).items()
        if name not in caches and not isinstance(getattr(kind, name, None), cached_property)
    }


def replaced(value: Kind, **changes: Any) -> Kind:
    """A copy of ``value`` with the attributes ``changes``, and without the results cached from the old attributes."""
    made: Kind = object.__new__(type(value))
    vars(made).update(_without_caches(value))
    vars(made).update((name, _sealed(x)) for name, x in changes.items())
    return made


def made_once(key: Hashable, make: Callable[[], Value]) -> Value:
    """The value stored under ``key`` in this process; the first call for this key computes it by ``make``."""
    found: Any = _MADE.get(key, _MADE)
    if found is _MADE:
        found = _MADE[key] = make()
    return found  # type: ignore[no-any-return]


def read_only(array: Array) -> Array:
    """A numpy array that cannot be written to: the array itself, or a view of it."""
    if not array.flags.writeable:
        return array
    view = array.view()
    view.setflags(write=False)
    return view


if TYPE_CHECKING:
    quick_property = cached_property
else:

    class quick_property(cached_property):
        """A ``cached_property`` without a lock: Python 3.11's lock takes longer than a short computation.

        Several threads may compute the value at the same time; their results are equal.
        """

        def __get__(self, instance: Any, owner: Any = None) -> Any:
            if instance is None:
                return self
            found = instance.__dict__[self.attrname] = self.func(instance)
            return found


class Record(Immutable):
    """A result that holds arrays: its arrays are read-only, and results compare by their contents."""

    def __setattr__(self, name: str, value: Any) -> None:
        super().__setattr__(name, _sealed(value))

    def __setstate__(self, state: dict[str, Any]) -> None:
        vars(self).update((name, _sealed(value)) for name, value in state.items())

    def _value(self) -> tuple[object, ...]:
        return tuple((name, _contents(value)) for name, value in _without_caches(self).items())


def _sealed(value: Any) -> Any:
    # numpy is not imported here: a single divisor does not need it
    return read_only(value) if hasattr(value, "flags") and hasattr(value, "view") else value


def _contents(value: Any) -> Any:
    return (value.shape, tuple(value.ravel().tolist())) if hasattr(value, "ravel") else value
