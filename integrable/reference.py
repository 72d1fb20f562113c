"""The oracles by the name they are documented under: :mod:`integrable.oracles.reference`."""

from integrable.oracles.reference import *  # noqa: F403
from integrable.oracles.reference import __all__ as __all__
