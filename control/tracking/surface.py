"""The object's surface in a path's way: where the tip touches, and where it presses with the largest planned force.

Both are functions of the tip's position along the surface.
"""

from functools import partial
from typing import NamedTuple

import numpy as np
from scipy.interpolate import CubicSpline

from control.tracking.inverse import Bounds, solved
from control.tracking.options import TrackingOptions
from rom.brief import brief
from rom.rod.touched_segment import TouchedSegment

NODES = 17  # positions along the surface
PRESSED = 1e-4  # depth behind the surface at which the stiffness of contact is measured [m]
NARROW = 1e-6  # smallest length of an approach [m]
PRESS = 0.5  # force of a plan at rest over the largest one [-]
LEAST = 1e-3  # smallest stiffness of contact [N/m]
EARLY = 0.5  # depth of the path at which pressing begins, over the length of the approach [-]


@brief
class Projected(NamedTuple):
    """A path of n rows in front of an object.

    Attributes:
        tips: the path, or the surface in front of it, shape (n, 2) [m].
        approached: the same, with the speed towards the surface falling to zero before contact, shape (n, 2) [m].
        pressed: displacements of the free tip behind `approached`, by which it presses, shape (n, 2) [m].
    """

    tips: np.ndarray
    approached: np.ndarray
    pressed: np.ndarray


def projected(
    model: TouchedSegment, path: np.ndarray, pretension: np.ndarray, bounds: Bounds, options: TrackingOptions
) -> Projected:
    """Move a path, shape (n, 2) [m], in front of the model's object."""
    normal = model.direction[1:] / max(float(np.linalg.norm(model.direction[1:])), 1e-12)
    if options.distance == np.inf or not normal.any():
        return Projected(path, path, np.zeros_like(path))
    along = np.array([-normal[1], normal[0]])
    surface, depth = _surface(model, path @ along, (normal, along), pretension, bounds, options)
    gaps = surface - path @ normal
    crossing = np.flatnonzero(np.diff(np.sign(gaps)))
    speed = np.abs(np.diff(gaps))[crossing].max(initial=0.0) / options.period
    length = max(options.approach * float(speed), NARROW)
    free = approached(gaps, length)
    behind = np.maximum(-EARLY * length - gaps, 0.0)
    return Projected(
        path + np.outer(np.minimum(gaps, 0.0), normal),
        path + np.outer(gaps - free, normal),
        np.outer(limited(behind, depth), normal),
    )


def approached(gap: np.ndarray, length: float) -> np.ndarray:
    """Planned gaps [m] of a path's gaps, which are equal above `length` [m] and zero below -length; twice smooth."""
    x = np.clip(gap / length, -1.0, 1.0)
    return np.asarray(np.where(gap > length, gap, length / 2 * ((1 + x) ** 2 / 2 - (1 + np.cos(np.pi * x)) / np.pi**2)))


def limited(depth: np.ndarray, most: np.ndarray) -> np.ndarray:
    """A depth that rises like `depth` from zero, and reaches `most` at twice of it, shape (n,) [m]."""
    share = np.minimum(depth / np.maximum(2 * most, 1e-12), 1.0)
    return np.asarray(np.minimum(depth, 2 * most) * (1 - share / 2))


def _surface(
    model: TouchedSegment,
    places: np.ndarray,
    axes: tuple[np.ndarray, np.ndarray],
    pretension: np.ndarray,
    bounds: Bounds,
    options: TrackingOptions,
) -> tuple[np.ndarray, np.ndarray]:
    """Surface and largest depth of the free tip behind it, at positions along it, shapes (n,) [m]."""
    (normal, along), t, rest = axes, len(pretension), model.rod.rest[1:]
    force = PRESS * options.most_force
    middle, half = (places.max() + places.min()) / 2, max(float(np.ptp(places)) / 2, NARROW)
    nodes = middle + half * np.linspace(-1.0, 1.0, NODES)
    found = np.empty((NODES, 2))

    def touching(place: float, tensions: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        value, jacobian = model.value_and_jacobian(np.append(tensions, options.distance))
        goal = [along @ (value[1:3] + rest) - place, value[4] - options.distance]
        return np.array(goal), np.vstack([along @ jacobian[1:3, :t], jacobian[4, :t]])

    def pressing(place: float, tensions: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        value, jacobian = model.value_and_jacobian(np.append(tensions, options.distance))
        goal, rows = touching(place, tensions)
        goal[1] -= force / stiffness
        if value[3] > 0:
            goal[1], rows[1] = (value[3] - force) / stiffness, jacobian[3, :t] / stiffness
        return goal, rows

    residual = touching
    start = solved(partial(touching, nodes[0]), pretension, pretension, bounds)
    if force < np.inf:
        stiffness = max(float(-model.jacobian(np.append(start, options.distance - PRESSED))[3, t]), LEAST)
        residual = pressing
    for k, place in enumerate(nodes):
        start = solved(partial(residual, place), start, pretension, bounds)
        pressed, free = (model.outputs(np.append(start, d)[None])[0, 1:3] for d in (options.distance, np.inf))
        found[k] = normal @ (pressed + rest), normal @ (free - pressed)
    surface, depth = CubicSpline(nodes, found)(places).T
    return surface, np.full(len(places), np.inf) if force == np.inf else np.maximum(depth, 0.0)
