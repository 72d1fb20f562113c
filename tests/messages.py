"""What the tests of wrong arguments share."""

import re

import pytest


def assert_says(call, kind, begins, contains):
    """The call raises an error of this kind, whose message begins with what was wrong and says what would be right."""
    with pytest.raises(kind, match="^" + re.escape(begins)) as caught:
        call()
    assert contains in str(caught.value)
