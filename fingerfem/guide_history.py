"""A finger with friction of tendons in their channels, along a history of tensions at the motors and an obstacle's d.

Every tendon has a tension in each layer of the mesh. An increment ends where the finger is in equilibrium, and all
layers obey `mechanics.guides`. Newton's method finds the tensions, with the compliance of the layers by the factorised
tangent. Between its steps the finger is brought to equilibrium. An increment that does not converge is halved.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from fingerfem.discretisation.guides import GuideLayers
from fingerfem.equilibrium.failures import LoadNotReached, NotConverged
from fingerfem.mechanics.guides import STICKS, Guide, GuideLaw
from fingerfem.model import FingerModel

TOLERANCE = 1e-8  # largest change of a tension in the last step, over the largest tension at a motor [-]
STEPS = 40  # of an increment
RENEWED = 10  # steps after which the compliance is computed anew
HALVINGS = 6  # of an increment that finds no equilibrium


@dataclass(frozen=True, kw_only=True)
class GuideState:
    """A state of a history.

    Attributes:
        tip: displacement of the tip plate's centre, shape (3,) [m].
        shortenings: of the tendons between the clamp and their plates, shape (t,) [m].
        layer_tensions: of every tendon from the clamp to its plate, shapes (n,) [N].
        turned: by every tendon from the clamp to the middle of each layer, shapes (n,) [rad].
        contact_force: of the obstacle along its direction [N]; 0 without one.
        energy: stored in rubber and plates [J].
        work: of the motors since the beginning [J].
        dissipated: by friction in the channels since the beginning [J].
        steps: of Newton's method on the tensions, since the last point.
    """

    tip: np.ndarray
    shortenings: np.ndarray
    layer_tensions: list[np.ndarray]
    turned: list[np.ndarray]
    contact_force: float
    energy: float
    work: float
    dissipated: float
    steps: int


def guide_history(
    model: FingerModel, points: ArrayLike, friction: float, per_length: float = 0.0, increments: int = 4
) -> list[GuideState]:
    """States along a history from rest, from point to point in straight lines.

    Args:
        model: a finger on one rank whose tendons run in channels, without chambers.
        points: tensions at the motors [N], and d [m] of a scene with an obstacle, shape (points, t) or (points, t + 1).
        friction: coefficient of the tendons in their channels [-].
        per_length: friction besides [N/m].
        increments: from point to point.

    Raises:
        ValueError: another scene, wrong shapes, loads beyond the scene's ranges, a coefficient below 0, no increment.
        LoadNotReached: an increment without an equilibrium.

    Example:
        >>> guide_history(model, [[60.0, 0.0], [30.0, 0.0]], 0.2)[-1].layer_tensions
    """
    scene = model.scene
    if scene.chambers or any(tendon.path != "channel" for tendon in scene.tendons):
        raise ValueError("tendons must all run in channels, without chambers, got a scene with others")
    if model.problem.comm.size > 1:
        raise ValueError(f"comm must be one rank for friction in guides, got {model.problem.comm.size}")
    rows, columns = np.atleast_2d(np.asarray(points, float)), len(scene.tendons) + (scene.obstacle is not None)
    if rows.shape[1:] != (columns,) or not np.isfinite(rows).all():
        raise ValueError(f"points must be finite, shape (n, {columns}): tensions, d of an obstacle, got {rows.shape}")
    if not (0 <= friction < np.inf and 0 <= per_length < np.inf and increments >= 1):
        raise ValueError("friction and per_length must be finite and at least 0, increments at least 1")
    t = len(scene.tendons)
    for row in rows:
        model.check_loads(row[:t], float(row[t]) if columns > t else None)
    return list(_History(model, friction, per_length).states(rows, increments))


class _History:
    """A model that is led along a history."""

    def __init__(self, model: FingerModel, friction: float, per_length: float):
        self._model, self._problem, self._newton = model, model.problem, model.continuation.newton
        self._layers = GuideLayers(model.problem)
        self._laws = [
            GuideLaw(friction=friction, per_length=per_length, distances=np.diff(middles, prepend=0.0))
            for middles in self._layers.middles
        ]
        self._ends = np.cumsum([len(middles) for middles in self._layers.middles])[:-1]
        self.work, self.dissipated, self.steps = 0.0, 0.0, 0

    def states(self, rows: np.ndarray, increments: int) -> Iterator[GuideState]:
        """The state at every point."""
        t = len(self._laws)
        self._model.continuation.rest()
        self._rest = self._layers.lengths()
        begun = np.zeros(rows.shape[1])
        begun[t:] = self._problem.reach() if rows.shape[1] > t else 0.0
        zeros = [np.zeros_like(one) for one in self._rest]
        self._guides = self._present(zeros, zeros, begun)
        for row in rows:
            start, self.steps = begun, 0
            for k in range(1, 1 + increments):
                ahead = row if k == increments else start + k / increments * (row - start)
                self._reach(begun, ahead, HALVINGS)
                begun = ahead
            yield self._state(begun)

    def _present(self, tensions: list[np.ndarray], before: list[np.ndarray], loads: np.ndarray) -> list[Guide]:
        """The guides at the present displacement."""
        now, turns = self._layers.lengths(), self._layers.turns()
        shortenings = [rest - one for rest, one in zip(self._rest, now, strict=True)]
        motors = loads[: len(tensions)].tolist()
        return [Guide(*one) for one in zip(tensions, before, shortenings, turns, motors, strict=True)]

    def _reach(self, begun: np.ndarray, goal: np.ndarray, halvings: int) -> None:
        """One increment, or two halves of it."""
        problem, t = self._problem, len(self._laws)
        kept = problem.displacement.copy(), self._guides, self.work, self.dissipated
        try:
            self._increment(begun, goal)
        except NotConverged as failure:
            problem.displacement[:], self._guides, self.work, self.dissipated = kept
            if not halvings:
                raise LoadNotReached(failure.reason, begun[:t], float(begun[t]) if len(begun) > t else None) from None
            middle = (begun + goal) / 2
            self._reach(begun, middle, halvings - 1)
            self._reach(middle, goal, halvings - 1)

    def _set_loads(self, tensions: list[np.ndarray], loads: np.ndarray) -> None:
        t = len(self._laws)
        self._problem.set_loads(loads[:t], float(loads[t]) if len(loads) > t else None)
        self._layers.load(tensions)

    def _compliance(self) -> tuple[np.ndarray, np.ndarray]:
        """Displacements, (all, owned), and shortenings, (all, all), by unit tensions of all layers [m/N]."""
        linear, gradients = self._newton.linearise(), self._layers.gradients()
        rows = np.array([one.array_r.copy() for one in gradients])
        moved = -np.array([linear.solve(one) for one in gradients])
        return moved, -self._problem.copies * rows @ moved.T

    def _increment(self, begun: np.ndarray, goal: np.ndarray) -> None:
        """Equilibrium at the end of an increment, with tensions that obey the law."""
        t, last, before = len(self._laws), self._guides, [one.before for one in self._guides]
        tensions = [one.tensions for one in last]
        self._set_loads(tensions, begun)
        moved, compliance = self._compliance()
        if len(goal) > t and goal[t] != begun[t]:
            carried = self._problem.load_gradient(np.zeros(t), float(goal[t] - begun[t]))
            self._newton.add(-self._newton.linearise().solve(carried))
        begins = [one._replace(motor=float(goal[k])) for k, one in enumerate(last)]
        ahead = [law.predicted(one) for law, one in zip(self._laws, begins, strict=True)]
        scale = max(np.abs(goal[:t]).max(), np.abs(begun[:t]).max(), 1.0)
        for step in range(1, 1 + STEPS):
            self._settle(tensions, ahead, goal, moved)
            tensions, self.steps = ahead, self.steps + 1
            guides = self._present(tensions, before, goal)
            if step % RENEWED == 0:
                moved, compliance = self._compliance()
            change, moves = self._change(guides, compliance)
            if np.abs(change).max() <= TOLERANCE * scale:
                self._leave(last, guides, moves)
                return
            ahead = [
                np.maximum(one + own, 0.0) for one, own in zip(tensions, np.split(change, self._ends), strict=True)
            ]
        raise NotConverged(f"tensions in the guides still change by {np.abs(change).max():.1e} N after {STEPS} steps")

    def _settle(self, last: list[np.ndarray], tensions: list[np.ndarray], goal: np.ndarray, moved: np.ndarray) -> None:
        """Equilibrium at other tensions, from that at the last ones."""
        self._newton.add((np.concatenate(tensions) - np.concatenate(last)) @ moved)
        self._set_loads(tensions, goal)
        try:
            self._newton.solve("plain")
        except NotConverged:
            self._newton.solve("mixed")

    def _change(self, guides: list[Guide], compliance: np.ndarray) -> tuple[np.ndarray, list[np.ndarray]]:
        """A step of Newton's method on all tensions, shape (all,) [N], and how the tendons move."""
        jacobian, residuals, all_moves = np.zeros_like(compliance), [], []
        first = 0
        for law, guide in zip(self._laws, guides, strict=True):
            own = slice(first, first + len(guide.tensions))
            sums = np.cumsum(compliance[own][::-1], axis=0)[::-1]
            yielding = np.cumsum(np.diagonal(compliance)[own][::-1])[::-1]
            moves = law.moves(guide, yielding)
            rest, derivatives, rows = law.equations(guide, moves, sums)
            jacobian[own] = rows
            jacobian[own, own] += derivatives
            residuals.append(rest)
            all_moves.append(moves)
            first = own.stop
        return -np.linalg.solve(jacobian, np.concatenate(residuals)), all_moves

    def _leave(self, last: list[Guide], guides: list[Guide], moves: list[np.ndarray]) -> None:
        """Keep the guides for the next increment; count the work."""
        for law, then, now in zip(self._laws, last, guides, strict=True):
            self.dissipated += law.dissipated(now, then)
            self.work += (then.motor + now.motor) / 2 * float(now.slips[0] - now.before[0])
        self._guides = [
            one._replace(before=np.where(own == STICKS, one.before, one.slips))
            for one, own in zip(guides, moves, strict=True)
        ]

    def _state(self, loads: np.ndarray) -> GuideState:
        """Report of the present state."""
        problem = self._problem
        return GuideState(
            tip=problem.tip(),
            shortenings=np.array([one.shortenings.sum() for one in self._guides]),
            layer_tensions=[one.tensions for one in self._guides],
            turned=[np.cumsum(one.turns) for one in self._guides],
            contact_force=problem.contact.force() if problem.contact is not None else 0.0,
            energy=problem.scalar(problem.forms.strain_energy),
            work=self.work,
            dissipated=self.dissipated,
            steps=self.steps,
        )
