"""The threads that batches run on, by the name that they have here: :mod:`jacobian.numbers.threads`."""

from jacobian.numbers.threads import in_ranges, set_threads, threads

__all__ = ["in_ranges", "set_threads", "threads"]
