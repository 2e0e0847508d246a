"""Lines of states at scattered tensions, whose free states begin at those of a few."""

import numpy as np
import pytest
from farm import assert_same, run

from fingerfem import FingerModel, load_scene
from fingerfem.scene.scene import Scene
from fingerfem.snapshots.design import describe
from fingerfem.snapshots.lines.scattered import ROOTS
from rom.snapshots.snapshot_set import read_description, read_task

LINES = 18


def test_free_states_do_not_depend_on_where_they_began_nor_on_who_solves_them(scene, tmp_path):
    file = tmp_path / "scattered.toml"
    file.write_text(f"{scene.read_text().split('[sampling]')[0]}[sampling]\nlines = {LINES}\ncontact_nodes = 4\n")
    for ranks in (3, 1):
        run(ranks, file, tmp_path / str(ranks))
    assert_same(tmp_path / "3", tmp_path / "1")
    model, iterations = FingerModel(load_scene(file)), {"rest": 0, "root": 0}
    for k in range(ROOTS, LINES):
        line = read_task(tmp_path / "1", f"scattered-{k}")
        tensions = read_description(tmp_path / "1").scattered[k]
        state = model.solve(tensions, sensitivities=False)
        assert np.abs(line["tip"][0] - state.tip).max() < 1e-8
        iterations["rest"] += state.newton_iterations
        iterations["root"] += line["iterations"][0]
    assert iterations["root"] < 0.6 * iterations["rest"]


@pytest.mark.parametrize("tendons", range(1, 9))
@pytest.mark.parametrize("lines", [12, 32])
def test_few_lines_pull_every_tendon_over_its_whole_range(table, tendons, lines):
    """Lines that begin with all corners of the box had only corners, and of eight tendons some were never pulled."""
    offsets = [(y, z) for y in (0.004, 0.0, -0.004) for z in (0.0, 0.004, -0.004) if y or z][:tendons]
    pulled = [{**table["tendons"][0], "name": f"F{k}", "offset": list(one)} for k, one in enumerate(offsets)]
    scene = Scene.model_validate({**table, "tendons": pulled, "sampling": {"lines": lines}})
    tensions = np.array(describe(scene, {}).scattered)
    assert tensions.shape == (lines, tendons) and not tensions[0].any()
    between = (tensions > 1.0) & (tensions < 99.0)
    assert (between.sum(axis=0) >= lines / 4).all()
    assert (tensions.max(axis=0) > 75.0).all() and (tensions.min(axis=0) < 25.0).all()
