"""A scene pays only for what it names: counted in forms, unknowns, axes and datasets."""

import copy

import h5py
import pytest
from farm import run

from fingerfem import FingerModel
from fingerfem.scene.scene import Scene
from rom.build import train
from rom.separated.alternating_directions import EnrichmentOptions
from rom.snapshots.snapshot_set import SnapshotSet, read_task
from studies.kinds import forms_of
from studies.sets import as_toml

SMALL = {"mesh": {"cells": [10, 5], "order": 1}}


@pytest.fixture(scope="module")
def built(tmp_path_factory):
    """Tables of scenes -> their set and model file, each solved once."""
    folder, known = tmp_path_factory.mktemp("required"), {}

    def build(name: str, scene: dict) -> tuple[SnapshotSet, dict[str, tuple[int, ...]]]:
        if name not in known:
            file = folder / f"{name}.toml"
            file.write_text(as_toml(scene))
            run(2, file, folder / name)
            found = SnapshotSet(folder / name)
            train(found, EnrichmentOptions(tolerance=1e-3)).save(folder / f"{name}.h5")
            datasets: dict[str, tuple[int, ...]] = {}
            with h5py.File(folder / f"{name}.h5") as content:
                content.visititems(
                    lambda key, item: datasets.update({key: item.shape}) if isinstance(item, h5py.Dataset) else None
                )
            known[name] = found, datasets
        return known[name]

    return build


def scene(table: dict, **parts) -> dict:
    found = copy.deepcopy(table) | SMALL | {"sampling": {"lines": 8} | parts.pop("sampling", {})}
    for name, value in parts.items():
        if value is None:
            del found[name]
        else:
            found[name] = value
    return found


def quantities(found: SnapshotSet) -> set[str]:
    names: set[str] = set()
    for task in found.plan.lines:
        names |= set(read_task(found.path, task))
    return names


def forms(table: dict) -> int:
    return forms_of(FingerModel(Scene.model_validate(table)).problem.forms)


def test_without_a_plane_there_are_no_contact_forms_no_axis_and_no_dataset_of_it(table, built):
    plain, free = scene(table), scene(table, obstacle=None)
    assert forms(free) < forms(plain)
    states, datasets = built("free", free)
    assert [one["name"] for one in states.description.parameters] == ["F1", "F2"]
    assert all(len(line.nodes) == 1 for line in states.plan.lines.values())
    named = {"contact_force", "touch_distance", "regime", "plate_force", "centre_of_pressure", "pad_pressure"}
    assert not named & quantities(states)
    assert not any(name.startswith("contact") or "regime" in name for name in datasets)


def test_a_tendon_that_is_not_named_has_no_axis_and_a_planar_pull_half_the_mesh(table, built):
    spatial = scene(table)
    planar = scene(table, tendons=table["tendons"][:1])
    whole, half = (FingerModel(Scene.model_validate(one)) for one in (spatial, planar))
    assert half.problem.unknowns < 0.7 * whole.problem.unknowns
    states, datasets = built("planar", planar)
    assert [one["name"] for one in states.description.parameters] == ["F1", "d"]
    assert "free/values_0" in datasets and "free/values_1" not in datasets
    assert len(datasets["contact/map"]) == 2


def test_a_pad_that_is_not_named_has_no_form_and_one_that_is_not_stored_no_dataset(table, built):
    without = scene(table)
    del without["obstacle"]["pad"]
    assert forms(without) < forms(scene(table))
    states, _ = built("planar", scene(table, tendons=table["tendons"][:1]))
    assert "pad_pressure" not in quantities(states)


def test_tip_and_contact_force_alone_store_no_field_and_a_small_model(table, built):
    states, datasets = built("tip", scene(table, sampling={"store": [], "lines": 12}))
    assert not {"displacement", "displacement_jacobian"} & quantities(states)
    assert not any(name.startswith(("displacement", "nodes")) for name in datasets)
    assert states.path.with_suffix(".h5").stat().st_size < 200_000
