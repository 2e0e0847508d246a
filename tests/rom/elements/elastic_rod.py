"""An elastic rod as a finger: a second model, solved without the project's code, that elements are trained on.

Seen from its plate, a rod under a wrench there is an initial-value problem (Kirchhoff's rod with an axial strain): the
inner wrench is carried from the plate to the clamp, the strains follow from it, and the rod is built up along the way.
Every piece of it is an element without end effects, and every length of it the same rod.
"""

from typing import Any, NamedTuple

import numpy as np
from scipy.interpolate import CubicSpline

from rom.elements.samples.section_states import Bodies, SectionStates
from rom.elements.samples.symmetry import mirrors
from rom.rod.rod import Rod

LENGTH, PLATE, SIDE, YOUNG, OFFSET = 0.050, 0.001, 0.010, 1.1e7, 0.004
HALF = np.array([PLATE, SIDE, SIDE]) / 2
CORNERS = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]) * HALF  # of the plate
AXIAL, BENDING, TORSION = YOUNG * SIDE**2, YOUNG * SIDE**4 / 12, YOUNG / 3 * 0.141 * SIDE**4
MOST_TENSION, MOST_FORCE, MOST_MOMENT = 40.0, 2.0, 0.06
TWO = np.array([[OFFSET, 0.0], [0.0, OFFSET]])  # (y, z) of the tendons [m]
FOUR = np.concatenate([TWO, -TWO])
SQUARE = np.array([[0.0, y, z] for y in (-1, 1) for z in (-1, 1)]) * SIDE / 2  # corners of a section, in its frame
STEP = 0.001  # between cross-sections [m]
TWICE = 2  # steps of the method of Runge and Kutta from one to the next


class Seen(NamedTuple):
    """Cross-sections seen from the plate, from the plate's near face to the clamp: shapes (m, n, ...)."""

    places: np.ndarray
    rotations: np.ndarray
    shortenings: np.ndarray  # of the tendons between the plate and the section [m]


def scene(length: float = LENGTH, offsets: np.ndarray = TWO) -> dict[str, Any]:
    """A scene of the rod with tendons at offsets (y, z), shape (t, 2) [m], as plain data."""
    return {
        "name": "elastic rod",
        "geometry": {"side": SIDE, "segments": [length], "plate": PLATE, "channel": None},
        "material": {"law": "neo-hookean", "C1": YOUNG / 5.2, "D1": 2.4 / YOUNG},
        "tendons": [
            {"name": f"F{k + 1}", "offset": offset, "path": "straight", "segment": 1, "tension": [0.0, MOST_TENSION]}
            for k, offset in enumerate(offsets.tolist())
        ],
        "load": {"force": MOST_FORCE, "moment": MOST_MOMENT},
    }


def similar(size: float, modulus: float) -> dict[str, Any]:
    """A scene of the rod at another size and modulus, over the first one's; forces go with modulus times size^2."""
    one, force = scene(), modulus * size**2
    material = one["material"]
    tendons = [
        tendon | {"offset": [size * part for part in tendon["offset"]], "tension": [0.0, MOST_TENSION * force]}
        for tendon in one["tendons"]
    ]
    return one | {
        "geometry": {"side": SIDE * size, "segments": [LENGTH * size], "plate": PLATE * size, "channel": None},
        "material": material | {"C1": material["C1"] * modulus, "D1": material["D1"] / modulus},
        "tendons": tendons,
    }


def in_series(*lengths: float) -> dict[str, Any]:
    """A scene of several segments; both tendons pass all of them."""
    one = scene()
    tendons = [tendon | {"segment": len(lengths)} for tendon in one["tendons"]]
    return one | {"geometry": one["geometry"] | {"segments": list(lengths)}, "tendons": tendons}


