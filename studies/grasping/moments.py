"""Moments of grasps, for the full-order model: a finger's tensions, the solid as it sees it, and what it feels.

They cross as a file: MuJoCo and DOLFINx live in environments of their own.
"""

from __future__ import annotations

from typing import Any

import mujoco
import numpy as np
from scipy.spatial import ConvexHull
from scipy.spatial.transform import Rotation

from control.mujoco import Simulation
from control.mujoco.solids import Solid

MOMENTS = "moments.json"  # in the study's folder
DISTANCE = 0.005  # d that a moment's obstacle has [m]; any would do
FAR = 0.03  # [m], the farthest of its range
ROUNDING = 1e-4  # of a box's edges [m], where nothing touches
SAME = 1e-3  # normals that differ by less are of one face [-]
FELT = 0.05  # contact force that is looked at, at least [N]


def moment(simulation: Simulation, solid: Solid, finger: int) -> dict[str, Any]:
    """What the full-order model needs of a finger now, in its clamp's axes; or why it cannot be told.

    Returns:
        `tensions` [N]; `obstacle`, a table of a scene, and its distance `d` [m]; `contact_force`, MuJoCo's [N];
        `wrench` that the plate bears, shape (6,) [N, N m]; `following`, what of it is not that contact force: friction,
        gravity and inertia. Otherwise `skipped`.
    """
    data, attached = simulation.data, simulation.fingers[finger]
    clamp, plate = data.body(f"{attached.name} clamp"), data.body(attached.plates[-1])
    turned = clamp.xmat.reshape(3, 3)
    if solid.shape == "cone":
        return {"skipped": "no cones in the full-order model"}
    touches = touching(simulation, attached.plates[-1])
    row: dict[str, Any] = {"tensions": simulation.tensions[finger].tolist(), "shape": solid.shape, "mass": solid.mass}
    row["beyond"] = bool(simulation.left[finger] or simulation.lost[finger] or simulation.rubbed[finger])
    if not touches or sum(force for force, _, _ in touches) < FELT:
        return row | {"skipped": "no contact"}
    normal = touches[0][2]
    if any(np.abs(other - normal).max() > SAME for _, _, other in touches):
        return row | {"skipped": "two faces touch"}
    if solid.shape == "mesh" and not on_face(simulation, solid, normal):
        return row | {"skipped": "an edge of the solid touches"}
    pressed, own = np.zeros(6), plate.xmat.reshape(3, 3)
    for force, place, _ in touches:
        pressed[:3] += force * (own.T @ normal)
        pressed[3:] += np.cross(own.T @ (place - plate.xpos), force * (own.T @ normal))
    wrench = simulation.wrenches()[finger][-1]
    force = sum(force for force, _, _ in touches)
    obstacle = as_obstacle(simulation, solid, turned, clamp.xpos, normal, touches[0][1])
    return row | {
        "contact_force": force,
        "wrench": wrench.tolist(),
        "following": (wrench - pressed).tolist(),
        "friction": float(np.linalg.norm((wrench - pressed)[:3])),
        "obstacle": obstacle,
        "d": DISTANCE,
    }


def on_face(simulation: Simulation, solid: Solid, normal: np.ndarray) -> bool:
    """Whether a contact's normal, shape (3,), is that of a face of the solid."""
    faces = ConvexHull(solid.corners).equations[:, :3] @ simulation.data.body("object").xmat.reshape(3, 3).T
    return bool((np.abs(faces - normal).max(axis=1) < SAME).any())


def touching(simulation: Simulation, plate: str) -> list[tuple[float, np.ndarray, np.ndarray]]:
    """Contacts of a plate: normal force [N], place, shape (3,) [m], and normal, shape (3,), on the plate."""
    model, data, found, force = simulation.model, simulation.data, [], np.zeros(6)
    own = model.geom(plate).id
    for k, pair in enumerate(data.contact.geom):
        if own not in pair:
            continue
        mujoco.mj_contactForce(model, data, k, force)
        if force[0] > 0:
            sign = 1.0 if pair[1] == own else -1.0
            found.append((float(force[0]), data.contact.pos[k].copy(), sign * data.contact.frame[k][:3]))
    return found


def as_obstacle(
    simulation: Simulation, solid: Solid, turned: np.ndarray, clamp: np.ndarray, normal: np.ndarray, place: np.ndarray
) -> dict[str, Any]:
    """The solid as a scene's obstacle, seen from a clamp that is turned.

    Of a mesh it is the face that touches.

    The obstacle leaves against the contact's normal, so that its contact force is the part along that.
    """
    body = simulation.data.body("object")
    own, away = turned.T @ body.xmat.reshape(3, 3), turned.T @ -normal
    centre = turned.T @ (body.xpos - clamp)
    table: dict[str, Any] = {"method": "penalty", "distance": [1e-4, FAR], "direction": away.tolist()}
    if solid.shape == "sphere":
        table |= {"shape": "sphere", "radius": solid.size[0]}
    elif solid.shape == "cylinder":
        table |= {"shape": "cylinder", "radius": solid.size[0], "axis": own[:, 2].tolist()}
    elif solid.shape == "box":
        rotation = Rotation.from_matrix(own).as_rotvec()
        table |= {"shape": "box", "sides": [2 * half for half in solid.size], "rounding": ROUNDING}
        table |= {"rotation": rotation.tolist()}
    else:
        table |= {"shape": "plane", "normal": (turned.T @ normal).tolist()}
        centre = turned.T @ (place - clamp)
    return table | {"centre": (centre - DISTANCE * away).tolist()}
