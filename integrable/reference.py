"""The oracles under their documented name; the code is in :mod:`integrable.oracles.reference`."""

from integrable.oracles.reference import *  # noqa: F403
from integrable.oracles.reference import __all__ as __all__
