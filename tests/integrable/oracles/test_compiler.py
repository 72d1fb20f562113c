"""numba's cache: compiled code that cannot be kept on disk."""

import json
import subprocess
import sys

# numba tries each folder it may use: none of these is writable
NOWHERE = """
from numba.core import caching
def refused(self):
    raise PermissionError(13, "Permission denied")
caching._CacheLocator.ensure_cache_path = refused
"""
SMALL = """
import warnings
from integrable.oracles.compiler import njit
def twice(x):
    return 2 * x
def thrice(x):
    return 3 * x
with warnings.catch_warnings(record=True) as said:
    warnings.simplefilter("always")
    values = [njit(nogil=True)(f)(7) for f in (twice, thrice)]
import json
print(json.dumps([values, [(type(w.message).__name__, str(w.message)) for w in said]]))
"""


def test_without_a_place_for_compiled_code_it_is_said_once():
    done = subprocess.run(
        [sys.executable, "-W", "error", "-c", NOWHERE + SMALL], capture_output=True, text=True, timeout=300, check=False
    )
    assert done.returncode == 0, done.stderr
    values, said = json.loads(done.stdout)
    assert values == [14, 21]
    (name, message), *more = said
    assert not more
    assert name == "NoCacheWarning"
    assert "NUMBA_CACHE_DIR" in message
