"""Records of a line's states, and the reasons of those that have no answer."""

import logging
from collections.abc import Callable
from typing import Any

import numpy as np

from fingerfem.discretisation.node_order import NodeOrder
from fingerfem.equilibrium.continuation import Continuation
from fingerfem.equilibrium.failures import LoadNotReached, NotConverged
from fingerfem.equilibrium.sensitivities import Sensitivities, differentiate
from fingerfem.equilibrium.state import channel_shortening, pad_pressure, stretches
from fingerfem.mechanics.rigid_plate import Pose
from fingerfem.model import FingerModel
from fingerfem.snapshots.design import body as finger_at_rest
from fingerfem.snapshots.design import cross_sections
from fingerfem.snapshots.strokes import Strokes
from rom.dataset import schema

logger = logging.getLogger(__name__)


class Recorder:
    """Collects the states of one line; after a load that was not reached the line's further states are failed too.

    Attributes:
        displacements: of this rank's nodes, state by state, as the model has them.
    """

    def __init__(self, model: FingerModel, numbering: NodeOrder):
        scene, body = model.scene, finger_at_rest(model.scene, numbering.nodes)
        self._model, self._numbering, self._broken = model, numbering, ""
        self._store, self._parameter_count = scene.sampling.store, len(scene.parameters)
        scopes = {"state", *self._store}
        scopes |= {name for name in ("obstacle", "load") if getattr(scene, name) is not None}
        self._sections = self._strokes = None
        if scene.load is not None:
            self._sections = cross_sections(scene, numbering.nodes)
            if all(tendon.path == "channel" for tendon in scene.tendons):
                scopes.add("load in channels")
                self._strokes = Strokes(model, self._sections, numbering)
        sizes = schema.sizes(
            segments=len(body.plates),
            sections=len(body.sections),
            tendons=len(scene.tendons),
            actuators=len(scene.actuators),
            nodes=len(body.nodes),
        )
        self._blank = schema.blanks(scopes, sizes, self._parameter_count)
        self._last_good: np.ndarray | None = None
        self._touch: dict[str, Any] = {}
        self._rows: list[dict[str, Any]] = []
        self.displacements: list[np.ndarray] = []

    def state(
        self,
        tensions: np.ndarray,
        distance: float | None,
        iterations_before: int | None = None,
        wrenches: np.ndarray | None = None,
    ) -> None:
        """Solve and note one state.

        The touch distance of a state in contact is that of the last free state. A pressed one need not be stable:
        whether it is depends on what presses.

        Args:
            tensions: shape (tensions,) [N].
            distance: of the plane [m]; None without one.
            iterations_before: from where its iterations are counted; from now if None.
            wrenches: on the plates, shape (plates, 6) [N, N m]; None without any.
        """
        model = self._model
        d = np.nan if distance is None else distance
        parameters = self._parameters(tensions, d, wrenches)
        if distance is not None and np.isnan(distance):  # of a plane that stands where the free finger has no answer
            self._broken = self._broken or self._rows[-1]["reason"]
        if self._broken:
            self._note_failure(parameters, self._broken, self._last_good)
            return
        before = model.continuation.iterations if iterations_before is None else iterations_before
        try:
            model.continuation.advance(tensions, distance, wrenches)
        except LoadNotReached as failure:
            self.broken(failure)
            self._note_failure(parameters, failure.reason, self._last_good)
            return
        sensitivities = _sensitivities(model.continuation, must_be_stable=wrenches is None)
        if sensitivities is None:
            self._note_failure(parameters, "the equilibrium is not stable")
        elif model.passes_through_itself():
            self._note_failure(parameters, "the finger passes through itself")
        else:
            self.displacements.append(model.problem.displacement.copy())
            solved = self._solved(sensitivities)
            if stretches(model.problem).get("beyond_data"):
                logger.warning("the state at %s is beyond the data of its law: material.stretches", parameters.tolist())
            self._rows.append(
                solved
                | {
                    "parameters": parameters,
                    "iterations": model.continuation.iterations - before,
                    "converged": True,
                    "reason": "",
                    "last_good": np.full_like(parameters, np.nan),
                }
            )

    def take(self, row: dict[str, Any], displacement: np.ndarray | None) -> None:
        """Note a state that another set has solved.

        Its displacement, shape (values,) [m], is of this rank's nodes, if known.
        """
        blank = np.full_like(self._model.problem.displacement, np.nan)
        self.displacements.append(blank if displacement is None else displacement)
        if "touch_distance" in row:
            self._touch = {name: row[name] for name in ("touch_distance", "touch_distance_jacobian")}
        self._rows.append(row)

    def restarted(self) -> None:
        """Forgets where the line broke, as the model has been brought to an equilibrium."""
        self._broken = ""

    def broken(self, failure: LoadNotReached) -> None:
        """All further states of the line have no answer either."""
        self._broken = failure.reason
        self._last_good = self._parameters(failure.tensions, np.nan if failure.distance is None else failure.distance)

    def touch(self) -> None:
        """Note where the plane would be touched: the model is in a free state."""
        model = self._model
        slopes = differentiate(model.problem, model.continuation.linearise()).touch_distance
        assert slopes is not None
        self._touch = {
            "touch_distance": model.problem.reach(),
            "touch_distance_jacobian": self._padded(slopes),
        }

    def _solved(self, found: Sensitivities) -> dict[str, Any]:
        """Record of the model's present state; fields on the model's first rank only."""
        model, numbering, store = self._model, self._numbering, self._store
        field = numbering.gather(model.problem.displacement)
        row: dict[str, Any] = {"tip": model.problem.tip(), "tip_jacobian": self._padded(found.tip).T}
        if model.problem.contact is not None:
            if found.touch_distance is not None:
                slopes = self._padded(found.touch_distance)
                self._touch = {"touch_distance": model.problem.reach(), "touch_distance_jacobian": slopes}
            row |= self._touch
            row["contact_force"] = model.problem.contact.force()
            pressed = found.contact_force if found.contact_force is not None else np.zeros(0)
            row["contact_force_jacobian"] = self._padded(pressed)
        if model.problem.plates is not None and found.plate_motion is not None:
            row |= _plate_poses(model.problem.plates.poses(model.problem.displacement), found.plate_motion)
        if "pad_pressure" in store:
            row["pad_pressure"] = pad_pressure(model.problem)
            row["pad_pressure_jacobian"] = self._padded(
                found.pad_pressure if found.pad_pressure is not None else np.zeros(0)
            )
        if "channel_shortening" in store:
            row["channel_shortening"] = channel_shortening(model.problem)
            row["channel_shortening_jacobian"] = self._padded(found.channel_shortening).T
        if "displacement" in store or self._sections is not None:
            changes = [numbering.gather(change) for change in found.displacement]
        if "displacement" in store:
            row |= {"displacement": field, "displacement_jacobian": self._padded(np.array(changes)).astype(np.float32)}
        sections = {}
        if self._sections is not None and model.problem.comm.rank == 0:
            sections = self._sections.quantities(field, np.array(changes))
        if self._strokes is not None:
            row |= self._strokes.quantities(found.displacement, sections)
        return row | sections

    def _padded(self, slopes: np.ndarray) -> np.ndarray:
        """Derivatives by all parameters, first axis; by d they are zero while there is no plane."""
        count = self._parameter_count - len(slopes)
        return np.concatenate([slopes, np.zeros((count, *slopes.shape[1:]))])

    def failed(
        self,
        tensions: np.ndarray,
        distance: float,
        reason: str,
        last_good: tuple[np.ndarray, float] | None = None,
        wrenches: np.ndarray | None = None,
    ) -> None:
        """Note a state at tensions, shape (tensions,) [N], without an answer, and the last load with an equilibrium."""
        last = None if last_good is None else self._parameters(*last_good)
        self._note_failure(self._parameters(tensions, distance, wrenches), reason, last)

    def _note_failure(self, parameters: np.ndarray, reason: str, last_good: np.ndarray | None = None) -> None:
        logger.warning("no state at %s: %s", parameters.tolist(), reason)
        self._rows.append(_unsolved(parameters, reason, last_good))
        self.displacements.append(np.full_like(self._model.problem.displacement, np.nan))

    def _parameters(self, tensions: np.ndarray, distance: float, wrenches: np.ndarray | None = None) -> np.ndarray:
        """Parameters in the scene's order."""
        if self._model.scene.load is not None:
            pressed = np.zeros_like(self._model.problem.wrenches) if wrenches is None else wrenches
            return np.concatenate([tensions, np.ravel(pressed)])
        return np.append(tensions, distance) if self._model.scene.obstacle is not None else np.array(tensions)

    def arrays(self) -> dict[str, np.ndarray]:
        """The states collected, quantity by quantity, nan where there is no answer; on the model's first rank."""
        if self._model.problem.comm.rank:
            return {}
        nothing = self._blank | _unsolved(np.full(self._parameter_count, np.nan), "")
        if not self._rows:
            return {name: np.array([value])[:0] for name, value in nothing.items()}
        return {name: np.array([(self._blank | row)[name] for row in self._rows]) for name in nothing}


