"""A finger before an obstacle with friction, along a history of tensions and of the obstacle's positions.

An increment ends where Newton's method has converged and all forces obey Coulomb's law (`mechanics.friction`). An
increment that finds no such equilibrium is halved. Stick and slip depend on the history, so that an error of first
order in the size of the increments is left.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from fingerfem.discretisation import regions
from fingerfem.discretisation.contact.contact_points import FixedPoints, SurfaceFacets
from fingerfem.discretisation.contact.friction_points import FrictionLaw, FrictionPoints
from fingerfem.discretisation.contact.obstacle_contact import ObstacleContact
from fingerfem.discretisation.problem import Problem
from fingerfem.equilibrium.failures import LoadNotReached, NotConverged
from fingerfem.mechanics import contact
from fingerfem.model import FingerModel

TRIES = 20  # solutions by Newton's method, until the forces obey the law
LAWFUL, LEAST = 1e-7, 1e-7  # deviation from the law: over the sum of the bounds [-], and [N]
HALVINGS = 8  # of an increment that finds no equilibrium
# r of `mechanics.friction` over a cell's stiffness E h, at nodes and in lattices: with more, or less, Newton's
# method goes in circles in some histories [-].
YIELDING = 0.1, 1.0


@dataclass(frozen=True, kw_only=True)
class FrictionState:
    """A state of a history with friction.

    Attributes:
        tip: displacement of the tip plate's centre, shape (3,) [m].
        force: of the obstacle on the finger, shape (3,) [N].
        normal_force: sum of the points' normal forces [N].
        pressing: by every point of this rank that presses: normal force, and size of the tangential one, shape (m, 2)
            [N].
        sticks: share of the normal force at points that stick [-]; nan without contact.
        dissipated: by sliding, from the history's beginning [J].
        iterations: Newton iterations of the increments since the last point.
    """

    tip: np.ndarray
    force: np.ndarray
    normal_force: float
    pressing: np.ndarray
    sticks: float
    dissipated: float
    iterations: int


def friction_history(
    model: FingerModel, points: ArrayLike, coefficient: float, moved: ArrayLike | None = None, increments: int = 8
) -> list[FrictionState]:
    """States along a history, from point to point in straight lines, of plates and rubber before an obstacle.

    A first point in contact is reached by the obstacle coming along its direction, with the tensions as they are there.
    If that is oblique to the surface, d drags a round obstacle along.

    Args:
        model: a finger whose scene has one obstacle, with the penalty method.
        points: tensions [N], pressures [Pa] of chambers, and d [m], shape (n, actuators + 1).
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
    rows, ways = _checked(model, points, moved, coefficient, increments)
    return list(_History(model, coefficient).states(rows, ways, increments))


