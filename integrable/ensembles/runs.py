"""Many motions at given times: the base class of the results of all ensembles."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar, Self

import numpy as np

from integrable.ensembles.computing import Outcome, statuses
from integrable.ensembles.members import Many, times_of_some
from integrable.files.exported import Exported
from integrable.files.frame import Column, Frame
from integrable.files.quantities import reasons_text, status_column
from integrable.motion.refusals import common_reasons
from jacobian.errors import ArgumentError, shown
from jacobian.immutable import read_only, replaced


class Runs(Many[Any], Exported):
    """K motions of an ``ensemble`` at N times each.

    ``status``, shape (K,), is 0 for a member all of whose states were computed, otherwise n > 0 with the reason
    ``reasons[n]``. The numbers in refused rows are NaN; :meth:`row_status` gives the status of each row. ``runs[k]``
    is one member; a slice or an array selects several members, :attr:`kept` all members with status 0.
    """

    _arrays: ClassVar[tuple[str, ...]] = ("_rows", "status", "_ways")
    _shared: ClassVar[tuple[str, ...]] = ("system",)
    """The attributes of the ensemble that joined runs have in common."""

    def __init__(self, ensemble: Any, times: np.ndarray, rows: np.ndarray, outcome: Outcome) -> None:
        self.ensemble, self._times, self._rows = ensemble, times, rows
        self.status, self.reasons, self._partial = outcome.status, outcome.reasons, outcome.partial
        self._ways, self._words = outcome.ways, outcome.words

    def __repr__(self) -> str:
        refused = np.count_nonzero(self.status)
        said = f", {refused} of them refused" if refused else ""
        return f"<{type(self).__name__} of {len(self)} {self._motions} at {self._times.shape[1]} times{said}>"

    @property
    def _motions(self) -> str:
        return f"motions of {type(self.ensemble.system).__name__}"

    def _repr_html_(self) -> str:
        from jacobian.notebook import table

        rows = [(k, self.reasons[n] or "had") for k, n in enumerate(self.status.tolist())]
        return table(repr(self), ["member", "status"], rows)

    @property
    def times(self) -> np.ndarray:
        """Physical times, shape (N,), or (K, N) where every member has its own."""
        return self._times if len(self._times) > 1 else read_only(self._times[0])

    @property
    def ways(self) -> list[str]:
        """The name of the method that computed each member; "" for a member refused as a whole."""
        return [self._words[way] if way >= 0 else "" for way in self._ways.tolist()]

    @property
    def kept(self) -> Self:
        """The runs of the members with status 0."""
        return self._some(np.flatnonzero(self.status == 0))

    def row_status(self, member: int) -> np.ndarray:
        """0, or the number of the reason, for every row of a member: shape (N,)."""
        member = self._number(member)
        if member in self._partial:
            return read_only(self._partial[member])
        return read_only(np.full(self._rows.shape[1], self.status[member]))

    def concatenated(self, *others: Self) -> Self:
        """These members, then the members of ``others``, which have the same system and the same number of times."""
        for other in others:
            alike = type(other) is type(self) and other._rows.shape[1] == self._rows.shape[1]
            if not alike or other._in_common != self._in_common:
                wanted = f"{type(self).__name__} of the same {self._shared[0]} and number of times are needed"
                raise ArgumentError(f"others: {shown(other)} given; {wanted}")
        return self._joined(others)

    @property
    def _in_common(self) -> list[Any]:
        return [getattr(self.ensemble, name) for name in self._shared]

    def _joined(self, others: Any) -> Self:
        every, times = (self, *others), self._times
        numbers, reasons = common_reasons([runs.reasons for runs in every])
        partial, begin = {}, 0
        for mine, runs in zip(numbers, every, strict=True):
            partial.update({begin + k: mine[rows] for k, rows in runs._partial.items()})
            begin += len(runs)
        if len(times) > 1 or not all(np.array_equal(runs._times, times) for runs in others):
            times = np.concatenate([np.broadcast_to(runs._times, (len(runs), times.shape[1])) for runs in every])
        status = np.concatenate([mine[runs.status] for mine, runs in zip(numbers, every, strict=True)])
        ensemble = self.ensemble._joined(runs.ensemble for runs in others)
        return replaced(
            super()._joined(others), ensemble=ensemble, _times=times, status=status, reasons=reasons, _partial=partial
        )

    def _some(self, places: np.ndarray) -> Self:
        partial = {i: self._partial[k] for i, k in enumerate(places.tolist()) if k in self._partial}
        times = times_of_some(self._times, places)
        return replaced(super()._some(places), ensemble=self.ensemble[places], _times=times, _partial=partial)

    def _refusal(self, member: int) -> ArgumentError:
        return ArgumentError(f"member {member} was refused: {self.reasons[self.status[member]]}")

    def _frame_of(self, states: Mapping[str, Column], about: Mapping[str, Any]) -> Frame:
        """A frame along "member" and "time", or "row" where every member has its own times."""
        dims, own = self._dims, len(self._times) > 1
        time = Column(dims if own else dims[1:], self.times, "s", "physical time t")
        rows = statuses(self.status, self._partial, self._rows.shape[1])
        words = ("refused", *self._words)
        way = Column(dims[:1], (self._ways + 1).astype(np.int32), "1", "what has computed the member", (), words)
        variables = {**states, "status": status_column(dims, rows, self.reasons), "way": way}
        member = Column(dims[:1], np.arange(len(self)), "1", "number of the member")
        return Frame(
            dims, {"member": member, "time": time}, variables, {**about, "reasons": reasons_text(self.reasons)}
        )

    @property
    def _dims(self) -> tuple[str, str]:
        return "member", "row" if len(self._times) > 1 else "time"

    def _value(self) -> tuple[object, ...]:
        # NaN, which is unequal to itself, is replaced in refused rows, so that equal results compare as equal
        rows = tuple(np.nan_to_num(self._rows).ravel().tolist())
        return self.ensemble, self._times.shape, tuple(self._times.ravel().tolist()), rows, tuple(self.status.tolist())
