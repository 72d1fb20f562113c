"""What the tests of wrong arguments share."""

import re

import pytest


def assert_says(call, kind, begins, contains):
    """The call raises an error of this kind, whose message begins with what was wrong and says what would be right."""
    with pytest.raises(kind, match="^" + re.escape(begins)) as caught:
        call()
    assert contains in str(caught.value)


class Raising:
    """What raises an error of its own wherever it is asked."""

    def __iter__(self):
        raise RuntimeError("no iteration")

    def __index__(self):
        raise RuntimeError("no index")

    def __repr__(self):
        return "<raising>"
