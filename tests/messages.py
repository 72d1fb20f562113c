"""Helpers for the tests of wrong arguments."""

import re

import pytest


def assert_says(call, kind, begins, contains):
    """Asserts that the call raises an error of this kind whose message begins with the mistake and names what is
    accepted.
    """
    with pytest.raises(kind, match="^" + re.escape(begins)) as caught:
        call()
    assert contains in str(caught.value)


class Raising:
    """An object that raises its own error in every operation."""

    def __iter__(self):
        raise RuntimeError("no iteration")

    def __index__(self):
        raise RuntimeError("no index")

    def __repr__(self):
        return "<raising>"
