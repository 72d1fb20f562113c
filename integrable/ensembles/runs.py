"""Many motions at given times: the base of the results of all ensembles."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Self

import numpy as np

from integrable.ensembles.members import Many, times_of_some
from integrable.files.frame import Column
from jacobian.errors import ArgumentError
from jacobian.immutable import read_only, replaced


class Runs(Many[Any]):
    """K motions of an ``ensemble`` at N times each.

    ``status``, shape (K,), is 0 for a member without refusals, else the number of a reason in ``reasons``. ``runs[k]``
    is one member; a slice or an array selects several members, :attr:`kept` all members with status 0.
    """

    ensemble: Any
    status: np.ndarray
    reasons: tuple[str, ...]
    _times: np.ndarray

    def __len__(self) -> int:
        return len(self.status)

    def _told(self, motions: str) -> str:
        refused = np.count_nonzero(self.status)
        said = f", {refused} of them refused" if refused else ""
        return f"<{type(self).__name__} of {len(self)} {motions} at {self._times.shape[1]} times{said}>"

    def _repr_html_(self) -> str:
        from jacobian.notebook import table

        rows = [(k, self.reasons[n] or "had") for k, n in enumerate(self.status.tolist())]
        return table(repr(self), ["member", "status"], rows)

    @property
    def times(self) -> np.ndarray:
        """Physical times, shape (N,), or (K, N) where every member has its own."""
        return self._times if len(self._times) > 1 else read_only(self._times[0])

    @property
    def kept(self) -> Self:
        """The runs of the members with status 0."""
        return self._some(np.flatnonzero(self.status == 0))

    def _dimensions(self) -> tuple[tuple[str, str], dict[str, Column]]:
        """The dimensions of a frame, "member" and "time" (or "row" where every member has its own times), and the
        coordinates.
        """
        own = len(self._times) > 1
        dims = ("member", "row" if own else "time")
        time = Column(dims if own else dims[1:], self.times, "s", "physical time t")
        return dims, {"member": Column(dims[:1], np.arange(len(self)), "1", "number of the member"), "time": time}

    def _one(self, member: int) -> Any:
        """The motion of a member at its times, with its cached results."""
        raise NotImplementedError

    def _of_some(self, places: np.ndarray) -> dict[str, Any]:
        """The subclass's attributes, by name, restricted to the members ``places``."""
        raise NotImplementedError

    def _refusal(self, member: int) -> ArgumentError:
        return ArgumentError(f"member {member} was refused: {self.reasons[self.status[member]]}")

    def _some(self, places: np.ndarray) -> Self:
        parts = {"_times": times_of_some(self._times, places), "status": self.status[places], **self._of_some(places)}
        return replaced(self, ensemble=self.ensemble[places], **parts)


def joined_times(every: Sequence[Runs]) -> np.ndarray:
    """The times of all joined members: shape (1, N) where all have the same times, else (K, N)."""
    times = every[0]._times
    if len(times) == 1 and all(np.array_equal(runs._times, times) for runs in every):
        return times
    return np.concatenate([np.broadcast_to(runs._times, (len(runs), times.shape[1])) for runs in every])
