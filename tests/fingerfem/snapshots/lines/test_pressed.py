"""Lines of pressed states at tensions of their own, whose free states begin at those of a few."""

import numpy as np
import pytest
from farm import assert_same, run

from fingerfem import FingerModel, load_scene
from fingerfem.scene.scene import Scene, SceneError
from fingerfem.snapshots.design import HeldOut, describe
from fingerfem.snapshots.lines.pressed import ROOTS
from rom.dataset.snapshot_set import read_description, read_task

LINES = 18
LOAD = {"force": 5.0}


@pytest.mark.long
def test_free_states_do_not_depend_on_where_they_began_nor_on_who_solves_them(scene, tmp_path):
    text, file = scene.read_text(), tmp_path / "pressed.toml"
    head, mesh = text.split("[obstacle]")[0], text[text.index("[mesh]") :].split("[sampling]")[0]
    file.write_text(f"{head}[load]\nforce = 5.0\n{mesh}[sampling]\nlines = {LINES}\nwrenches = 1\n")
    for ranks in (3, 1):
        run(ranks, file, tmp_path / str(ranks))
    assert_same(tmp_path / "3", tmp_path / "1")
    model, iterations = FingerModel(load_scene(file)), {"rest": 0, "root": 0}
    for k in range(ROOTS, LINES):
        line = read_task(tmp_path / "1", f"pressed-{k}")
        tensions = read_description(tmp_path / "1").scattered[k]
        state = model.solve(tensions, sensitivities=False)
        assert np.abs(line["tip"][0] - state.tip).max() < 1e-8
        iterations["rest"] += state.newton_iterations
        iterations["root"] += line["iterations"][0]
    assert iterations["root"] < 0.6 * iterations["rest"]


def pulled(table: dict, tendons: int, **parts) -> Scene:
    """The draft scene with so many tendons, and other parts in place of its obstacle and sampling."""
    offsets = [(y, z) for y in (0.004, 0.0, -0.004) for z in (0.0, 0.004, -0.004) if y or z][:tendons]
    named = [{**table["tendons"][0], "name": f"F{k}", "offset": list(one)} for k, one in enumerate(offsets)]
    kept = {key: value for key, value in table.items() if key not in ("obstacle", "sampling")}
    return Scene.model_validate({**kept, "tendons": named, **parts})


@pytest.mark.parametrize("tendons", range(1, 9))
@pytest.mark.parametrize("lines", [12, 32])
def test_few_lines_pull_every_tendon_over_its_whole_range(table, tendons, lines):
    """Lines that begin with all corners of the box had only corners, and of eight tendons some were never pulled."""
    scene = pulled(table, tendons, load=LOAD, sampling={"lines": lines})
    tensions = np.array(describe(scene, {}).scattered)
    assert tensions.shape == (lines, tendons) and not tensions[0].any()
    between = (tensions > 1.0) & (tensions < 99.0)
    assert (between.sum(axis=0) >= lines / 4).all()
    assert (tensions.max(axis=0) > 75.0).all() and (tensions.min(axis=0) < 25.0).all()


@pytest.mark.parametrize("obstacle", [True, False])
def test_lines_are_of_scenes_with_a_load_and_every_other_training_set_is_a_grid(table, obstacle):
    parts = {"obstacle": table["obstacle"]} if obstacle else {}
    lines = pulled(table, 3, sampling={"lines": 80}, **parts)  # held-out states of it are as before
    assert len(describe(lines, {}, HeldOut(count=5)).random) == 5
    with pytest.raises(SceneError, match=r"^lines must be left out where a scene has no load: .*, got 80$"):
        describe(lines, {})
    grid = describe(pulled(table, 3, sampling={"tension_nodes": 4, "contact_nodes": 5}, **parts), {})
    assert not grid.scattered and not grid.wrenches
    assert len(grid.lines) == (4**2 * (1 + 4) if obstacle else 4**2)
