"""A line of held-out states that share their tensions: first the free state, then the plane ever nearer."""

from collections.abc import Callable, Iterator, Sequence

import numpy as np

from fingerfem.discretisation.node_order import NodeOrder
from fingerfem.equilibrium.failures import LoadNotReached, NotConverged
from fingerfem.model import FingerModel
from fingerfem.snapshots.lines.setting import Arrays, Setting
from fingerfem.snapshots.neighbours import KnownSet
from fingerfem.snapshots.recorder import Recorder
from rom.dataset.description import Line

Start = Callable[[], None]


def needs(setting: Setting, task: str, line: Line) -> list[str]:
    """No task must be done before."""
    return []


def solve(setting: Setting, task: str, line: Line) -> Arrays:
    """The states of the line's points."""
    if setting.description.has_load:
        return _pressed(setting, line).arrays()
    points = _points(setting, line)
    solver = HeldOutSolver(setting.model, setting.numbering, setting.known.near)
    return solver.solve(points[0][0], [distance for _, distance in points]).arrays()


def _pressed(setting: Setting, line: Line) -> Recorder:
    """States with wrenches on the plates: from the line's free state, which is solved from rest."""
    record, continuation = setting.recorder(), setting.model.continuation
    free: np.ndarray | None = None
    for tensions, wrenches in _pressed_points(setting, line):
        record.restarted()
        if setting.begin_near(tensions, wrenches):
            pass
        elif free is not None:
            continuation.start(tensions, None, free)
        else:
            continuation.rest()
            try:
                continuation.advance(tensions, None)
                free = setting.model.problem.displacement.copy()
            except LoadNotReached as failure:
                record.broken(failure)
        record.state(tensions, None, 0, wrenches)
    return record


def give_up(setting: Setting, task: str, line: Line, reason: str) -> Arrays:
    """The same without an answer."""
    record = setting.recorder()
    if setting.description.has_load:
        for tensions, wrenches in _pressed_points(setting, line):
            record.failed(tensions, np.nan, reason, wrenches=wrenches)
        return record.arrays()
    for tensions, distance in _points(setting, line):
        record.failed(tensions, distance, reason)
    return record.arrays()


def _points(setting: Setting, line: Line) -> list[tuple[np.ndarray, float]]:
    """Tensions [N] and distance [m] of a line's points; nan without a plane."""
    description = setting.description
    points = np.array([description.random[k] for k in line.nodes])
    distances = points[:, -1] if description.has_obstacle else np.full(len(points), np.nan)
    return list(zip(points[:, : description.actuators], distances.tolist(), strict=True))


def _pressed_points(setting: Setting, line: Line) -> list[tuple[np.ndarray, np.ndarray]]:
    """Tensions [N] and wrenches on the plates, shape (plates, 6) [N, N m], of a line's points."""
    description = setting.description
    points = [np.array(description.random[k]) for k in line.nodes]
    return [(point[: description.actuators], point[description.actuators :].reshape(-1, 6)) for point in points]


def _stay() -> None:
    """Begin where the model is."""


class HeldOutSolver:
    """Solves held-out states from rest; or from known states near by, and from rest where these do not lead there."""

    def __init__(self, model: FingerModel, numbering: NodeOrder, near: KnownSet | None = None):
        self._model, self._numbering, self._near = model, numbering, near

    def solve(self, tensions: np.ndarray, distances: Sequence[float]) -> Recorder:
        """States at tensions [N], shape (tensions,), and distances of the plane [m], falling; nan without a plane."""
        model, record = self._model, Recorder(self._model, self._numbering)
        spent, failure = self._bring(self._free_starts(tensions), tensions, None)
        if failure is not None or model.scene.obstacle is None:
            for distance in distances:
                self._note(record, tensions, distance, spent, failure)
            return record
        record.touch()
        reach, free = model.problem.reach(), model.problem.displacement.copy()
        for distance in distances:
            starts = self._contact_starts(tensions, distance, reach, free)
            more, failure = self._bring(starts, tensions, distance)
            self._note(record, tensions, distance, spent + more, failure)
            spent = 0  # the first counts the path to the free state
        return record

    def _free_starts(self, tensions: np.ndarray) -> Iterator[Start]:
        near = self._near
        if near is not None:
            yield lambda: near.begin(self._model, self._numbering, tensions)
        yield self._model.continuation.rest

    def _contact_starts(self, tensions: np.ndarray, distance: float, reach: float, free: np.ndarray) -> Iterator[Start]:
        continuation, near = self._model.continuation, self._near
        if near is not None and distance < reach:
            yield lambda: near.begin(self._model, self._numbering, tensions, distance)
        elif continuation.distance is None or distance <= continuation.distance:
            yield _stay
        yield lambda: continuation.start(tensions, None, free)

    def _bring(
        self, starts: Iterator[Start], tensions: np.ndarray, distance: float | None
    ) -> tuple[int, LoadNotReached | None]:
        """Bring the model to a load from the first start that leads there.

        Returns:
            iterations of all that was tried, and why none leads there.
        """
        continuation, spent, failure = self._model.continuation, 0, None
        for start in starts:
            before = continuation.iterations if start is _stay else 0  # others begin to count anew
            try:
                start()
                continuation.advance(tensions, distance)
            except NotConverged as caught:  # of the nearest equilibrium: another start is left
                spent += caught.iterations
                continue
            except LoadNotReached as caught:
                failure = caught
            else:
                return spent + continuation.iterations - before, None
            spent += continuation.iterations - before
        return spent, failure

    def _note(
        self, record: Recorder, tensions: np.ndarray, distance: float, spent: int, failure: LoadNotReached | None
    ) -> None:
        """Note the state that the model was brought to, or why it was not."""
        if failure is None:
            record.state(
                tensions, None if np.isnan(distance) else distance, self._model.continuation.iterations - spent
            )
            return
        last = np.nan if failure.distance is None else failure.distance
        record.failed(tensions, distance, failure.reason, last_good=(failure.tensions, last))
