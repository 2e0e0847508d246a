"""The full-order finger, pressed by wrenches or by objects: the reference that assembled fingers are compared with.

A state in contact begins at the pressed state of the wrenches of the solved contact: what is left to solve is the
difference of the two. It converges to the solver's tolerance, or counts as failed.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

from rom.rod.objects.shapes import Cylinder, Hull, Plane, RigidObject, Sphere, box

Table = dict[str, Any]


def obstacle(found: RigidObject, sides: dict | None = None) -> Table:
    """An object as the table of a scene; of a box also what it was made from."""
    table: Table = {"method": "penalty", "distance": [1e-4, found.distances[1]]}
    table |= {"centre": list(found.centre), "direction": list(found.direction)}
    if isinstance(found, Hull):
        assert sides is not None, "of boxes alone"
        return table | {"shape": "box"} | sides
    if isinstance(found, Cylinder):
        return table | {"shape": "cylinder", "radius": found.radius, "axis": list(found.axis)}
    if isinstance(found, Sphere):
        return table | {"shape": "sphere", "radius": found.radius}
    assert isinstance(found, Plane)
    return table | {"shape": "plane", "normal": list(found.normal)}


def random_box(random: np.random.Generator, centre: tuple, where: Table) -> tuple[Hull, Table]:
    """A box turned at random, and its entries in a scene."""
    sides, rounding = random.uniform(0.008, 0.03, 3).tolist(), float(random.uniform(0.0005, 0.002))
    rotation = Rotation.random(random_state=random).as_rotvec().tolist()
    table = {"sides": sides, "rotation": rotation, "rounding": rounding}
    return box(centre=centre, sides=tuple(sides), rotation=tuple(rotation), rounding=rounding, **where), table


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

    def force(self, touched: Table, pulled: np.ndarray, d: float, wrenches: np.ndarray) -> tuple[float, bool] | None:
        """Contact force [N], and whether rubber touches; None without a converged state.

        Args:
            touched: a scene's obstacle.
            pulled: tensions [N].
            d: of the obstacle [m].
            wrenches: of the solved contact, on all plates, shape (6 plates,) [N, N m].
        """
        from fingerfem.equilibrium.failures import NotConverged

        begun = self.pressed(pulled, wrenches)
        if begun is None:
            return None
        model = self._before(touched)
        for strategy in ("plain", "line search"):
            model.continuation.start(pulled, d, begun.displacement)
            try:
                model.continuation.newton.solve(strategy)
                break
            except NotConverged:
                continue
        else:
            return None
        contact = model.problem.contact
        assert contact is not None
        return contact.force(), rubber_touches(model)

    def approached(self, touched: Table, pulled: np.ndarray, d: float) -> np.ndarray | None:
        """Contact forces of objects that come to d [m] from afar, shape (objects,) [N]; None if it did not converge."""
        from fingerfem.equilibrium.failures import LoadNotReached, NotConverged

        model = self._before(touched)
        try:
            model.continuation.rest()
            model.continuation.advance(pulled, None)
            model.continuation.advance(pulled, d)
        except (LoadNotReached, NotConverged):
            return None
        return np.asarray(model.problem.contact.forces())

    def force_and_tip(self, touched: Table, pulled: np.ndarray, d: float) -> tuple[float, np.ndarray]:
        """Contact force of an object that comes to d [m] from afar [N], and how it moves the tip, shape (3,) [m].

        Raises:
            LoadNotReached: no converged state there.
        """
        model = self._before(touched)
        model.continuation.rest()
        model.continuation.advance(pulled, None)
        free = np.array(model.problem.tip())
        model.continuation.advance(pulled, d)
        return float(model.problem.contact.force()), np.array(model.problem.tip()) - free

    def pulled_against(self, touched: Table, pulled: np.ndarray, d: float) -> np.ndarray | None:
        """The same of objects that stand at d [m] beside the straight finger, which is then pulled."""
        from fingerfem.equilibrium.failures import LoadNotReached

        model = self._before(touched)
        model.continuation.start(np.zeros(len(pulled)), d, np.zeros_like(model.problem.displacement))
        try:
            model.continuation.advance(pulled, d)
        except LoadNotReached:
            return None
        return np.asarray(model.problem.contact.forces())

    def _before(self, touched: Table) -> Any:
        """The finger before an obstacle, in place of its load."""
        table = {key: value for key, value in self._table.items() if key != "load"} | {"obstacle": touched}
        return self._model(self._scene.model_validate(table))


def rubber_touches(model: Any) -> bool:
    """Whether the obstacle presses on rubber in the present state of a `fingerfem.FingerModel`."""
    problem = model.problem
    x = problem.space.tabulate_dof_coordinates()[:, 0]
    pushed = np.linalg.norm(problem.contact.nodal_force(), axis=1)
    rubber = np.ones(len(x), bool)
    for first, last in problem.scene.outline.plates:
        rubber &= (x < first - 1e-6) | (x > last + 1e-6)
    return bool(pushed[rubber].sum() > 1e-6 * pushed.sum())