def friction_points(problem: Problem, coefficient: float) -> FrictionPoints:
    """The points at which one body touches a finger with the penalty method and with friction [-]."""
    assert problem.contact is not None
    (body,), closest = problem.bodies, problem.contact.bodies[0].closest
    rule, kinds = contact.nodal_rule(problem.scene.mesh.order), list(regions.SURFACE)
    if closest is not None:
        rule, kinds = contact.lattice_rule(contact.POINTS[0]), list(regions.RUBBER_FACETS)
    facets = SurfaceFacets(problem.space, np.concatenate([problem.mesh.facets.find(kind) for kind in kinds]))
    fixed = FixedPoints(facets, rule, float(problem.fields.stiffness.value), body)
    cell = problem.law.young_modulus * problem.mesh.smallest
    law = FrictionLaw(body, coefficient, YIELDING[closest is not None] * cell)
    return FrictionPoints(problem.fields.u, problem.fields.distance, fixed, closest, law)


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
        self._model, self._problem, self._newton = model, problem, model.continuation.newton
        self._contact: ObstacleContact = problem.contact
        self._body = problem.bodies[0]
        self._direction = np.array(self._body.direction)
        self._points = friction_points(problem, coefficient)
        self._stiffness = float(problem.fields.stiffness.value)
        self.iterations, self.dissipated = 0, 0.0

    def states(self, rows: np.ndarray, ways: np.ndarray, increments: int) -> Iterator[FrictionState]:
        """The state at every point."""
        t, continuation = rows.shape[1] - 1, self._model.continuation
        continuation.rest()
        continuation.advance(rows[0, :t], None)
        touch = self._problem.reach() - self._along(ways[0])
        begun = np.concatenate([rows[0, :t], [max(touch, rows[0, t])], ways[0]])
        self._points.start()
        self._rub(True)
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
            self._rub(False)

    def _along(self, way: np.ndarray) -> float:
        """Change of d that equals a plane's motion along its normal [m]; 0 for a round obstacle."""
        if not self._body.is_flat:
            return 0.0
        (normal,) = self._body.normal_at(np.zeros((1, 3)), np.zeros(1))
        return float(way @ normal / (self._direction @ normal))

    def _reach(self, begun: np.ndarray, goal: np.ndarray, halvings: int) -> None:
        """One increment, or two halves of it."""
        displacement, history = self._problem.displacement.copy(), self._points.history
        try:
            self._increment(begun, goal)
        except NotConverged as failure:
            self._problem.displacement[:] = displacement
            self._points.start(history)
            if not halvings:
                scene = self._model.scene
                t, chambers = len(scene.actuators), len(scene.chambers)
                raise LoadNotReached(failure.reason, begun[:t], float(begun[t]), chambers) from None
            middle = (begun + goal) / 2
            self._reach(begun, middle, halvings - 1)
            self._reach(middle, goal, halvings - 1)

    def _increment(self, begun: np.ndarray, goal: np.ndarray) -> None:
        """Equilibrium with bounds that are those of its own normal forces."""
        t, problem = len(self._model.scene.actuators), self._problem
        carried = goal[t + 1 :] - begun[t + 1 :] + (goal[t] - begun[t]) * self._direction
        ends = [(one[:t], one[t] + self._along(one[t + 1 :])) for one in (begun, goal)]
        problem.set_loads(*ends[0])
        grown = problem.load_gradient(ends[1][0] - ends[0][0], ends[1][1] - ends[0][1], carried=carried)
        predicted = self._newton.linearise().solve(grown)
        problem.set_loads(*ends[1])
        last = problem.displacement.copy()
        self._newton.add(-predicted)
        try:
            self._settle(carried)
        except NotConverged:
            problem.displacement[:] = last
            self._slip()
            self._settle(carried)

    def _rub(self, rubs: bool) -> None:
        """Have contact by the points with friction, or by the compiled forms without."""
        self._contact.friction = self._points if rubs else None
        self._problem.fields.stiffness.value = 0.0 if rubs else self._stiffness

    def _slip(self) -> None:
        """Equilibrium without friction, which has a potential and so a line search."""
        self._rub(False)
        try:
            self.iterations += self._newton.solve("plain")[0]
        except NotConverged:
            self.iterations += self._newton.solve("line search")[0]
        finally:
            self._rub(True)

    def _settle(self, carried: np.ndarray) -> None:
        """Equilibrium with friction, from the present displacement."""
        problem = self._problem
        self._points.begin(carried)
        for _ in range(TRIES):
            self.iterations += self._newton.solve("plain")[0]
            total = problem.comm.allreduce(float(self._points.drag().bounds.sum()))
            if problem.comm.allreduce(self._points.unlawful()) <= LAWFUL * total + LEAST:
                self.dissipated += problem.summed(self._points.settle())
                return
        raise NotConverged(f"friction still disobeys its law after {TRIES} solutions")

    def _state(self) -> FrictionState:
        """Report of the present state."""
        problem, drag = self._problem, self._points.drag()
        normal = drag.normal_forces
        own = -(drag.tangential.forces - normal[:, None] * drag.normals).sum(axis=0)
        force = problem.copies * problem.comm.allreduce(own)
        if problem.scene.is_half:
            force[2] = 0.0
        total = problem.summed(float(normal.sum()))
        stuck = problem.summed(float(normal[~drag.tangential.slides].sum()))
        return FrictionState(
            tip=problem.tip(),
            force=force,
            normal_force=total,
            pressing=np.column_stack([normal, np.linalg.norm(drag.tangential.forces, axis=1)]),
            sticks=stuck / total if total > 0 else np.nan,
            dissipated=self.dissipated,
            iterations=self.iterations,
        )
