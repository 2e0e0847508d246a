"""A scene pays only for what it names: counted in forms, unknowns, axes and quantities."""

import copy
import dataclasses
from collections.abc import Callable
from typing import Any

import pytest
from dolfinx import fem
from farm import run

from fingerfem import FingerModel
from fingerfem.scene.scene import Scene
from rom.dataset.snapshot_set import SnapshotSet, read_task
from studies.sets import as_toml

SMALL = {"mesh": {"cells": [10, 5], "order": 1}}


@pytest.fixture(scope="module")
def solved(tmp_path_factory) -> Callable[[dict], SnapshotSet]:
    """Tables of scenes -> held-out states of them."""

    def solve(scene: dict) -> SnapshotSet:
        folder = tmp_path_factory.mktemp("required")
        (folder / "scene.toml").write_text(as_toml(scene))
        run(1, folder / "scene.toml", folder / "set", "--random", "1")
        return SnapshotSet(folder / "set")

    return solve


def scene(table: dict, **parts) -> dict:
    found = copy.deepcopy(table) | SMALL
    for name, value in parts.items():
        if value is None:
            del found[name]
        else:
            found[name] = value
    return found


def quantities(found: SnapshotSet) -> set[str]:
    return set(read_task(found.path, "random-0"))


def forms_of(model: Any) -> int:
    """Compiled forms in what a model holds."""
    if isinstance(model, fem.Form):
        return 1
    if isinstance(model, list):
        return sum(map(forms_of, model))
    if dataclasses.is_dataclass(model):
        return sum(forms_of(getattr(model, field.name)) for field in dataclasses.fields(model))
    return 0


def forms(table: dict) -> int:
    return forms_of(FingerModel(Scene.model_validate(table)).problem.forms)


def test_without_a_plane_there_are_no_contact_forms_no_axis_and_no_quantity_of_it(table, solved):
    plain, free = scene(table), scene(table, obstacle=None)
    assert forms(free) < forms(plain)
    states = solved(free)
    assert [one["name"] for one in states.description.parameters] == ["F1", "F2"]
    assert not {"contact_force", "touch_distance", "pad_pressure"} & quantities(states)


def test_a_tendon_that_is_not_named_has_no_axis_and_a_planar_pull_half_the_mesh(table, solved):
    planar = scene(table, tendons=table["tendons"][:1])
    whole, half = (FingerModel(Scene.model_validate(one)) for one in (scene(table), planar))
    assert half.problem.unknowns < 0.7 * whole.problem.unknowns
    states = solved(planar)
    assert [one["name"] for one in states.description.parameters] == ["F1", "d"]
    assert "contact_force" in quantities(states)


@pytest.mark.long
def test_a_pad_that_is_not_named_has_no_form_and_one_that_is_not_stored_no_quantity(table, solved):
    without = scene(table)
    del without["obstacle"]["pad"]
    assert forms(without) < forms(scene(table))
    assert "pad_pressure" not in quantities(solved(scene(table)))
    assert "pad_pressure" in quantities(solved(scene(table, sampling={"store": ["pad_pressure"]})))


@pytest.mark.long
def test_tip_and_contact_force_alone_store_no_field(table, solved):
    states = solved(scene(table, sampling={"store": []}))
    assert {"tip", "contact_force"} < quantities(states)
    assert not {"displacement", "displacement_jacobian"} & quantities(states)
    assert "displacement" in quantities(solved(scene(table, sampling={"store": ["displacement"]})))
