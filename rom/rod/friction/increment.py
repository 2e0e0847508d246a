"""One increment of contact with friction: wrenches and contact forces by a semismooth Newton method."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from rom.brief import brief
from rom.rod.compiled.contacts import AXES, Contacts, Label, find_contacts, indented, material_points
from rom.rod.friction.contact_law import OPEN, ContactLaw, law
from rom.rod.touched_segment import TouchedSegment

TOLERANCE = 1e-9  # of the largest residual [N]
ITERATIONS = 25
DIVERGED = 1e9  # of any number, in SI units
SHARES = (0.0, 0.25, 0.5, 0.75, 1.0)  # of the friction, where it comes in steps


@brief
class Loads(NamedTuple):
    """Imposed tensions and motion of the object in an increment.

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
        loads: on it.
        wrenches: on the finger's bodies, see `Touched.loads`, shape (l,) [N, N m].
        contacts: all that may touch there, m of them.
        forces: of the object on the finger, shape (m, 3) [N].
        states: OPEN, STICKS or SLIDES, shape (m,).
        dissipated: by sliding in the increment that led here [J].
    """

    loads: Loads
    wrenches: np.ndarray
    contacts: Contacts
    forces: np.ndarray
    states: np.ndarray
    dissipated: float

    @property
    def by_label(self) -> dict[Label, np.ndarray]:
        """The forces by what they are at."""
        return dict(zip(self.contacts.labels, self.forces, strict=True))


def free(model: TouchedSegment, loads: Loads) -> Resting | None:
    """The finger without an object, which then is where the loads have it."""
    nothing = np.zeros(6 * sum(map(len, model.rod.pieces)))
    contacts = _contacts(model, loads, nothing)
    if contacts is None:
        return None
    m = len(contacts.gaps)
    return Resting(
        loads=loads,
        wrenches=nothing,
        contacts=contacts,
        forces=np.zeros((m, 3)),
        states=np.full(m, OPEN),
        dissipated=0.0,
    )


def _contacts(model: TouchedSegment, loads: Loads, wrenches: np.ndarray) -> Contacts | None:
    return find_contacts(model.touching, loads.tensions, loads.d, loads.moved, wrenches)


def advance(
    model: TouchedSegment, last: Resting, loads: Loads, friction: float, *, by_steps: bool = False
) -> Resting | None:
    """The equilibrium under other loads, which the last one goes to in one increment; None if none was found.

    Slip is that of the finger's points that touch at the increment's end, relative to the object. By steps, the
    friction grows from none: where Newton's method would go round in circles.
    """
    reached: Resting | None = last
    for share in SHARES if by_steps else (1.0,):
        if reached is not None:
            reached = _solve(model, last, loads, share * friction, reached)
    return reached


def _solve(model: TouchedSegment, last: Resting, loads: Loads, friction: float, begun: Resting) -> Resting | None:
    """The same, from the wrenches and forces of another equilibrium."""
    wrenches, at = begun.wrenches.copy(), _contacts(model, loads, begun.wrenches)
    if at is None:
        return None
    parts = _parts(at, begun.by_label)
    for _ in range(ITERATIONS):
        if not all(np.abs(one).max(initial=0.0) < DIVERGED for one in (wrenches, at.motions, at.arms, at.gaps, parts)):
            return None
        law = _law(model, last, loads, at, parts, friction)
        # A moment counts by the force that half a plate's length away makes it.
        scale = np.tile([1.0] * 3 + [1 / model.rod.half_lengths.max()] * 3, len(at.bodies))
        balance = wrenches.reshape(-1, 6)[at.bodies].ravel() - at.arms @ parts.ravel()
        residual = np.concatenate([balance, law.residuals.ravel()])
        if max(np.abs(scale * balance).max(), np.abs(law.residuals).max(initial=0.0)) < TOLERANCE:
            return Resting(
                loads=loads,
                wrenches=wrenches,
                contacts=at,
                forces=_forces(at, parts),
                states=law.states,
                dissipated=-float(np.sum(parts[:, 1:] * law.slips)),
            )
        try:
            change = np.linalg.solve(_jacobian(at, law, parts), -residual)
        except np.linalg.LinAlgError:
            return None
        touched = np.abs(at.arms).max(axis=1, initial=0.0).reshape(-1, 6).any(axis=1)  # other bodies have no load
        change_of_wrenches, change_of_parts = change[: balance.size].reshape(-1, 6), change[balance.size :]
        others, wrenches = wrenches.reshape(-1, 6), np.zeros((len(wrenches) // 6, 6))
        wrenches[at.bodies[touched]] = (others[at.bodies] + change_of_wrenches)[touched]
        wrenches = wrenches.ravel()
        there = _contacts(model, loads, wrenches)
        if there is None:
            return None
        at, parts = there, _carried(at, parts + change_of_parts.reshape(-1, AXES), there)
    return None


def _carried(at: Contacts, parts: np.ndarray, there: Contacts) -> np.ndarray:
    """Parts of forces where the finger has moved: they turn with the normals; of new contacts 0."""
    normal = dict(zip(at.labels, parts[:, 0], strict=True))
    along = _parts(there, dict(zip(at.labels, _forces(at, parts * [0, 1, 1]), strict=True)))
    return np.column_stack([[normal.get(label, 0.0) for label in there.labels], along[:, 1:]]).reshape(-1, AXES)


def _forces(at: Contacts, parts: np.ndarray) -> np.ndarray:
    """Forces in space of their parts, shape (m, 3)."""
    return np.einsum("ma,mai->mi", parts, at.axes)


def _parts(at: Contacts, known: dict[Label, np.ndarray]) -> np.ndarray:
    """Components of forces in space along n, t1, t2, shape (m, 3); 0 for contacts without a force."""
    forces = np.array([known.get(label, np.zeros(3)) for label in at.labels]).reshape(-1, 3)
    return np.einsum("mai,mi->ma", at.axes, forces)


def _law(
    model: TouchedSegment, last: Resting, loads: Loads, at: Contacts, parts: np.ndarray, friction: float
) -> ContactLaw:
    carried = loads.moved - last.loads.moved + (loads.d - last.loads.d) * model.direction
    then = material_points(model.touching.chain, last.loads.tensions, last.wrenches, at)
    slips = np.einsum("mai,mi->ma", at.axes[:, 1:], at.places - then - carried)
    # By its own force a contact's point yields so much, at least.
    normals = at.arms[:, ::AXES]
    yielding = np.einsum("im,ij,jm->m", normals, at.motions, normals)
    gaps, own = indented(at, parts[:, 0])
    stiffness = 1 / np.maximum(np.abs(yielding) + own, 1e-6)
    earlier = _parts(at, last.by_label)[:, 1:]
    gaps += _shared(at) @ parts[:, 0]
    return law(parts, np.column_stack([gaps, slips]), earlier, own, stiffness, friction)


def _shared(at: Contacts) -> np.ndarray:
    """Compliances of contacts by unit forces at others, shape (m, m) [m/N]."""
    return at.compliances - np.diag(np.diagonal(at.compliances))


def _jacobian(at: Contacts, found: ContactLaw, parts: np.ndarray) -> np.ndarray:
    """Derivatives of balance and contact law by wrenches and forces; a point's motion on the finger adds no slip."""
    size, m = len(at.motions), len(parts)
    following = np.zeros((size + 1, size + 1))  # the clamp's row and column are the last
    for k in range(m):
        following[np.ix_(at.on[k], at.on[k])] += np.einsum("a,aij->ij", parts[k], at.changes[k])
    jacobian = np.zeros((size + AXES * m, size + AXES * m))
    jacobian[:size, :size] = np.eye(size) - following[:-1, :-1] @ at.motions
    jacobian[:size, size:] = -at.arms
    opening, shared = (at.arms.T @ at.motions).reshape(m, AXES, size), _shared(at)
    for k in range(m):
        rows = slice(size + AXES * k, size + AXES * (k + 1))
        jacobian[rows, :size] = found.by_motions[k] @ opening[k]
        jacobian[rows, size::AXES] = found.by_motions[k][:, :1] * shared[k]
        jacobian[rows, rows] += found.by_forces[k]
    return jacobian
