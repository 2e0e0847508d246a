"""A separated model of full-order states: its commands, its errors in states, and what is refused."""

import json
import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from terminal import ran

from rom.build import covering, separate_grid
from rom.dataset.plan import Plan
from rom.dataset.schema import QUANTITIES
from rom.dataset.snapshot_set import SnapshotError, SnapshotSet, read_description, task_file
from rom.plane_check import check

NAMES = {quantity.name for quantity in QUANTITIES}


def with_scene(source: Path, folder: Path, **changes) -> Path:
    """A set whose scene has other values at some keys; its states are another set's."""
    shutil.copytree(source, folder, copy_function=lambda one, other: Path(other).symlink_to(one))
    table = json.loads((source / "set.json").read_text())
    table["scene"] |= changes
    table["fingerprint"] = "another"
    (folder / "set.json").unlink()
    (folder / "set.json").write_text(json.dumps(table))
    return folder


def with_few(source: Path, folder: Path, count: int) -> Path:
    """A set of which all states but the first ones have failed."""
    (folder / "tasks").mkdir(parents=True)
    for name in ("set.json", "body.npz"):
        shutil.copy(source / name, folder / name)
    for task in Plan(source, read_description(source)).lines:
        with np.load(task_file(source, task)) as stored:
            arrays = dict(stored)
        solved = arrays["converged"] & (np.cumsum(arrays["converged"]) <= count)
        count -= int(solved.sum())
        arrays["converged"], arrays["reason"] = solved, np.where(solved, "", "failed")
        for name, values in arrays.items():
            if name.removesuffix("_jacobian") in NAMES and values.dtype.kind == "f":
                values[~solved] = np.nan
        np.savez(task_file(folder, task), **arrays)
    return folder


def test_build_check_and_info_agree(trained, tmp_path):
    model = tmp_path / "model.h5"
    built = ran("rom", "build", trained / "training", "-o", model, "--held-out", trained / "heldout", "--json")
    assert built.returncode == 0, built.stderr
    checked, described = (
        json.loads(ran("rom", *words, "--json").stdout)
        for words in (("check", model, trained / "heldout"), ("info", model))
    )
    assert described == json.loads(built.stdout)
    assert [p["unit"] for p in described["parameters"]] == ["N", "N", "m"]
    assert described["provenance"]["versions"].keys() == {"fingerfem", "dolfinx", "petsc"}
    for name in ("tip", "contact_force", "pad_pressure", "displacement"):
        assert described["accuracy"][name]["median"] == pytest.approx(checked[name]["median"], rel=1e-2)
    printed = ran("rom", "check", model, trained / "training").stdout
    assert printed.startswith(f"{SnapshotSet(trained / 'training').states} training states, 0 failed")


def test_the_paper_s_64_states_are_as_accurate_as_the_paper_s(grid_model):
    """Its contact forces are off by 2 to 13 %; no worst case is given."""
    errors = grid_model.accuracy
    assert errors["contact_force"]["median"] < 0.12 and errors["tip"]["median"] < 0.02
    assert errors["displacement"]["median"] < 0.05 and errors["pad_pressure"]["count"] > 5


def test_estimated_errors_cover_the_true_ones_in_states_of_both_sets(grid_model, trained):
    for folder in ("heldout", "training"):
        found = check(grid_model, SnapshotSet(trained / folder))
        for name in ("tip", "contact_force", "touch_distance", "displacement", "pad_pressure"):
            assert found[name]["coverage"] >= 0.9, (folder, name)
        assert found["touch"]["force_without_touch"] == 0


