"""Every quantity that a set holds of a state: name, shape, unit and scope. fingerfem writes by it, rom reads by it.

A task's file holds them state by state, first axis n; X_jacobian holds the derivatives of X by the parameters. Besides
these it holds, of every state:

    parameters   (n, p)   tensions [N], pressures [Pa], then d [m] (nan in a free state) or what presses on plates
    nodes        (n,)     positions along the line, see rom.dataset.description.Line; of all but held-out lines
    iterations   (n,)     Newton iterations
    converged    (n,)     bool; a state that is not is nan everywhere
    reason       (n,)     why not, empty if converged
    last_good    (n, p)   last load with an equilibrium on the way to a state that did not converge

and of the line: task, fingerprint, seconds.
"""

from collections.abc import Collection, Mapping
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

# Which states have a quantity: all; those of scenes with an obstacle, or with a load, or with a load and all tendons in
# channels; or those of scenes whose sampling.store names it.
Scope = Literal["state", "obstacle", "load", "load in channels", "displacement", "pad_pressure", "channel_shortening"]


@dataclass(frozen=True, kw_only=True)
class Quantity:
    """One quantity of a state.

    Attributes:
        name: in files and tables.
        shape: sizes of its axes: numbers, or names of sizes that differ from finger to finger, see `sizes`.
        unit: of it; its derivatives have it per N and per m.
        meaning: in words.
        scope: which states have it.
        jacobian: where the axis of the parameters stands among those of its derivatives.
    """

    name: str
    shape: tuple[int | str, ...]
    unit: str
    meaning: str
    scope: Scope
    jacobian: Literal["last", "first"] = "last"


QUANTITIES = (
    Quantity(name="tip", shape=(3,), unit="m", meaning="displacement of the tip plate's centre", scope="state"),
    Quantity(name="contact_force", shape=(), unit="N", meaning="integral of the contact pressure", scope="obstacle"),
    Quantity(name="touch_distance", shape=(), unit="m", meaning="free reach at these tensions", scope="obstacle"),
    Quantity(
        name="clamp_place",
        shape=("segments", 3),
        unit="m",
        meaning="the clamp's centre in every plate's own frame, from its centre",
        scope="load",
    ),
    Quantity(
        name="plate_rotation",
        shape=("segments", 4),
        unit="-",
        meaning="of every plate, a unit quaternion, its positive scalar part first",
        scope="load",
    ),
    Quantity(
        name="section_place",
        shape=("sections", 3),
        unit="m",
        meaning="mean position of every cross-section, see rom.dataset.sections.cross_sections",
        scope="load",
    ),
    Quantity(
        name="section_rotation",
        shape=("sections", 4),
        unit="-",
        meaning="rotation nearest to its motion, a unit quaternion, its scalar part first and not negative",
        scope="load",
    ),
    Quantity(
        name="section_corners",
        shape=("sections", 4, 3),
        unit="m",
        meaning="its corners -y -z, -y z, y -z, y z in its own frame, less their positions in the undeformed section",
        scope="load",
    ),
    Quantity(
        name="section_shortening",
        shape=("sections", "actuators"),
        unit="m",
        meaning="how much shorter every tendon has become from the clamp to the section, or to the tendon's end before "
        "it (a straight tendon passes no section); then how much larger every chamber has become up to there [m^3]",
        scope="load in channels",
    ),
    Quantity(
        name="pad_pressure", shape=(), unit="Pa", meaning="mean contact pressure on the pad", scope="pad_pressure"
    ),
    Quantity(
        name="channel_shortening",
        shape=("tendons",),
        unit="m",
        meaning="how much shorter every tendon has become",
        scope="channel_shortening",
    ),
    Quantity(
        name="displacement",
        shape=("nodes", 3),
        unit="m",
        meaning="of all nodes; its derivatives in single precision, for interpolation, whose error is far larger",
        scope="displacement",
        jacobian="first",
    ),
)
FIELDS = ("displacement", "displacement_jacobian")  # many times larger than all else, and read only when asked for


def sizes(*, segments: int, sections: int, tendons: int, actuators: int, nodes: int) -> dict[str, int]:
    """The sizes that shapes name."""
    return {"segments": segments, "sections": sections, "tendons": tendons, "actuators": actuators, "nodes": nodes}


def blanks(scopes: Collection[str], sizes: Mapping[str, int], parameters: int) -> dict[str, Any]:
    """Arrays of nan, by name, for a state without an answer: quantities in scope and derivatives by all parameters."""
    arrays = {}
    for quantity in QUANTITIES:
        if quantity.scope not in scopes:
            continue
        shape = tuple(sizes[size] if isinstance(size, str) else size for size in quantity.shape)
        arrays[quantity.name] = np.full(shape, np.nan)
        if quantity.jacobian == "last":
            arrays[f"{quantity.name}_jacobian"] = np.full((*shape, parameters), np.nan)
        else:
            arrays[f"{quantity.name}_jacobian"] = np.full((parameters, *shape), np.nan, np.float32)
    return arrays


def not_finite(arrays: Mapping[str, np.ndarray], converged: np.ndarray) -> str:
    """Description of a quantity or derivative that is nan or infinite in a converged state; empty if none is.

    Args:
        arrays: of a task, shapes (states, ...), by name.
        converged: which states must have all of them, shape (states,).
    """
    names = {quantity.name for quantity in QUANTITIES}
    for name, values in arrays.items():
        own = values[:, :-1] if name == "parameters" else values  # d is nan in a free state
        if name == "parameters" or name.removesuffix("_jacobian") in names:
            wrong = np.flatnonzero(converged & ~np.isfinite(own).all(axis=tuple(range(1, own.ndim))))
            if wrong.size:
                return f"{name} must be finite in a converged state, got nan or infinity in state {wrong[0]}"
    return ""
