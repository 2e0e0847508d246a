"""Chains of maps against a rod that is marched through all its segments at once."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from rom.checked_file import ModelError
from rom.segment.chain import Chain
from tests.rom.segment import rod

TENSIONS = np.array([6.0, 3.0])
WRENCHES = np.array([[0.1, -0.2, 0.15, 2e-4, -3e-4, 2e-4], [-0.1, 0.12, 0.05, 3e-4, 1e-4, -2e-4]])


def whole(tensions: np.ndarray, wrenches: np.ndarray) -> list[tuple[np.ndarray, np.ndarray]]:
    """Centres and rotations of two plates of a rod, the tip's wrench carried on to the first plate by statics."""
    tip = rod.poses(np.concatenate([tensions, wrenches[1]])[None])[0]
    turned = Rotation.from_quat(tip[[4, 5, 6, 3]]).as_matrix()
    arm = -turned @ tip[:3] + np.array([rod.PLATE / 2, 0, 0])
    force = turned @ wrenches[1, :3]
    borne = wrenches[0] + np.concatenate([force, turned @ wrenches[1, 3:] + np.cross(arm, force)])
    base = rod.poses(np.concatenate([tensions, borne])[None])[0]
    first = Rotation.from_quat(base[[4, 5, 6, 3]]).as_matrix()
    centre = -first @ base[:3]
    return [(centre, first), (centre + first @ arm, first @ turned)]


def test_two_segments_stand_where_the_rod_does(segment):
    placed = Chain([segment, segment]).place(TENSIONS, WRENCHES)
    assert placed.inside
    for centre, rotation, (there, turned) in zip(
        placed.centres, placed.rotations, whole(TENSIONS, WRENCHES), strict=True
    ):
        assert centre == pytest.approx(there, abs=2e-5)
        assert rotation == pytest.approx(turned, abs=5e-4)


def test_a_chain_of_one_is_its_segment(segment):
    alone, chain = segment.place([*TENSIONS, *WRENCHES[0]]), Chain([segment]).place(TENSIONS, WRENCHES[:1])
    assert chain.centres[0] == pytest.approx(alone.centre) and chain.rotations[0] == pytest.approx(alone.rotation)
    assert chain.motions[0] == pytest.approx(alone.motion)


def test_motions_are_those_of_differences(segment):
    chain = Chain([segment, segment, segment])
    wrenches = np.vstack([WRENCHES, 0.3 * WRENCHES[:1]])
    placed = chain.place(TENSIONS, wrenches)
    for k, h in enumerate([1e-3] * 2 + ([1e-4] * 3 + [1e-6] * 3) * 3):
        unit = h * np.eye(20)[k]
        before, after = (chain.place(TENSIONS + s * unit[:2], wrenches + s * unit[2:].reshape(3, 6)) for s in (-1, 1))
        for plate in range(3):
            turned = placed.rotations[plate]
            spin = turned.T @ (after.rotations[plate] - before.rotations[plate]) / (2 * h)
            moved = turned.T @ (after.centres[plate] - before.centres[plate]) / (2 * h)
            found = np.concatenate([moved, [spin[2, 1], spin[0, 2], spin[1, 0]]])
            assert placed.motions[plate, :, k] == pytest.approx(found, rel=1e-4, abs=1e-5 * np.abs(found).max())


def test_what_is_no_chain_is_refused(segment):
    with pytest.raises(ModelError, match="at least one"):
        Chain([])
    with pytest.raises(ModelError, match="inputs must be 2 tensions"):
        Chain([segment]).place([1.0])