@pytest.mark.long
def test_states_on_a_finer_mesh_enlarge_the_estimates_until_they_are_covered(grid_model, trained):
    training, finer = (SnapshotSet(trained / name) for name in ("training", "finer"))
    model = separate_grid(training, finer=finer)
    assert model.provenance["mesh_error"]["set"] == finer.description.held_out_id
    own, small = grid_model.errors, 1e-3
    smaller = {name: small * getattr(own, name) for name in ("tip", "touch_distance", "contact")}
    tight = replace(grid_model, errors=replace(own, **smaller))
    larger = replace(tight, errors=tight.errors.scaled(covering([(tight, finer)])))
    before, after = (check(one, finer) for one in (tight, larger))
    for name in ("tip", "contact_force", "touch_distance"):
        assert before[name]["coverage"] < 0.5 and after[name]["coverage"] >= 0.9, name
    with pytest.raises(SnapshotError, match="must be of a finer mesh than the model's"):
        separate_grid(training, finer=SnapshotSet(trained / "heldout"))


def test_contact_may_begin_earlier_by_as_much_as_the_touch_distance_is_off(grid_model):
    tensions = [60.0, 10.0]
    errors, touch = grid_model.errors, grid_model.evaluate([*tensions, 0.03]).touch_distance
    near, far = (grid_model.evaluate([*tensions, touch + share * errors.touch_distance]) for share in (0.5, 1.5))
    assert near.contact_force == far.contact_force == 0 and errors.margin >= errors.touch_distance
    assert near.error["contact_force"] > 0 and near.error["tip"] >= far.error["tip"]
    assert far.error["contact_force"] == 0 and far.error["tip"] == errors.tip


def test_a_set_of_too_few_states_is_refused_with_what_it_needs(trained, tmp_path):
    done = ran("rom", "build", with_few(trained / "training", tmp_path / "few", 3), "-o", tmp_path / "model.h5")
    assert done.returncode == 2 and "Traceback" not in done.stderr
    assert "must have" in done.stderr.splitlines()[-1] and not (tmp_path / "model.h5").exists()


def test_a_model_with_expected_errors_above_itself_is_written_only_by_force(tmp_path):
    from rom import __main__ as program

    file = tmp_path / "model.h5"
    program.check_expected(1.0, file, force=False)
    program.check_expected(5.2, file, force=True)
    with pytest.raises(SystemExit) as caught:
        program.check_expected(5.2, file, force=False)
    assert caught.value.code == 3


@pytest.mark.parametrize("kind", ["training", "heldout"])
def test_a_set_of_another_scene_names_the_key_that_differs(grid_model, trained, tmp_path, kind):
    scene = read_description(trained / kind).scene
    other = with_scene(trained / kind, tmp_path / "other", geometry=scene["geometry"] | {"side": 0.0175})
    grid_model.save(tmp_path / "model.h5")
    done = ran("rom", "check", tmp_path / "model.h5", other)
    assert done.returncode == 2 and done.stderr.count("\n") == 1
    assert done.stderr.rstrip().endswith(f"geometry.side must be {scene['geometry']['side']}, got 0.0175")


def test_sets_in_the_wrong_place_are_refused(trained, tmp_path):
    for words in (
        ("build", trained / "heldout", "-o", tmp_path / "m.h5"),
        ("build", trained / "training", "-o", tmp_path / "m.h5", "--held-out", trained / "training"),
        ("build", tmp_path, "-o", tmp_path / "m.h5"),
        ("info", trained / "demo" / "report.json"),
        ("info", tmp_path / "nowhere.h5"),
        ("build", trained / "training", "-o", tmp_path / "nowhere" / "m.h5"),
    ):
        done = ran("rom", *words)
        assert done.returncode == 2, words
        assert len(done.stderr.strip().splitlines()) == 1
    with pytest.raises(SnapshotError, match="training set"):
        SnapshotSet(trained / "training").random("tip")


def test_a_table_of_another_object_is_not_checked_against_the_plane_s_states(trained):
    from rom import Sphere, TouchedSegment, specialise

    ball = Sphere(centre=(0.046, 0.031, 0.001), radius=0.026, direction=(0, 1, 0), distances=(0.001, 0.020))
    table = specialise(TouchedSegment(rod=TouchedSegment.load().rod, obstacle=ball), 6)
    with pytest.raises(SnapshotError, match="which is no facing plane"):
        check(table, SnapshotSet(trained / "heldout"))
