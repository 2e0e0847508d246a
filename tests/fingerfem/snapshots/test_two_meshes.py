"""States of a coarse mesh are where those of a fine one begin."""

import numpy as np
import pytest
from farm import ROOT, run

from rom.dataset.mesh_transfer import interpolation
from rom.dataset.snapshot_set import SnapshotError, SnapshotSet

DRAFT = (ROOT / "scenes" / "draft.toml").read_text()
SECOND = DRAFT[DRAFT.rindex("[[tendons]]") : DRAFT.index("[obstacle]")]
ONE = DRAFT.replace(SECOND, "").replace("tension = [0.0, 100.0]", "tension = [0.0, 60.0]")


@pytest.mark.long
def test_held_out_states_that_begin_at_a_coarser_grid_s_are_those_from_rest(tmp_path):
    coarse, fine = tmp_path / "coarse.toml", tmp_path / "fine.toml"
    coarse.write_text(ONE.replace("[20, 5]", "[14, 4]").replace("_nodes = 4", "_nodes = 7"))
    fine.write_text(ONE.replace("[20, 5]", "[20, 6]"))
    run(2, coarse, tmp_path / "coarse")
    run(2, fine, tmp_path / "rest", "--random", "24")
    run(2, fine, tmp_path / "near", "--random", "24", "--near", str(tmp_path / "coarse"))
    near, rest = SnapshotSet(tmp_path / "near"), SnapshotSet(tmp_path / "rest")
    assert not near.failures and near.iterations < rest.iterations
    for name, bound in (("tip", 1e-8), ("contact_force", 1e-4), ("displacement", 1e-8)):
        assert np.abs(near.random(name) - rest.random(name)).max() < bound


def test_a_linear_field_is_brought_from_mesh_to_mesh_exactly():
    def nodes(*counts):
        axes = [np.linspace(0, 1, n) for n in counts]
        return np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)

    coarse, fine = nodes(4, 3, 5), nodes(7, 6, 6)
    shuffled = coarse[np.random.default_rng(0).permutation(len(coarse))]
    field = lambda x: np.column_stack([x @ [1.0, 2.0, 3.0], x[:, 0], 1 - x[:, 2]])  # noqa: E731
    columns = np.column_stack([field(shuffled).ravel(), 2 * field(shuffled).ravel()])
    brought = interpolation(shuffled, fine)(columns)
    assert brought[:, 0] == pytest.approx(field(fine).ravel(), abs=1e-12)
    assert brought[:, 1] == pytest.approx(2 * field(fine).ravel(), abs=1e-12)
    with pytest.raises(SnapshotError, match="must be as many on all planes"):
        interpolation(coarse[1:], fine)
