"""An elastic rod as a segment: a second model, solved without the project's code, whose poses maps are fitted to.

Seen from its plate, a rod under a wrench there is an initial-value problem (Kirchhoff's rod with an axial strain): the
inner wrench is carried from the plate to the clamp, the strains follow from it, and the rod is built up along the way.
"""

import numpy as np
from rom.segment.segment_map import SegmentMap
from rom.segment.training import pose_fit
from rom.segment.training.build import few_products, skin_fit
from rom.segment.training.mirrors import with_images
from rom.snapshots.pressed_states import PressedStates
from scipy.spatial.transform import Rotation

from rom.error_statistics import quantiles
from rom.fit.chebyshev import Polynomial

LENGTH, PLATE, SIDE, YOUNG, OFFSET = 0.049, 0.001, 0.010, 1.1e7, 0.004
AXIAL, BENDING, TORSION = YOUNG * SIDE**2, YOUNG * SIDE**4 / 12, YOUNG / 3 * 0.141 * SIDE**4
STEPS, MOST_TENSION, MOST_FORCE = 30, 40.0, 2.0
SKIN = 6  # steps from one point of an edge to the next
EDGES = np.array([[0.0, y, z] for y in (-1, 1) for z in (-1, 1)]) * SIDE / 2
OFFSETS = np.array([[0.0, OFFSET, 0.0], [0.0, 0.0, OFFSET]])
SCENE = {
    "name": "rod",
    "geometry": {"side": SIDE, "segments": [LENGTH + PLATE], "plate": PLATE},
    "tendons": [
        {"name": name, "offset": offset, "path": "channel", "segment": 1, "tension": [0.0, MOST_TENSION]}
        for name, offset in (("F1", [OFFSET, 0.0]), ("F2", [0.0, OFFSET]))
    ],
    "load": {"force": MOST_FORCE},
}
ARMS = np.hypot([SIDE / 2, PLATE / 2, PLATE / 2], SIDE / 2)
BOX = np.array(
    [[0, MOST_TENSION]] * 2 + [[-MOST_FORCE, MOST_FORCE]] * 3 + [[-MOST_FORCE * a, MOST_FORCE * a] for a in ARMS]
)
PARAMETERS = [
    {"name": name, "unit": unit, "lower": float(low), "upper": float(high)}
    for (name, unit), (low, high) in zip(
        [("F1", "N"), ("F2", "N"), *((f"f{a}", "N") for a in "xyz"), *((f"m{a}", "N m") for a in "xyz")],
        BOX,
        strict=True,
    )
]


def poses(inputs: np.ndarray) -> np.ndarray:
    """Where the clamp is, seen from the plate: place and the plate's quaternion, shape (n, 7)."""
    return shape(inputs)[0]


def shape(inputs: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The pose, and points of the rod's four edges in the plate's frame, shapes (n, 7), (n, m, 3)."""
    pulled, force, moment = inputs[:, :2], inputs[:, 2:5], inputs[:, 5:]
    axis = np.array([1.0, 0.0, 0.0])
    tendon_force, tendon_moment = -pulled.sum(axis=1)[:, None] * axis, pulled @ np.cross(OFFSETS, -axis)

    def slope(place: np.ndarray, turned: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Of the section's place and rotation in the plate's frame, along the way to the clamp."""
        inner = np.einsum("nji,nj->ni", turned, force) + tendon_force
        carried = np.einsum("nji,nj->ni", turned, moment + np.cross(-place, force)) + tendon_moment
        curved = carried / [TORSION, BENDING, BENDING]
        spin = np.cross(curved[:, None], np.eye(3)).transpose(0, 2, 1)  # [k]x
        return -(1 + inner[:, :1] / AXIAL) * turned[:, :, 0], -turned @ spin

    place, turned = np.tile([-PLATE / 2, 0.0, 0.0], (len(inputs), 1)), np.tile(np.eye(3), (len(inputs), 1, 1))
    h, skin = LENGTH / STEPS, []
    for k in range(STEPS):  # the classical method of Runge and Kutta
        if k % SKIN == SKIN - 1:
            skin.append(place[:, None] + np.einsum("nij,ej->nei", turned, EDGES))
        one = slope(place, turned)
        two = slope(place + h / 2 * one[0], turned + h / 2 * one[1])
        three = slope(place + h / 2 * two[0], turned + h / 2 * two[1])
        four = slope(place + h * three[0], turned + h * three[1])
        place, turned = (
            now + h / 6 * (a + 2 * b + 2 * c + d)
            for now, a, b, c, d in zip((place, turned), one, two, three, four, strict=True)
        )
    quaternion = Rotation.from_matrix(turned.transpose(0, 2, 1)).as_quat(canonical=True)[:, [3, 0, 1, 2]]
    return np.concatenate([place, quaternion], axis=1), np.concatenate(skin[::-1], axis=1)  # from the clamp on


def states(count: int, seed: int) -> PressedStates:
    """Free states and pressed ones, four a line, with their derivatives by differences."""
    random = np.random.default_rng(seed)
    tensions = np.repeat(MOST_TENSION * (1 - np.cos(np.pi * random.random((count, 2)))) / 2, 5, axis=0)
    direction = random.standard_normal((5 * count, 3))
    direction /= np.linalg.norm(direction, axis=1)[:, None]
    force = MOST_FORCE * random.random((5 * count, 1)) ** 0.6 * direction
    force[::5] = 0.0
    points = np.array([PLATE, SIDE, SIDE]) / 2 * random.choice([-1, 1], (5 * count, 3))
    inputs = np.concatenate([tensions, force, np.cross(points, force)], axis=1)
    h = 1e-5 * (BOX[:, 1] - BOX[:, 0])
    ways = np.diag(h)
    after, before = ([shape(inputs + sign * way) for way in ways] for sign in (1, -1))
    jacobians, skin_jacobians = (
        np.stack([(a[i] - b[i]) / (2 * step) for a, b, step in zip(after, before, h, strict=True)], axis=-1)
        for i in (0, 1)
    )
    places, skin = shape(inputs)
    return PressedStates(
        inputs=inputs,
        poses=places,
        jacobians=jacobians,
        lines=np.repeat(np.arange(count), 5),
        skin=skin,
        skin_jacobians=skin_jacobians,
        corners=np.zeros((len(inputs), 0, 3)),
        corner_jacobians=np.zeros((len(inputs), 0, 3, inputs.shape[1])),
        shortenings=np.zeros((len(inputs), 0)),
        shortening_jacobians=np.zeros((len(inputs), 0, inputs.shape[1])),
    )


def fitted(count: int = 60, terms: int = 500) -> tuple[SegmentMap, pose_fit.PoseFit]:
    """The map of a rod, and its fit."""
    known = states(count, 0)
    found = pose_fit.best_fit(with_images(known, SCENE), BOX, terms)
    skin, skin_error = skin_fit(known, BOX, few_products(found.weights, known))
    own: Polynomial = found.polynomial
    segment = SegmentMap(
        parameters=PARAMETERS,
        pose=own,
        force_error=quantiles(found.left_out)["p95"],
        place_error=float(np.quantile(found.left_out_places, 0.95)),
        place_error_by_force=0.0,
        skin=skin,
        skin_error=skin_error,
        scene=SCENE,
        provenance={"fingerprint": "rod"},
    )
    return segment, found
