"""A finger for compiled controllers: its model and an atlas of the model's answers; and the calls.

Solved in compiled code (control/native/control.h).
"""

from typing import Any, NamedTuple

import numpy as np

from control.least_squares import Rules, struct
from control.model import Model
from control.native import CONTROL
from rom.answer import FORCE, TOUCH
from rom.brief import brief
from rom.native import KINDS, pointer

ATLAS = 4000  # points, about; five times as many found no more of 3,000 random holds


@brief
class Atlas(NamedTuple):
    """Answers of the model on a grid.

    Attributes:
        tensions: shape (k, tensions) [N].
        tips: in free space, shape (k, 3) [m].
        touch_distances: shape (k,) [m].
        distances: of the plane, shape (l,) [m]; empty without an obstacle.
        contact_forces: or pad pressures over their unit, shape (l, k) [N].
        stiffness: of contact, per length of contact path, in the middle of these [N/m].
    """

    tensions: np.ndarray
    tips: np.ndarray
    touch_distances: np.ndarray
    distances: np.ndarray
    contact_forces: np.ndarray
    stiffness: float


def atlas(model: Model, lower: np.ndarray, upper: np.ndarray, row: int = FORCE) -> tuple[Atlas, float]:
    """The atlas of a model within limits of the tensions [N], and the unit of what it presses with."""
    p = len(model.parameters)
    nodes = max(int(ATLAS ** (1 / p)), 3)
    axes = [np.linspace(low, high, nodes) for low, high in zip(lower, upper, strict=True)]
    tensions = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, len(lower))
    if not model.has_obstacle:
        free = model.outputs(tensions)
        nothing = np.zeros(0), np.zeros((0, len(tensions))), 0.0
        return Atlas(tensions, free[:, :3].copy(), free[:, TOUCH].copy(), *nothing), 1.0
    free = model.outputs(np.column_stack([tensions, np.full(len(tensions), np.inf)]))
    touch = free[:, TOUCH].copy()
    distances = np.linspace(model.limits[0][-1], model.limits[1][-1], nodes)
    distances[0] = distances[:2].mean()  # at the nearest an object may press on the whole side: nearly all of the time
    held = np.array([model.outputs(np.column_stack([tensions, np.full(len(tensions), d)])) for d in distances])
    forces, past, unit = held[..., FORCE], touch - distances[:, None], 1.0
    if row != FORCE:
        pressing = (forces > 0) & (held[..., row] > 0)
        unit = float(np.median(held[..., row][pressing] / forces[pressing])) if pressing.any() else 1.0
        forces = held[..., row] / unit
    forces = np.ascontiguousarray(forces)
    touched = (forces > 0) & (past > 0)
    stiffness = float(np.median(forces[touched] / past[touched])) if touched.any() else 1.0
    return Atlas(tensions, free[:, :3].copy(), touch, distances, forces, stiffness), unit


def compiled_finger(model: Model, lower: np.ndarray, upper: np.ndarray, row: int = FORCE) -> Any:
    """A finger within limits of its tensions [N], shapes (tensions,), as a struct control_finger.

    Args:
        model: its model.
        lower: limits.
        upper: limits.
        row: of the model's answer that it presses with: contact force, or pad pressure.
    """
    pages, unit = atlas(model, lower, upper, row)
    ends = [float(end[-1]) for end in model.limits] if model.has_obstacle else [0.0, 0.0]
    return CONTROL.struct(
        "control_finger",
        parameters=len(model.parameters),
        has_obstacle=model.has_obstacle,
        nearest=ends[0],
        farthest=ends[1],
        **model.native,
        lower=lower,
        upper=upper,
        row=row,
        unit=unit,
        atlas_nodes=len(pages.tensions),
        atlas_distances=len(pages.distances),
        **pages._asdict(),
    )


def rules(tolerance: float) -> Any:
    """When a finger's problem is solved, for a tolerance in its residual's unit: a struct control_rules."""
    return struct(Rules(float(tolerance), longest=0.4, step=1e-4, nearest=0.1, null_space_iterations=6, iterations=60))


