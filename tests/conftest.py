"""Fixtures of all tests."""

import gc
from collections import Counter

import numpy as np
import pytest
from hypothesis import settings

# on a busy machine one example may take any time
settings.register_profile("without deadline", settings(), deadline=None)
settings.load_profile("without deadline")


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_make_scheduler(config, log):
    """Keeps the tests of a file in one worker, so that set-up and compilation are done once; idle workers take files
    from busy ones.
    """
    if config.getvalue("dist") != "load":
        return None
    from xdist.scheduler import WorkStealingScheduling

    return WorkStealingScheduling(config, log)


@pytest.hookimpl(wrapper=True)
def pytest_collection(session):
    """The half million objects made by collection live to the end, so the garbage collector passes over them."""
    gc.disable()
    try:
        return (yield)
    finally:
        gc.enable()
        gc.freeze()


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items):
    """Of the variants of a test with the mark ``thinned(n)`` each n-th runs every day, the others are slow."""
    seen = Counter()
    for item in items:
        mark = item.get_closest_marker("thinned")
        if mark and not item.get_closest_marker("slow"):
            test = item.nodeid.split("[")[0]
            if seen[test] % mark.args[0]:
                item.add_marker("slow")
            seen[test] += 1


@pytest.fixture
def rng():
    """A seeded generator: the same numbers in every run."""
    return np.random.default_rng(20240229)
