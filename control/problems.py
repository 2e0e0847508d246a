"""What a finger knows when it is asked something: its model, an atlas of the model's answers, and room to work in."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from control.room import Room, Rules, room_for
from rom import Surrogate
from rom.batches import answers
from rom.compiled import compiled
from rom.growing_errors import write_growing_errors
from rom.kernel import (
    FORCE,
    TOUCH,
    Kernel,
    Workspace,
    outputs,
    write_answer_and_jacobian,
)
from rom.kernel import workspace as workspace_for

ATLAS = 20000  # points, about


class Atlas(NamedTuple):
    """Answers of the model on a grid.

    Attributes:
        tensions: shape (k, tensions) [N].
        tips: in free space, shape (k, 3) [m].
        touch_distances: shape (k,) [m].
        distances: of the plane, shape (l,) [m]; empty without an obstacle.
        contact_forces: or pad pressures over their unit, shape (l, k) [N].
        stiffness: of contact, by the way past touch, in the middle of these [N/m].
    """

    tensions: np.ndarray
    tips: np.ndarray
    touch_distances: np.ndarray
    distances: np.ndarray
    contact_forces: np.ndarray
    stiffness: float


class Model(NamedTuple):
    """What is known of a finger: its kernel, its errors (see rom.parts.Errors), its atlas, its limits [N].

    What it presses with is an output, `row`, of the kernel: contact force, or pad pressure over `unit` [1/m^2], which
    is about the pressure that a newton makes: both are solved for as forces.
    """

    kernel: Kernel
    rates: np.ndarray
    margin: float
    atlas: Atlas
    lower: np.ndarray
    upper: np.ndarray
    row: int
    unit: float


class Desk(NamedTuple):
    """Room to work in: nothing is allocated while a problem is solved, nor from one to the next on the same desk."""

    workspace: Workspace
    room: Room  # its bounds are the limits
    point: np.ndarray  # asked for last, shape (p,)
    out: np.ndarray  # answers there
    jacobian: np.ndarray
    grown: np.ndarray
    best: np.ndarray  # tensions that answer the problem
    other: np.ndarray
    between: np.ndarray


def atlas(model: Surrogate, lower: np.ndarray, upper: np.ndarray, row: int = FORCE) -> tuple[Atlas, float]:
    """The atlas of a model within limits of the tensions [N], and the unit of what it presses with."""
    p = len(model.parameters)
    nodes = max(int(ATLAS ** (1 / p)), 3)
    axes = [np.linspace(low, high, nodes) for low, high in zip(lower, upper, strict=True)]
    tensions = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, len(lower))
    if not model.has_obstacle:
        free = answers(model.kernel, tensions)[0]
        nothing = np.zeros(0), np.zeros((0, len(tensions))), 0.0
        return Atlas(tensions, free[:, :3].copy(), free[:, TOUCH].copy(), *nothing), 1.0
    free = answers(model.kernel, np.column_stack([tensions, np.full(len(tensions), np.inf)]))[0]
    touch = free[:, TOUCH].copy()
    distances = np.linspace(model.limits[0][-1], model.limits[1][-1], nodes)
    held = np.array(
        [answers(model.kernel, np.column_stack([tensions, np.full(len(tensions), d)]))[0] for d in distances]
    )
    forces, past, unit = held[..., FORCE], touch - distances[:, None], 1.0
    if row != FORCE:
        pressing = (forces > 0) & (held[..., row] > 0)
        unit = float(np.median(held[..., row][pressing] / forces[pressing])) if pressing.any() else 1.0
        forces = held[..., row] / unit
    forces = np.ascontiguousarray(forces)
    touched = (forces > 0) & (past > 0)
    stiffness = float(np.median(forces[touched] / past[touched])) if touched.any() else 1.0
    return Atlas(tensions, free[:, :3].copy(), touch, distances, forces, stiffness), unit


def known(model: Surrogate, lower: np.ndarray, upper: np.ndarray, row: int = FORCE) -> Model:
    """What is known of a finger within limits of its tensions [N], shapes (tensions,), that presses with an output."""
    pages, unit = atlas(model, lower, upper, row)
    errors = model.errors
    return Model(model.kernel, errors.contact, errors.margin, pages, lower, upper, row, unit)


def rules(tolerance: float) -> Rules:
    """When a finger's problem is solved, for a tolerance in its residual's unit."""
    return Rules(float(tolerance), longest=0.4, step=1e-4, nearest=0.1, homeward=6.0, iterations=60.0)


@compiled(allocates=True)
def desk_for(model: Model, residuals: int = 1) -> Desk:
    """Room for one finger and at most so many residuals."""
    n, p = len(model.lower), len(model.kernel.lower)
    room = room_for(n, residuals)
    room.lower[:], room.upper[:] = model.lower, model.upper
    workspace = workspace_for(model.kernel)
    m = outputs(model.kernel)
    out, jacobian = np.zeros(m), np.zeros((m, p))
    return Desk(
        workspace,
        room,
        np.zeros(p),
        out,
        jacobian,
        np.zeros(model.rates.shape[1]),
        np.zeros(n),
        np.zeros(n),
        np.zeros(n),
    )


@compiled
def ask(model: Model, desk: Desk, tensions: np.ndarray, distance: float) -> bool:
    """Write outputs and derivatives at tensions and a plane's distance; whether the point is inside the trained box."""
    n = len(tensions)
    for j in range(n):
        desk.point[j] = tensions[j]
    if model.kernel.has_obstacle:
        desk.point[n] = distance
    return write_answer_and_jacobian(model.kernel, desk.point, desk.workspace, desk.out, desk.jacobian)


@compiled
def force_error(model: Model, desk: Desk) -> float:
    """What the contact force [N] or pad pressure [Pa] that was asked for last may be off, inside the box."""
    write_growing_errors(model.kernel, model.rates, model.margin, desk.point, desk.out[TOUCH], desk.grown)
    return desk.grown[1 if model.row == FORCE else 3]