def memory_of(finger: Any, readings: int = 1) -> Any:
    """Memory for a function of a struct control_finger to work in: a call's own."""
    return pointer(np.empty(CONTROL.functions.control_memory(finger, readings)))


def hold(finger: Any, start: np.ndarray, target: float, distance: float, rules: Any) -> tuple[np.ndarray, Any]:
    """Tensions nearest to a start, shape (tensions,) [N], that press on a plane; and a struct control_outcome.

    Args:
        finger: a struct control_finger.
        start: shape (tensions,) [N].
        target: contact force, or pad pressure over the finger's unit [N].
        distance: of the plane [m].
        rules: a struct control_rules.
    """
    tensions, outcome = np.empty(len(start)), CONTROL.ffi.new("control_outcome *")
    arguments = pointer(start), target, distance, rules, memory_of(finger), pointer(tensions), outcome
    CONTROL.functions.control_hold(finger, *arguments)
    return tensions, outcome


def hold_many(
    finger: Any, starts: np.ndarray, target: float, distances: np.ndarray, rules: Any
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Hold from many starts, shape (n, tensions) [N], at as many distances, shape (n,) [m].

    Returns:
        tensions, shape (n, tensions) [N]; outcomes, a structured array of shape (n,); and the time of each, measured
        in compiled code, shape (n,) [ns].
    """
    n, tensions = len(starts), np.empty(starts.shape)
    outcomes, nanoseconds = CONTROL.ffi.new("control_outcome[]", n), np.empty(n, np.int64)
    CONTROL.functions.control_hold_many(
        finger,
        n,
        pointer(np.ascontiguousarray(starts)),
        target,
        pointer(np.ascontiguousarray(distances)),
        rules,
        memory_of(finger),
        pointer(tensions),
        outcomes,
        pointer(nanoseconds, "int64_t[]"),
    )
    kind = {name: field.type.cname for name, field in CONTROL.ffi.typeof("control_outcome").fields}
    layout = np.dtype([(name, KINDS[cname]) for name, cname in kind.items()], align=True)
    return tensions, np.frombuffer(CONTROL.ffi.buffer(outcomes), layout).copy(), nanoseconds


def reach(
    finger: Any, start: np.ndarray, change: float, target: np.ndarray, distance: float, rules: Any
) -> tuple[np.ndarray, Any]:
    """Tensions nearest to a start that displace the tip to a target, shape (3,) [m], before a plane; and the outcome.

    If no tension may change by more than a finite `change` [N], from the start only.
    """
    tensions, outcome = np.empty(len(start)), CONTROL.ffi.new("control_outcome *")
    arguments = pointer(start), change, pointer(target), distance, rules, memory_of(finger), pointer(tensions), outcome
    CONTROL.functions.control_reach(finger, *arguments)
    return tensions, outcome


def locate(finger: Any, tensions: np.ndarray, felt: np.ndarray, hint: float, rules: Any) -> Any:
    """The plane on which tensions, shape (m, tensions) [N], press with forces, shape (m,) [N]: the outcome."""
    outcome = CONTROL.ffi.new("control_outcome *")
    arguments = pointer(tensions), pointer(felt), hint, rules, memory_of(finger, len(felt)), outcome
    CONTROL.functions.control_locate(finger, len(felt), *arguments)
    return outcome


def grip(
    finger: Any,
    then: np.ndarray,
    felt: float,
    present: np.ndarray,
    aim: float,
    distance: float,
    gain: float,
    rules: Any,
) -> tuple[np.ndarray, Any]:
    """Find the plane from a reading [N] at the tensions `then`; then tensions near the present that hold `aim` [N].

    The plane's distance [m], nan before the first reading, is corrected by a share `gain`.

    Returns:
        tensions [N], and the outcome: distance, force that was expected before the reading [N], status of holding.
    """
    tensions, outcome = np.empty(len(present)), CONTROL.ffi.new("control_outcome *")
    arguments = pointer(then), felt, pointer(present), aim, distance, gain, rules
    CONTROL.functions.control_grip(finger, *arguments, memory_of(finger), pointer(tensions), outcome)
    return tensions, outcome
