"""Contact with friction along a history of tensions and of the object's places."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from rom.brief import brief
from rom.files.checked_file import ModelError
from rom.rod.friction.contact_law import OPEN, SLIDES
from rom.rod.friction.increment import Loads, Resting, advance, free
from rom.rod.objects.shapes import Cylinder, Plane, Sphere
from rom.rod.touched_rod import ContactForce
from rom.rod.touched_segment import TouchedSegment

HALVINGS = 8  # of an increment that finds no equilibrium, or one too far away
SUSPECT, JUMP = 3.0, 30.0  # motion of the plates over what drives it, above which an increment is halved; refused
NEAR = 1e-6  # [m]: motion of the plates that is never too much
Status = Literal["converged", "out_of_domain", "no_equilibrium"]


@brief
@dataclass(frozen=True, kw_only=True)
class FrictionState:
    """State at a point of a history.

    Attributes:
        status: `out_of_domain` where the elements were not trained, here or on the way, or the object may not be;
            `no_equilibrium` where none was found, if the way there was inside. From there on all numbers are nan.
        tip: displacement of the tip plate's centre, shape (3,) [m].
        force: of the object on the finger, shape (3,) [N].
        contact_force: its part along the object's way to the finger, as of a touched segment [N].
        contacts: where the object presses.
        dissipated: by sliding, from the history's begin [J].
    """

    status: Status
    tip: np.ndarray
    force: np.ndarray
    contact_force: float
    contacts: list[ContactForce]
    dissipated: float


def friction_history(
    model: TouchedSegment,
    points: ArrayLike,
    friction: float,
    moved: ArrayLike | None = None,
    increments: int = 8,
) -> list[FrictionState]:
    """States along a history, from point to point in straight lines; contact sticks and slides by Coulomb's law.

    A first point in contact is reached by the object coming along its direction, with the tensions as they are there.
    Sticking and sliding depend on the way: an error of first order in the increments' size is left. There are
    as many more of them as keep an object from passing a plate by between two.

    Args:
        model: segments and the object.
        points: tensions [N] and d [m], shape (n, t + 1).
        friction: coefficient of friction [-].
        moved: of the object besides, shape (n, 3) [m]; not at all if left out.
        increments: from point to point, at least; one that finds no equilibrium, or only one far away, is halved.

    Raises:
        ModelError: points or moved of a wrong shape.
        ValueError: numbers that are not finite, friction below 0, no increment.

    Example:
        >>> friction_history(model, [[20, 0, 0.01]] * 2, 0.5, moved=[[0, 0, 0], [0.002, 0, 0]])[-1].force
    """
    rows = np.atleast_2d(np.asarray(points, float))
    ways = np.zeros((len(rows), 3)) if moved is None else np.atleast_2d(np.asarray(moved, float))
    if rows.shape[1:] != (len(model.parameters),) or not len(rows) or ways.shape != (len(rows), 3):
        raise ModelError(
            f"points must be {', '.join(model.names)} and moved of shape ({len(rows)}, 3), "
            f"got {rows.shape}, {ways.shape}"
        )
    if not (np.isfinite(rows).all() and np.isfinite(ways).all() and 0 <= friction < np.inf and increments >= 1):
        raise ValueError("points, moved and friction must be finite, friction at least 0, increments at least 1")
    return list(_states(model, rows, ways, friction, increments))


def _states(
    model: TouchedSegment, rows: np.ndarray, ways: np.ndarray, friction: float, increments: int
) -> Iterator[FrictionState]:
    loads = [Loads(row[:-1], float(row[-1]), way) for row, way in zip(rows, ways, strict=True)]
    there = replace(model, obstacle=replace(model.obstacle, centre=tuple(np.add(model.obstacle.centre, ways[0]))))
    touch = float(there.outputs(rows[:1])[0, 4])
    state: Resting | None = free(model, loads[0]._replace(d=max(touch, loads[0].d)))
    dissipated, known = 0.0, True
    for goal in loads:
        count = max(increments, _least(model, state.loads, goal)) if state is not None else 0
        for k in range(count):
            if state is None:
                break
            ahead = state.loads.towards(goal, 1 / (count - k))
            state, last, lost = _reach(model, state, ahead, friction, HALVINGS)
            dissipated += lost
            known &= last.contacts.inside or not last.wrenches.any()
        report = _report(model, state, dissipated, known)
        known &= report.status == "converged" or not report.contacts
        yield report


def _least(model: TouchedSegment, begun: Loads, goal: Loads) -> int:
    """Increments in which neither the object nor the free plates go farther than a part of what they may pass by."""
    obstacle = model.obstacle
    thin = np.inf if isinstance(obstacle, Plane) else model.rod.half_lengths.min()
    if isinstance(obstacle, Sphere | Cylinder):
        thin = min(obstacle.radius, model.rod.half_lengths.max())
    return int(np.ceil(2 * _pushed(model, begun, goal) / thin))


def _pushed(model: TouchedSegment, begun: Loads, goal: Loads) -> float:
    """Motion of the object plus the largest of the plates by tensions alone [m]."""
    object_way = goal.moved - begun.moved + (goal.d - begun.d) * model.direction
    one, other = (model.rod.place(loads.tensions).centres for loads in (begun, goal))
    return float(np.linalg.norm(object_way) + np.linalg.norm(other - one, axis=1).max())


def _reach(
    model: TouchedSegment, last: Resting, goal: Loads, friction: float, halvings: int
) -> tuple[Resting | None, Resting, float]:
    """The equilibrium at a goal, the last one on the way to it, and what was dissipated, in as many parts as needed."""
    reached = advance(model, last, goal, friction)
    if reached is None and not halvings:
        reached = advance(model, last, goal, friction, by_steps=True)
    if reached is not None:
        way = np.linalg.norm(reached.contacts.centres - last.contacts.centres, axis=1).max()
        if way > (SUSPECT if halvings else JUMP) * _pushed(model, last.loads, goal) + NEAR:
            reached = None
    if reached is not None or not halvings:
        return reached, reached or last, 0.0 if reached is None else reached.dissipated
    between, last, first = _reach(model, last, last.loads.towards(goal, 0.5), friction, halvings - 1)
    if between is None:
        return None, last, first
    reached, last, second = _reach(model, between, goal, friction, halvings - 1)
    return reached, last, first + second


def _report(model: TouchedSegment, state: Resting | None, dissipated: float, known: bool) -> FrictionState:
    if state is None:
        nothing = np.full(3, np.nan)
        return FrictionState(
            status="no_equilibrium" if known else "out_of_domain",
            tip=nothing,
            force=nothing,
            contact_force=np.nan,
            contacts=[],
            dissipated=np.nan,
        )
    contacts = state.contacts
    forces = [
        ContactForce(
            int(contacts.segments[k]),
            contacts.places[k],
            contacts.axes[k, 0],
            state.forces[k],
            slides=bool(state.states[k] == SLIDES),
            rubber=bool(contacts.rubber[k]),
        )
        for k in np.flatnonzero(state.states != OPEN)
    ]
    force = np.sum([one.force for one in forces], axis=0) if forces else np.zeros(3)
    return FrictionState(
        status="converged" if known and _is_known(model, state) else "out_of_domain",
        tip=contacts.centres[-1] - model.rod.rest,
        force=force,
        contact_force=float(-force @ model.direction),
        contacts=forces,
        dissipated=dissipated,
    )


def _is_known(model: TouchedSegment, state: Resting) -> bool:
    lower, upper = model.limits
    point = np.append(state.loads.tensions, state.loads.d)
    return state.contacts.inside and bool((point >= lower).all() and (point <= upper).all())
