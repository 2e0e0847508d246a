"""One increment of contact with friction: wrenches and contact forces by a semismooth Newton method."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from rom.brief import brief
from rom.rod import native
from rom.rod.friction.contact_law import OPEN, SLIDES, Law, law
from rom.rod.rod import Plates
from rom.rod.touched_segment import TouchedSegment

TOLERANCE = 1e-9  # of the largest residual [N]
ITERATIONS = 25
SHARES = (0.0, 0.25, 0.5, 0.75, 1.0)  # of the friction, where it comes in steps
Label = tuple[int, int]  # of a contact: its plate, and what of it and of the object


@brief
class Loads(NamedTuple):
    """What a finger bears.

    Attributes:
        tensions: shape (t,) [N].
        d: of the object along its direction [m].
        moved: of the object besides, shape (3,) [m].
    """

    tensions: np.ndarray
    d: float
    moved: np.ndarray

    def towards(self, other: Loads, share: float) -> Loads:
        """A share [-] of the way to others."""
        if share == 1.0:
            return other
        tensions, moved = (a + share * (b - a) for a, b in ((self.tensions, other.tensions), (self.moved, other.moved)))
        return Loads(tensions, self.d + share * (other.d - self.d), moved)


@brief
@dataclass(frozen=True, kw_only=True)
class Resting:
    """An equilibrium with friction.

    Attributes:
        loads: that it bears.
        placed: where the n plates are.
        wrenches: on them in their own frames, shape (n, 6) [N, N m].
        contacts: all that may touch there, m of them.
        forces: of the object on the plates in their own frames, shape (m, 3) [N].
        states: OPEN, STICKS or SLIDES, shape (m,).
        dissipated: by sliding in the increment that led here [J].
    """

    loads: Loads
    placed: Plates
    wrenches: np.ndarray
    contacts: native.Contacts
    forces: np.ndarray
    states: np.ndarray
    dissipated: float

    @property
    def by_label(self) -> dict[Label, np.ndarray]:
        """The forces by what they are at."""
        return dict(zip(self.contacts.labels, self.forces, strict=True))


class _At(NamedTuple):
    """What the equations are made of at some wrenches; directions n, t1, t2 of every contact, shape (m, 3, 3)."""

    placed: Plates
    contacts: native.Contacts
    axes: np.ndarray
    motions: np.ndarray  # (g, s), shape (m, 3) [m]
    by_plates: np.ndarray  # of these, by the motion of their plate, shape (m, 3, 6)


def free(model: TouchedSegment, loads: Loads) -> Resting:
    """The plates without an object, which then is where the loads have it."""
    nothing = np.zeros((len(model.rod.segments), 6))
    placed = model.rod.place(loads.tensions, nothing)
    contacts = _contacts(model, loads, placed)
    m = len(contacts.gaps)
    return Resting(
        loads=loads,
        placed=placed,
        wrenches=nothing,
        contacts=contacts,
        forces=np.zeros((m, 3)),
        states=np.full(m, OPEN),
        dissipated=0.0,
    )


def _contacts(model: TouchedSegment, loads: Loads, placed: Plates) -> native.Contacts:
    return native.contacts(model.touching, loads.tensions, loads.d, placed.centres - loads.moved, placed.rotations)


def advance(
    model: TouchedSegment, last: Resting, loads: Loads, friction: float, *, by_steps: bool = False
) -> Resting | None:
    """The equilibrium under other loads, which the last one goes to in one increment; None if none was found.

    Slip is that of the plates' points that touch at the increment's end, relative to the object. By steps, the friction
    grows from none: where Newton's method would go round in circles.
    """
    found: Resting | None = last
    for share in SHARES if by_steps else (1.0,):
        if found is not None:
            found = _solve(model, last, loads, share * friction, found)
    return found


def _solve(model: TouchedSegment, last: Resting, loads: Loads, friction: float, begun: Resting) -> Resting | None:
    """The same, from the wrenches and forces of another equilibrium."""
    wrenches = begun.wrenches.copy()
    at = _at(model, last, loads, wrenches)
    forces = _forces(at.contacts, begun.by_label)
    # A moment counts by the force that half a plate's length away makes it.
    scale = np.tile([1.0] * 3 + [1 / model.rod.half_lengths.max()] * 3, len(wrenches))
    for _ in range(ITERATIONS):
        found = _law(at, forces, last.by_label, friction)
        balance = (wrenches - _wrenches(at.contacts, forces, wrenches.shape)).ravel()
        residual = np.concatenate([balance, found.residuals.ravel()])
        if not np.isfinite(residual).all():
            return None
        if max(np.abs(scale * balance).max(), np.abs(found.residuals).max(initial=0.0)) < TOLERANCE:
            slipped = np.einsum("mi,mi->m", _parts(at, forces)[:, 1:], at.motions[:, 1:])
            return Resting(
                loads=loads,
                placed=at.placed,
                wrenches=wrenches,
                contacts=at.contacts,
                forces=forces,
                states=found.states,
                dissipated=float(-slipped[found.states == SLIDES].sum()),
            )
        try:
            change = np.linalg.solve(_jacobian(at, found, forces, wrenches.size), -residual)
        except np.linalg.LinAlgError:
            return None
        moved = dict(zip(at.contacts.labels, forces + change[wrenches.size :].reshape(-1, 3), strict=True))
        wrenches = wrenches + change[: wrenches.size].reshape(wrenches.shape)
        at = _at(model, last, loads, wrenches)
        forces = _forces(at.contacts, moved)
    return None


def _at(model: TouchedSegment, last: Resting, loads: Loads, wrenches: np.ndarray) -> _At:
    placed = model.rod.place(loads.tensions, wrenches)
    contacts = _contacts(model, loads, placed)
    own, p, n = contacts.plates, contacts.points, contacts.normals
    axes = np.stack([n, *_across(n)], axis=1)
    now = placed.centres[own] + np.einsum("mij,mj->mi", placed.rotations[own], p)
    then = last.placed.centres[own] + np.einsum("mij,mj->mi", last.placed.rotations[own], p)
    carried = loads.moved - last.loads.moved + (loads.d - last.loads.d) * model.direction
    way = np.einsum("mji,mj->mi", placed.rotations[own], now - then - carried)
    motions = np.column_stack([contacts.gaps, np.einsum("mai,mi->ma", axes[:, 1:], way)])
    by_plates = np.concatenate([axes, np.cross(p[:, None], axes)], axis=2)
    return _At(placed, contacts, axes, motions, by_plates)


def _across(normals: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Two unit vectors across each normal, shapes (m, 3)."""
    least = np.eye(3)[np.abs(normals).argmin(axis=1)] if len(normals) else np.zeros((0, 3))
    first = np.cross(normals, least)
    first /= np.linalg.norm(first, axis=1)[:, None]
    return first, np.cross(normals, first)


