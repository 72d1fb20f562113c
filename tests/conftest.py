"""Fixtures of all tests."""

import numpy as np
import pytest


@pytest.fixture
def rng():
    """A seeded generator: the same numbers in every run."""
    return np.random.default_rng(20240229)
