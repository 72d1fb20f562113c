"""The documented name of :mod:`integrable.oracles.reference`, which has the code of the reference solutions."""

from integrable.oracles.reference import *  # noqa: F403
from integrable.oracles.reference import __all__ as __all__
