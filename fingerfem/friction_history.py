"""A finger before an obstacle with friction, along a history of tensions and of the obstacle's positions.

An increment ends where Newton's method has converged for bounds mu N that are those of its own normal forces N: a fixed
point (`mechanics.friction`). An increment that finds none is halved. Stick and slip depend on the history, so that
an error of first order in the size of the increments is left.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from fingerfem.discretisation.forms import surface_area, surface_measure
from fingerfem.discretisation.friction_points import FrictionPoints
from fingerfem.discretisation.obstacle_contact import ObstacleContact
from fingerfem.equilibrium.failures import LoadNotReached, NotConverged
from fingerfem.model import FingerModel

ITERATIONS = 60  # towards the fixed point of one increment
SETTLED, LEAST = 1e-7, 1e-6  # change of the bounds over their sum [-], or over this [N], that ends them
RELAXED = 0.1, 3.0  # least and largest share of a step towards it [-]
HALVINGS = 6  # of an increment that finds no equilibrium


@dataclass(frozen=True, kw_only=True)
class FrictionState:
    """A state of a history with friction.

    Attributes:
        tip: displacement of the tip plate's centre, shape (3,) [m].
        force: of the obstacle on the finger, shape (3,) [N].
        normal_force: sum of the nodes' forces along the obstacle's normals there [N].
        nodal: by every node that may touch: normal force, and size of the tangential one, shape (m, 2) [N].
        sticks: share of the normal force at nodes that stick [-]; nan without contact.
        dissipated: by sliding, from the history's beginning [J].
        iterations: Newton iterations of the increments since the last point.
    """

    tip: np.ndarray
    force: np.ndarray
    normal_force: float
    nodal: np.ndarray
    sticks: float
    dissipated: float
    iterations: int


def friction_history(
    model: FingerModel, points: ArrayLike, coefficient: float, moved: ArrayLike | None = None, increments: int = 8
) -> list[FrictionState]:
    """States along a history, from point to point in straight lines, of plates and rubber before an obstacle.

    A first point in contact is reached by the obstacle coming along its direction, with the tensions as they are there.
    Where that is oblique to the surface, d drags a round obstacle along.

    Args:
        model: a finger whose scene has one obstacle, with the penalty method.
        points: tensions [N] and d [m], shape (n, t + 1).
        coefficient: of friction [-].
        moved: of a plane besides, shape (n, 3) [m]; not at all if left out.
        increments: from point to point; one that finds no equilibrium is halved.

    Raises:
        ValueError: several obstacles, another method, a round one that is moved, wrong shapes, loads beyond the
            scene's ranges, a coefficient below 0, no increment.
        LoadNotReached: an increment without an equilibrium.

    Example:
        >>> friction_history(model, [[20.0, 0.0, 0.01]] * 2, 0.5, moved=[[0, 0, 0], [0.001, 0, 0]])[-1].force
    """
    return list(
        _History(model, coefficient).states(*_checked(model, points, moved, coefficient, increments), increments)
    )


def _checked(
    model: FingerModel, points: ArrayLike, moved: ArrayLike | None, coefficient: float, increments: int
) -> tuple[np.ndarray, np.ndarray]:
    """Points and motions of the plane, as arrays."""
    obstacle = model.scene.obstacle
    bodies = model.problem.bodies
    if obstacle is None or len(bodies) > 1 or obstacle.method != "penalty":
        raise ValueError("obstacle must be a single body with the penalty method for a history with friction")
    rows = np.atleast_2d(np.asarray(points, float))
    ways = np.zeros((len(rows), 3)) if moved is None else np.atleast_2d(np.asarray(moved, float))
    if rows.shape[1:] != (len(model.scene.parameters),) or ways.shape != (len(rows), 3):
        raise ValueError(
            f"points must be tensions and d, shape (n, {len(model.scene.parameters)}), and moved of shape "
            f"(n, 3), got {rows.shape} and {ways.shape}"
        )
    if ways.any() and not bodies[0].is_flat:
        raise ValueError("moved must be 0 for a round obstacle, which moves by d alone")
    if not (np.isfinite(rows).all() and np.isfinite(ways).all() and 0 <= coefficient < np.inf and increments >= 1):
        raise ValueError("points, moved and coefficient must be finite, coefficient at least 0, increments at least 1")
    for row in rows:
        model.check_loads(row[:-1], float(row[-1]))
    return rows, ways


class _History:
    """A model that is led along a history."""

    def __init__(self, model: FingerModel, coefficient: float):
        problem = model.problem
        assert problem.contact is not None
        self._model, self._problem, self._mu = model, problem, coefficient
        self._contact: ObstacleContact = problem.contact
        self._body = problem.bodies[0]
        self._direction = np.array(self._body.direction)
        nodes = problem.surface_nodes
        own = nodes[nodes < problem.space.dofmap.index_map.size_local]
        self._points = FrictionPoints(problem.space.tabulate_dof_coordinates(), own, self._normals)
        area = problem.nodal(surface_area(surface_measure(problem.scene, problem.mesh), problem.space))[own, 0]
        self._stiffness = float(problem.fields.stiffness.value) * area  # [N/m]
        self._found, self._bounds = self._points.at(problem.displacement), np.zeros(len(own))
        self.iterations, self.dissipated = 0, 0.0

    def states(self, rows: np.ndarray, ways: np.ndarray, increments: int) -> Iterator[FrictionState]:
        """The state at every point."""
        t, continuation = rows.shape[1] - 1, self._model.continuation
        continuation.rest()
        continuation.advance(rows[0, :t], None)
        touch = self._problem.reach() - self._along(ways[0])
        begun = np.concatenate([rows[0, :t], [max(touch, rows[0, t])], ways[0]])
        self._points.anchors = self._points.places(self._problem.displacement)
        self._contact.friction = self._points
        try:
            for row, way in zip(rows, ways, strict=True):
                goal, start = np.concatenate([row, way]), begun
                self.iterations = 0
                for k in range(increments):
                    ahead = start + (k + 1) / increments * (goal - start)
                    self._reach(begun, ahead, HALVINGS)
                    begun = ahead
                yield self._state()
        finally:
            self._contact.friction = None

    def _along(self, way: np.ndarray) -> float:
        """How far d would move the plane as a motion along its normal does; 0 for a round obstacle [m]."""
        if not self._body.is_flat:
            return 0.0
        (normal,) = self._body.normal_at(np.zeros((1, 3)), np.zeros(1))
        return float(way @ normal / (self._direction @ normal))

    def _normals(self, places: np.ndarray) -> np.ndarray:
        """Of the obstacle at places, shapes (m, 3) [-] and (m, 3) [m]."""
        return self._body.normal_at(places, np.full(len(places), self._problem.distance or 0.0))

    def _reach(self, begun: np.ndarray, goal: np.ndarray, halvings: int) -> None:
        """One increment, or two halves of it."""
        displacement, anchors = self._problem.displacement.copy(), self._points.anchors.copy()
        try:
            self._increment(begun, goal)
        except NotConverged as failure:
            self._problem.displacement[:] = displacement
            self._points.anchors = anchors
            if not halvings:
                t = len(self._model.scene.tendons)
                raise LoadNotReached(failure.reason, begun[:t], float(begun[t])) from None
            middle = (begun + goal) / 2
            self._reach(begun, middle, halvings - 1)
            self._reach(middle, goal, halvings - 1)

    def _increment(self, begun: np.ndarray, goal: np.ndarray) -> None:
        """Equilibrium with bounds that are those of its own normal forces."""
        t, problem = len(self._model.scene.tendons), self._problem
        carried = goal[t + 1 :] - begun[t + 1 :] + (goal[t] - begun[t]) * self._direction
        ends = [(one[:t], one[t] + self._along(one[t + 1 :])) for one in (begun, goal)]
        problem.set_loads(*ends[0])
        self._bound(self._bounds)  # those of the equilibrium, not of an attempt that failed
        grown = problem.load_gradient(ends[1][0] - ends[0][0], ends[1][1] - ends[0][1])
        predicted = self._model.continuation.newton.linearise().solve(grown)
        self._points.anchors += carried
        problem.set_loads(*ends[1])
        problem.displacement[: len(predicted)] -= predicted
        problem.fields.u.x.scatter_forward()
        bounds, step, share = self._bound(self._bounds), np.zeros(len(self._points.nodes)), 1.0
        for _ in range(ITERATIONS):
            self._solve()
            last, step = step, self._mu * np.maximum(self._normal_forces(), 0.0) - bounds
            total, change = (problem.comm.allreduce(float(np.abs(one).sum())) for one in (bounds, step))
            if change <= SETTLED * total + self._mu * LEAST:
                self._found, self._bounds = self._points.at(problem.displacement), bounds
                self.dissipated += problem.summed(self._points.settle(problem.displacement))
                return
            share = self._relaxation(share, step, last)
            bounds = self._bound(np.maximum(bounds + share * step, 0.0))
        raise NotConverged(f"normal and tangential forces do not settle in {ITERATIONS} iterations")

    def _relaxation(self, share: float, step: np.ndarray, last: np.ndarray) -> float:
        """How much of a step to take, by Aitken's rule from the last one."""
        grown = step - last
        parts = self._problem.comm.allreduce(np.array([last @ grown, grown @ grown, last @ last]))
        return float(np.clip(-share * parts[0] / parts[1], *RELAXED)) if parts[1] > 0 < parts[2] else share

    def _solve(self) -> None:
        """Newton's method, plain or with line search."""
        newton = self._model.continuation.newton
        try:
            self.iterations += newton.solve("plain")[0]
        except NotConverged:
            self.iterations += newton.solve("line search")[0]

    def _bound(self, bounds: np.ndarray | None = None) -> np.ndarray:
        """Set the bounds, by default those of the present normal forces; what they are, shape (m,) [N]."""
        pressed = self._normal_forces()
        found = np.where(pressed > 0, self._mu * pressed if bounds is None else bounds, 0.0)
        self._points.bound(found, self._stiffness)
        return found

    def _normal_forces(self) -> np.ndarray:
        """Of the nodes, shape (m,) [N]."""
        pressed = self._contact.normal_force()[self._points.nodes]
        normals = self._normals(self._points.places(self._problem.displacement))
        return np.asarray(-np.einsum("mi,mi->m", pressed, normals))

    def _state(self) -> FrictionState:
        """What is reported of the present state."""
        problem, found = self._problem, self._found
        normal = self._normal_forces()
        own = -found.forces.sum(axis=0) - self._contact.normal_force()[self._points.nodes].sum(axis=0)
        force = problem.copies * problem.comm.allreduce(own)
        if problem.scene.is_half:
            force[2] = 0.0
        total = problem.summed(float(normal.sum()))
        stuck = problem.summed(float(normal[~found.slides].sum()))
        return FrictionState(
            tip=problem.tip(),
            force=force,
            normal_force=total,
            nodal=np.column_stack([normal, np.linalg.norm(found.forces, axis=1)]),
            sticks=stuck / total if total > 0 else np.nan,
            dissipated=self.dissipated,
            iterations=self.iterations,
        )
