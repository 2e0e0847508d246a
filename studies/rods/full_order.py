"""The full-order finger under wrenches, or with objects that press on it: the reference of assembled fingers."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from rom.rod.objects.shapes import Cylinder, Plane, RigidObject, Sphere, box

Table = dict[str, Any]
MADE = {"plane": Plane, "sphere": Sphere, "cylinder": Cylinder, "box": box}
NOT_OF_A_SHAPE = "shape", "distance", "method"


class Pressed(NamedTuple):
    """Tensions [N], obstacles of a scene, all at d [m], and the path of the full-order model.

    "approach": objects come from afar. "pull": the finger is pulled against standing objects. "wrenches": the solve
    begins at the state under the rod's contact wrenches.
    """

    tensions: np.ndarray
    objects: list[Table]
    d: float
    path: str = "approach"


def rigid(table: Table) -> RigidObject:
    """An obstacle of a scene as an object of the assembled finger."""
    given = {name: value for name, value in table.items() if name not in NOT_OF_A_SHAPE}
    return MADE[table["shape"]](**given, distances=tuple(table["distance"]))  # type: ignore[operator]


def together(tables: list[Table]) -> Table:
    """Obstacles as one of a scene."""
    others = [{name: value for name, value in one.items() if name not in ("method", "distance")} for one in tables[1:]]
    return tables[0] | ({"others": others} if others else {})


class FullOrder:
    """A finger of a scene with a load, given as plain data."""

    def __init__(self, table: Table):
        from fingerfem import FingerModel
        from fingerfem.scene.scene import Scene

        self._table, self._model, self._scene = table, FingerModel, Scene
        self._pressed = FingerModel(Scene.model_validate(table))

    def pressed(self, pulled: np.ndarray, wrenches: np.ndarray) -> Any | None:
        """The state at tensions [N] and wrenches on the plates, shape (6 plates,) [N, N m]; None if none converged."""
        from fingerfem.equilibrium.failures import LoadNotReached

        try:
            return self._pressed.solve(pulled, wrenches=wrenches.reshape(-1, 6), sensitivities=False)
        except LoadNotReached:
            return None

    def contact_forces(self, one: Pressed, wrenches: np.ndarray) -> np.ndarray | None:
        """Contact forces of all objects, shape (objects,) [N]; None if the full-order model did not converge."""
        from fingerfem.equilibrium.failures import LoadNotReached, NotConverged

        table = {key: value for key, value in self._table.items() if key != "load"}
        model = self._model(self._scene.model_validate(table | {"obstacle": together(one.objects)}))
        continuation = model.continuation
        try:
            if one.path == "wrenches":
                begun = self._pressed.solve(one.tensions, wrenches=wrenches.reshape(-1, 6), sensitivities=False)
                continuation.start(one.tensions, one.d, begun.displacement)
                continuation.newton.solve("line search")
            elif one.path == "pull":
                continuation.start(0 * one.tensions, one.d, np.zeros_like(model.problem.displacement))
                continuation.advance(one.tensions, one.d)
            else:
                continuation.rest()
                continuation.advance(one.tensions, None)
                continuation.advance(one.tensions, one.d)
        except (LoadNotReached, NotConverged):
            return None
        assert model.problem.contact is not None
        return np.asarray(model.problem.contact.forces())
