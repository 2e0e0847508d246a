"""Fields between meshes whose nodes rounding puts off their lines: flat triangles lie between such."""

import numpy as np
import pytest

from rom.dataset.mesh_transfer import interpolation
from rom.dataset.snapshot_set import SnapshotError


def nodes(across: int, off: float) -> np.ndarray:
    line, random = np.linspace(-0.00875, 0.00875, across + 1), np.random.default_rng(across)
    found = np.array([[x, y, z] for x in (0.0, 0.02, 0.05) for y in line for z in line])
    section = len(line) ** 2  # the same on every plane
    found[:, 1:] += np.tile(off * random.standard_normal((section, 2)), (3, 1))
    return found


@pytest.mark.parametrize("off", [0.0, 1e-17, 1e-16])  # [m]
def test_a_linear_field_is_brought_exactly_though_nodes_are_off_their_lines(off):
    coarse, fine = nodes(6, off), nodes(12, off) * [1, 1 + 1e-13, 1 + 1e-13]  # its border is outside
    field = (coarse @ np.array([[1.0, 0.5, 0.0], [2.0, 0.0, 1.0], [-3.0, 1.0, 1.0]])).reshape(-1, 1)
    wanted = (fine @ np.array([[1.0, 0.5, 0.0], [2.0, 0.0, 1.0], [-3.0, 1.0, 1.0]])).reshape(-1, 1)
    assert np.abs(interpolation(coarse, fine)(field) - wanted).max() < 1e-13


def test_columns_are_brought_together_and_planes_must_have_as_many_nodes():
    coarse, fine = nodes(6, 0.0), nodes(9, 0.0)
    shuffled = coarse[np.random.default_rng(0).permutation(len(coarse))]
    columns = np.column_stack([shuffled.ravel(), 2 * shuffled.ravel()])
    assert interpolation(shuffled, fine)(columns) == pytest.approx(np.outer(fine.ravel(), [1, 2]), abs=1e-12)
    with pytest.raises(SnapshotError, match="must be as many on all planes"):
        interpolation(coarse[1:], fine)
