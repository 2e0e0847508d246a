"""Maps of a rod: fitted to its states, they predict others, and know how well."""

import numpy as np
import pytest

from rom.segment.training.contact_error import relative_force_errors
from rom.segment.training.index_set import index_set
from rom.segment.training.mirrors import mirrors, with_images
from rom.snapshots.rigid_motion import motions, rotations
from tests.rom.rod import kirchhoff as rod


def cross(v: np.ndarray) -> np.ndarray:
    return np.array([[0, -v[2], v[1]], [v[2], 0, -v[0]], [-v[1], v[0], 0.0]])


def test_the_rod_obeys_the_identity_of_every_elastic_segment_in_its_plate_s_frame():
    """K - K^T = ad(w): the compliance's inverse is symmetric but for what the frame turns (measured on DOLFINx too)."""
    states = rod.states(20, 5)
    for motion, wrench in zip(motions(states.poses, states.jacobians), states.inputs[:, 2:], strict=True):
        stiffness, zero = np.linalg.inv(motion[:, 2:]), np.zeros((3, 3))
        turned = np.block([[zero, cross(wrench[:3])], [cross(wrench[:3]), cross(wrench[3:])]])
        rounding = 1e-8 * np.abs(stiffness).max()  # of the derivatives, which are differences
        assert np.abs(stiffness - stiffness.T - turned).max() < 5e-3 * np.abs(wrench).max() + rounding


def test_held_out_states_are_predicted_as_well_as_lines_that_were_left_out(rod_fit):
    segment, found = rod_fit
    held_out = rod.states(40, 9)
    errors = relative_force_errors(held_out, segment.pose.value(held_out.inputs))
    known, left_out = errors[~np.isnan(errors)], found.left_out[~np.isnan(found.left_out)]
    assert np.median(known) < 5e-4 and len(found.polynomial.powers) <= 500
    for share in (0.5, 0.9):
        assert 0.5 < np.quantile(left_out, share) / np.quantile(known, share) < 2


def test_the_error_of_a_contact_force_is_what_a_wrong_pose_makes_of_it():
    """Moved by dg along the normal, the plate is pressed by dg over the gap that a unit force closes."""
    states = rod.states(10, 3)
    h, t = 1e-4, 2
    pressed = np.flatnonzero(states.forces > 0.2)
    wrench = states.inputs[pressed, t:]
    forces = states.forces[pressed]
    # The same contact, pressed a little harder: the normal stays in space, so its share in the plate's frame turns.
    normal = wrench[:, :3] / forces[:, None]
    point = np.cross(normal, wrench[:, 3:] / forces[:, None])
    there = np.einsum("nij,nj->ni", rotations(states.poses[pressed]), normal)
    turned = normal.copy()
    for _ in range(30):
        force = (1 + h) * forces[:, None] * turned
        inputs = np.concatenate([states.inputs[pressed, :t], force, np.cross(point, force)], axis=1)
        poses = rod.poses(inputs)
        turned = np.einsum("nji,nj->ni", rotations(poses), there)
    higher = states.poses.copy()
    higher[pressed] = poses
    errors = relative_force_errors(states, higher)[pressed]
    assert errors == pytest.approx(h, rel=2e-2)


def test_mirrors_of_a_section_exchange_its_tendons():
    assert len(mirrors(rod.SCENE)) == 1  # y and z
    states = rod.states(5, 2)
    images = with_images(states, rod.SCENE)
    assert len(images.inputs) == 2 * len(states.inputs)
    assert np.abs(rod.poses(images.inputs) - images.poses).max() < 1e-12
    four = [{**rod.SCENE["tendons"][0], "offset": [s * rod.OFFSET, 0.0]} for s in (1, -1)]
    four += [{**rod.SCENE["tendons"][0], "offset": [0.0, s * rod.OFFSET]} for s in (1, -1)]
    assert len(mirrors({"tendons": four})) == 7
    unlike = [rod.SCENE["tendons"][0], {**rod.SCENE["tendons"][1], "tension": [0.0, 1.0]}]
    assert mirrors({"tendons": unlike}) == []


def test_an_index_set_keeps_to_its_weighted_degree():
    weights = np.array([1, 1, 1.5, 1.5, 1.5, 2.5, 2.5, 2.5])
    powers = index_set(weights, 4.0, 2, pure=6)
    heavy = powers[:, 2:].any(axis=1)
    assert (powers[heavy] @ weights <= 4).all() and powers[~heavy].sum(axis=1).max() == 6
    assert len({tuple(row) for row in powers.tolist()}) == len(powers)
    assert [0, 0, 0, 0, 0, 1, 0, 0] in powers.tolist() and [0, 0, 1, 0, 0, 1, 0, 0] in powers.tolist()