def seen_from_plate(inputs: np.ndarray, length: float, offsets: np.ndarray = TWO) -> Seen:
    """The rod's cross-sections under tensions and a wrench on the plate, shape (n, t + 6) [N, N m]."""
    pulled, force, moment = np.split(inputs, [len(offsets), len(offsets) + 3], axis=1)
    axis, arms = np.array([1.0, 0.0, 0.0]), np.insert(offsets, 0, 0.0, axis=1)
    tendon_force, tendon_moment = -pulled.sum(axis=1)[:, None] * axis, pulled @ np.cross(arms, -axis)

    def slope(place: np.ndarray, turned: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        inner = np.einsum("nji,nj->ni", turned, force) + tendon_force
        carried = np.einsum("nji,nj->ni", turned, moment + np.cross(-place, force)) + tendon_moment
        curved = carried / [TORSION, BENDING, BENDING]
        spin = np.cross(curved[:, None], np.eye(3)).transpose(0, 2, 1)  # [k]x
        strain = inner[:, :1] / AXIAL
        shorter = -(strain + np.cross(curved[:, None], arms)[:, :, 0])
        return -(1 + strain) * turned[:, :, 0], -turned @ spin, shorter

    n, count = len(inputs), round((length - PLATE) / STEP)
    at = np.tile([-PLATE / 2, 0.0, 0.0], (n, 1)), np.tile(np.eye(3), (n, 1, 1)), np.zeros_like(pulled)
    found = [at]
    for _ in range(count):
        for _ in range(TWICE):
            h = STEP / TWICE
            one = slope(*at[:2])
            two = slope(*(now + h / 2 * change for now, change in zip(at[:2], one, strict=False)))
            three = slope(*(now + h / 2 * change for now, change in zip(at[:2], two, strict=False)))
            four = slope(*(now + h * change for now, change in zip(at[:2], three, strict=False)))
            at = tuple(
                now + h / 6 * (a + 2 * b + 2 * c + d) for now, a, b, c, d in zip(at, one, two, three, four, strict=True)
            )
        found.append(at)
    return Seen(*(np.stack(part) for part in zip(*found, strict=True)))


def in_space(inputs: np.ndarray, length: float, offsets: np.ndarray = TWO) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The sections from the clamp on, then the plate's centre: places, rotations, and shortenings from the clamp.

    Shapes (n, m + 1, 3), (n, m + 1, 3, 3) and (n, m + 1, t).
    """
    seen = seen_from_plate(inputs, length, offsets)
    places = np.concatenate([np.zeros((1, len(inputs), 3)), seen.places])
    turned = np.concatenate([np.tile(np.eye(3), (1, len(inputs), 1, 1)), seen.rotations])
    shorter = np.concatenate([np.zeros((1, len(inputs), len(offsets))), seen.shortenings])
    clamp, frame = places[-1], turned[-1]
    places = np.einsum("nji,mnj->nmi", frame, places - clamp)[:, ::-1]
    return (
        places,
        np.einsum("nji,mnjk->nmik", frame, turned)[:, ::-1],
        np.swapaxes(shorter[-1] - shorter, 0, 1)[:, ::-1],
    )


def corners_at(inputs: np.ndarray, length: float, at: np.ndarray) -> np.ndarray:
    """Corners of the cross-sections in space at positions, shape (m,) [m]; shape (n, m, 4, 3) [m]."""
    places, turned, _ = in_space(inputs, length)
    corners = places[:, :-1, None] + np.einsum("nmij,kj->nmki", turned[:, :-1], SQUARE)
    return CubicSpline(np.arange(corners.shape[1]) * STEP, corners, axis=1)(at)


def plate(tensions: np.ndarray, wrench: np.ndarray, length: float = LENGTH) -> tuple[np.ndarray, np.ndarray]:
    """The plate's centre and rotation in space at one state, shapes (3,) and (3, 3)."""
    places, turned, _ = in_space(np.concatenate([tensions, wrench])[None], length)
    return places[0, -1], turned[0, -1]


def placed(finger: Rod, inputs: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Centre and rotation of a one-segment finger's plate at inputs, shape (n, t + 6), and whether they are inside."""
    t = len(finger.names)
    found = [finger.place(one[:t], one[None, t:]) for one in inputs]
    parts = zip(*((one.centres[0], one.rotations[0], np.array(one.inside)) for one in found), strict=True)
    centres, rotations, inside = map(np.stack, parts)
    return centres, rotations, inside


def pressed(count: int, seed: int, offsets: np.ndarray = TWO) -> np.ndarray:
    """Inputs of free states and pressed ones, four a line, of all signs of force and moment, shape (5 count, t + 6)."""
    random = np.random.default_rng(seed)
    tensions = np.repeat(MOST_TENSION * (1 - np.cos(np.pi * random.random((count, len(offsets))))) / 2, 5, axis=0)
    wrenches = random.uniform(-1, 1, (5 * count, 6)) * np.repeat([MOST_FORCE / 2, MOST_MOMENT / 2], 3)
    wrenches[::5] = 0.0
    return np.concatenate([tensions, wrenches], axis=1)


def states(count: int, seed: int, length: float = LENGTH, offsets: np.ndarray = TWO) -> SectionStates:
    """States of the rod with their derivatives by differences, as a set would hold them."""
    return states_at(pressed(count, seed, offsets), np.repeat(np.arange(count), 5), length, offsets)


def states_at(
    inputs: np.ndarray, lines: np.ndarray, length: float = LENGTH, offsets: np.ndarray = TWO
) -> SectionStates:
    """The same at inputs, shape (n, t + 6), of lines, shape (n,)."""
    places, turned, shorter = in_space(inputs, length, offsets)
    motions, shorter_changes = [], []
    for a, h in enumerate(np.repeat([1e-3, 1e-4, 1e-6], [len(offsets), 3, 3])):
        one = np.zeros(inputs.shape[1])
        one[a] = h
        after, before = in_space(inputs + one, length, offsets), in_space(inputs - one, length, offsets)
        move, spin, change = ((late - early) / (2 * h) for late, early in zip(after, before, strict=True))
        skew = np.swapaxes(turned, -1, -2) @ spin
        turn = np.stack([skew[..., 2, 1], skew[..., 0, 2], skew[..., 1, 0]], axis=-1)
        motions.append(np.concatenate([np.einsum("nmji,nmj->nmi", turned, move), turn], axis=-1))
        shorter_changes.append(change)
    motion, shorter_change = np.stack(motions, axis=-1), np.stack(shorter_changes, axis=-1)
    m = places.shape[1] - 1
    return SectionStates(
        scene=scene(length, offsets),
        inputs=inputs,
        lines=lines,
        at=np.arange(m) * STEP,
        sections=Bodies(places=places[:, :m], rotations=turned[:, :m], motions=motion[:, :m]),
        plate=Bodies(places=places[:, m], rotations=turned[:, m], motions=motion[:, m]),
        shortenings=shorter[:, :m],
        shortening_changes=shorter_change[:, :m],
        corners=np.zeros((len(inputs), m, 4, 3)),
        corner_changes=np.zeros((len(inputs), m, 4, 3, inputs.shape[1])),
        mirrors=mirrors(scene(length, offsets)),
    )
