"""Held-out states that share their tensions: first the free state, then the plane ever nearer."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence

import numpy as np

from fingerfem.convergence import LoadNotReached
from fingerfem.model import FingerModel
from fingerfem.neighbours import Neighbour, Neighbours
from fingerfem.numbering import Numbering
from fingerfem.record import Record

Start = Callable[[], None]


class HeldOutSolver:
    """Solves held-out states from rest; or from known states near by, and from rest where these do not lead there."""

    def __init__(self, model: FingerModel, numbering: Numbering, neighbours: Neighbours | None = None):
        self._model, self._numbering, self._neighbours = model, numbering, neighbours

    def solve(self, tensions: np.ndarray, distances: Sequence[float]) -> Record:
        """States at tensions [N], shape (tensions,), and distances of the plane [m], falling; nan without a plane."""
        model, record = self._model, Record(self._model, self._numbering)
        spent, failure = self._bring(self._free_starts(tensions), tensions, None)
        if failure is not None or model.scene.obstacle is None:
            for distance in distances:
                self._note(record, tensions, distance, spent, failure)
            return record
        record.touch()
        reach, free = model.reach(), model.displacement.copy()
        for distance in distances:
            starts = self._contact_starts(tensions, distance, reach, free)
            more, failure = self._bring(starts, tensions, distance)
            self._note(record, tensions, distance, spent + more, failure)
            spent = 0  # the first counts the way to the free state
        return record

    def _free_starts(self, tensions: np.ndarray) -> Iterator[Start]:
        near = self._neighbours
        if near is not None:
            yield lambda: self._begin(near.free(tensions))
        yield self._model.stepper.rest

    def _contact_starts(self, tensions: np.ndarray, distance: float, reach: float, free: np.ndarray) -> Iterator[Start]:
        stepper, near = self._model.stepper, self._neighbours
        if near is not None and distance < reach:
            yield lambda: self._begin(near.contact(tensions, distance))
        elif stepper.distance is None or distance <= stepper.distance:
            yield lambda: None  # from where it is
        yield lambda: stepper.start(tensions, None, free)

    def _begin(self, known: Neighbour) -> None:
        self._model.stepper.start(known.tensions, known.distance, self._numbering.scatter(known.displacement))

    def _bring(
        self, starts: Iterator[Start], tensions: np.ndarray, distance: float | None
    ) -> tuple[int, LoadNotReached | None]:
        """Bring the model to a load from the first start that leads there.

        Returns:
            iterations of all that was tried, and why none leads there.
        """
        stepper, spent, failure = self._model.stepper, 0, None
        for start in starts:
            start()
            before = stepper.iterations
            try:
                stepper.advance(tensions, distance)
            except LoadNotReached as caught:
                failure = caught
            else:
                return spent + stepper.iterations - before, None
            spent += stepper.iterations - before
        return spent, failure

    def _note(
        self, record: Record, tensions: np.ndarray, distance: float, spent: int, failure: LoadNotReached | None
    ) -> None:
        """Note the state that the model was brought to, or why it was not."""
        if failure is None:
            record.state(tensions, None if np.isnan(distance) else distance, self._model.stepper.iterations - spent)
            return
        last = np.nan if failure.distance is None else failure.distance
        record.failed(tensions, distance, failure.reason, last_good=(failure.tensions, last))