def _unsolved(parameters: np.ndarray, reason: str, last_good: np.ndarray | None = None) -> dict[str, Any]:
    """A state without an answer."""
    last = np.full_like(parameters, np.nan) if last_good is None else last_good
    return {"parameters": parameters, "iterations": 0, "converged": False, "reason": reason, "last_good": last}


def _sensitivities(continuation: Continuation, *, must_be_stable: bool) -> Sensitivities | None:
    """The sensitivities at an equilibrium; none where the tangent is singular, or it is not as stable as it must be."""
    try:
        linearisation = continuation.linearise()
    except NotConverged:
        return None
    sensitivities = differentiate(continuation.problem, linearisation)
    return sensitivities if linearisation.stable or not must_be_stable else None


def _plate_poses(poses: list[Pose], motion: np.ndarray) -> dict[str, np.ndarray]:
    """The clamp's place and the rotation seen from the plates, with their derivatives by all parameters.

    Motion R^T dc and R^T dtheta by these, shape (p, plates, 6) [m, rad].
    """
    both = [(at, motion[:, k]) for k, at in enumerate(poses)]
    return {
        "clamp_place": np.array([at.clamp for at in poses]),
        "plate_rotation": np.array([at.quaternion for at in poses]),
        "clamp_place_jacobian": np.array([_columns(at.clamp_change, by) for at, by in both]),
        "plate_rotation_jacobian": np.array([_columns(at.quaternion_change, by) for at, by in both]),
    }


def _columns(change: Callable[[np.ndarray], np.ndarray], motions: np.ndarray) -> np.ndarray:
    """Changes with motions, shape (p, 6), by columns."""
    return np.array([change(motion) for motion in motions]).T
