"""A finger of another modulus, size and weight is that of similarity, with its derivatives."""

import numpy as np
import pytest

import rom
from control.calibration.scaled_finger import ScaledFinger, Scales
from rom import Rod, TouchedSegment
from rom.rod.objects.shapes import facing_plane

TENSIONS = np.array([[30.0, 1.0], [10.0, 25.0], [60.0, 20.0]])
DISTANCES = np.array([np.inf, 0.02, 0.012])
GRAVITY = {"density": 1100.0, "plate_density": 7850.0, "direction": [0.3, 0.8, -0.5], "acceleration": 2000.0}
NAMES = "position", "shortening", "contact_force"


def heavy(factor=1.0):
    model = rom.load()
    gravity = GRAVITY | {"acceleration": factor * GRAVITY["acceleration"]}
    rod = Rod(elements=model.rod.elements, scene=model.rod.scene | {"gravity": gravity})
    return TouchedSegment(rod=rod, obstacle=model.obstacle)


def remade(modulus, size, gravity=None):
    """The finger of a scene of that modulus and size."""
    rod = rom.load().rod
    geometry, material = rod.scene["geometry"], rod.scene["material"]
    longer = {name: geometry[name] * size for name in ("side", "plate")}
    longer["segments"] = [one * size for one in geometry["segments"]]
    stiffer = {"C1": material["C1"] * modulus, "D1": material["D1"] / modulus}
    tendons = [
        one
        | {
            "offset": [size * part for part in one["offset"]],
            "tension": [end * modulus * size**2 for end in one["tension"]],
        }
        for one in rod.scene["tendons"]
    ]
    scene = rod.scene | {"geometry": geometry | longer, "material": material | stiffer, "tendons": tendons}
    found = Rod(elements=rod.elements, scene=scene | ({} if gravity is None else {"gravity": gravity}))
    plane = facing_plane(scene["geometry"]["side"], (0.0, sum(scene["geometry"]["segments"])))
    return TouchedSegment(rod=found, obstacle=plane)


@pytest.mark.parametrize("gravity", [None, GRAVITY])
def test_similarity_is_the_finger_assembled_at_that_modulus_and_size(gravity):
    scales = Scales(modulus=0.8, size=1.1)
    model = rom.load() if gravity is None else heavy()
    found = ScaledFinger(model).at(scales, TENSIONS, DISTANCES)
    truth = remade(*scales[:2], gravity)
    answers, report = (one(np.column_stack([TENSIONS, DISTANCES])) for one in (truth.answers, truth.report))
    assert answers.inside.all() and found.inside.all()
    assert answers.out[:, 3].max() > 0.1
    np.testing.assert_allclose(found.position, answers.out[:, :3] + truth.rod.rest, rtol=0, atol=2e-9)
    np.testing.assert_allclose(found.orientation, report.orientation, rtol=0, atol=1e-7)
    np.testing.assert_allclose(found.shortening, report.shortenings, rtol=0, atol=2e-9)
    np.testing.assert_allclose(found.contact_force, answers.out[:, 3], rtol=1e-6)


def flat(outputs):
    return np.column_stack([outputs.position, outputs.shortening, outputs.contact_force])


def test_derivatives_are_those_of_differences():
    finger, scales = ScaledFinger(heavy(), weight=True), np.array([0.9, 1.1, 1.2])
    found = finger.at(Scales(*scales), TENSIONS, DISTANCES)
    rows, step = [0, 1, 2, 6, 7, 8], 1e-5
    for k in range(3):
        pair = [
            finger.at(Scales(*scales * np.exp(s * (np.arange(3) == k))), TENSIONS, DISTANCES) for s in (step, -step)
        ]
        difference = (flat(pair[0]) - flat(pair[1])) / (2 * step)
        np.testing.assert_allclose(found.by_scales[:, rows, k], difference, rtol=1e-5, atol=1e-7)
        turned = quaternion_difference(*(one.orientation for one in pair)) / (2 * step)
        np.testing.assert_allclose(found.by_scales[:, 3:6, k], turned, rtol=1e-5, atol=1e-6)
    for k in range(2):
        push = 1e-4 * (np.arange(2) == k)
        pair = [finger.at(Scales(*scales), TENSIONS + s * push, DISTANCES) for s in (1, -1)]
        np.testing.assert_allclose(
            found.by_tension[:, rows, k], (flat(pair[0]) - flat(pair[1])) / 2e-4, rtol=1e-5, atol=1e-8
        )


def quaternion_difference(one, other):
    """Turn from the second to the first about the plate's axes, shape (n, 3) [rad]."""
    from scipy.spatial.transform import Rotation

    first, second = (Rotation.from_quat(each[:, [1, 2, 3, 0]]) for each in (one, other))
    return (second.inv() * first).as_rotvec()