def _forces(contacts: native.Contacts, known: dict[Label, np.ndarray]) -> np.ndarray:
    return np.array([known.get(label, np.zeros(3)) for label in contacts.labels]).reshape(-1, 3)


def _parts(at: _At, forces: np.ndarray) -> np.ndarray:
    """Forces along n, t1, t2, shape (m, 3)."""
    return np.einsum("mai,mi->ma", at.axes, forces)


def _law(at: _At, forces: np.ndarray, before: dict[Label, np.ndarray], friction: float) -> Law:
    own = at.contacts.plates
    # By its own force a contact's point yields so much, at least.
    yielding = np.einsum("mi,mij,mj->m", at.by_plates[:, 0], _compliances(at)[own], at.by_plates[:, 0])
    stiffness = 1 / np.maximum(np.abs(yielding), 1e-6)
    earlier = _parts(at, _forces(at.contacts, before))[:, 1:]
    return law(_parts(at, forces), at.motions, earlier, stiffness, friction)


def _compliances(at: _At) -> np.ndarray:
    """Of every plate, by its own wrench, shape (n, 6, 6)."""
    n = len(at.placed.centres)
    motions = at.placed.motions[:, :, -6 * n :]
    return np.array([motions[q][:, 6 * q : 6 * q + 6] for q in range(n)])


def _wrenches(contacts: native.Contacts, forces: np.ndarray, shape: tuple[int, ...]) -> np.ndarray:
    found = np.zeros(shape)
    np.add.at(found, contacts.plates, np.hstack([forces, np.cross(contacts.points, forces)]))
    return found


def _jacobian(at: _At, found: Law, forces: np.ndarray, size: int) -> np.ndarray:
    """Of balance and law, by the wrenches and the forces; slips by what p moves on its plate are left out."""
    contacts, m = at.contacts, len(forces)
    jacobian = np.eye(size + 3 * m)
    motions = at.placed.motions[:, :, -size:]
    for k in range(m):
        q, rows = int(contacts.plates[k]), slice(size + 3 * k, size + 3 * k + 3)
        wrench, force = slice(6 * q, 6 * q + 6), forces[k]
        axes, normal_changes = at.axes[k], contacts.normal_changes[k]
        # Balance: w - (f, p x f).
        jacobian[wrench, rows] = -np.vstack([np.eye(3), _cross(contacts.points[k])])
        jacobian[6 * q + 3 : 6 * q + 6, :size] += _cross(force) @ contacts.point_changes[k] @ motions[q]
        # Law: f_n = n . f; t turns as n does.
        parts_by_plate = np.vstack([force @ normal_changes, -(force @ axes[0]) * (axes[1:] @ normal_changes)])
        by_plate = found.by_forces[k] @ parts_by_plate + found.by_motions[k] @ at.by_plates[k]
        jacobian[rows, :size] = by_plate @ motions[q]
        jacobian[rows, rows] = found.by_forces[k] @ axes
    return jacobian


def _cross(a: np.ndarray) -> np.ndarray:
    """The matrix of a x."""
    return np.array([[0.0, -a[2], a[1]], [a[2], 0.0, -a[0]], [-a[1], a[0], 0.0]])
