"""An accuracy, a budget or a preset chooses mesh and lines of states from the measured front."""

import copy
import json
import subprocess
import tomllib

import pytest
from farm import ROOT, command

from fingerfem.scene.presets import front
from fingerfem.scene.scene import Scene
from fingerfem.scene.toml_file import load_scene
from studies.sets import as_toml

ERRORS = [one["contact_force"] for one in front()]
COSTS = [one["core_seconds"] for one in front()]
LOAD = {"force": 5.0}


@pytest.fixture
def open_table(table):
    """The draft scene without what an accuracy chooses: mesh and sampling."""
    found = copy.deepcopy(table)
    for part in ("mesh", "sampling"):
        found.pop(part, None)
    return found


@pytest.fixture
def pressed(open_table):
    """The same finger with a load in place of the plane."""
    return {key: value for key, value in open_table.items() if key != "obstacle"} | {"load": LOAD}


def share(value: float) -> str:
    return f"{100 * value:.12f} %"


@pytest.mark.parametrize("k", range(len(COSTS)))
def test_a_budget_takes_the_most_accurate_that_keeps_it(pressed, k):
    scene = Scene.model_validate(pressed | {"budget": f"{COSTS[k] * 1.000001:.6f}s"})
    least = min(one["contact_force"] for one in front() if one["core_seconds"] <= COSTS[k] * 1.000001)
    assert scene.expected.error == least and scene.expected.core_seconds <= COSTS[k] * 1.00001


@pytest.mark.parametrize("sampling", [{}, {"tension_nodes": 5, "store": []}])
def test_without_a_load_the_mesh_alone_is_chosen_and_the_sampling_is_the_scene_s(open_table, pressed, sampling):
    kept = {"sampling": sampling} if sampling else {}
    for choice in ({"preset": "standard"}, {"accuracy": "1 %"}, {"budget": "4min"}):
        scene, rods = (Scene.model_validate(one | choice) for one in (open_table | kept, pressed))
        assert scene.mesh == rods.mesh and scene.coarse is None
        assert scene.sampling == Scene.model_validate(open_table | {"mesh": {"cells": [20, 5]}} | kept).sampling
        expected = scene.expected
        assert expected.quantity == "contact_force" and expected.error == rods.expected.error
        assert expected.core_seconds is None and expected.states is None
        assert str(expected) == "of rod elements on this mesh: " + str(rods.expected).rsplit(", ", 2)[0]
    free = {key: value for key, value in open_table.items() if key != "obstacle"} | {"preset": "standard"}
    assert Scene.model_validate(free).expected.quantity == "displacement"


def test_a_scene_that_an_older_version_described_is_read(open_table):
    """Its set and its model keep more of what was expected."""
    scene = Scene.model_validate(open_table | {"preset": "draft"}).model_dump()
    scene["expected"] |= {"error_of_mesh": None, "tolerance": 3e-4, "core_seconds": 30.0, "states": 366}
    scene["sampling"]["lines"] = 40
    assert Scene.model_validate(scene).expected.states == 366


def test_presets_go_from_cheap_to_accurate_and_nothing_on_the_front_is_beaten(pressed):
    found = [Scene.model_validate(pressed | {"preset": name}).expected for name in ("draft", "standard", "fine")]
    assert [one.core_seconds for one in found] == sorted({one.core_seconds for one in found})
    assert [one.error for one in found] == sorted({one.error for one in found}, reverse=True)
    plain = [one for one in front() if not one["preset"]]
    for one in plain:
        assert not any(
            other["core_seconds"] <= one["core_seconds"] and other["contact_force"] <= one["contact_force"]
            for other in plain
            if other is not one
        )


def pulled_by(table: dict, count: int) -> dict:
    """A scene with a load and so many tendons, which fit the draft mesh."""
    offsets = [[y, z] for y in (0.004, 0.0, -0.004) for z in (0.0, 0.004, -0.004) if y or z][:count]
    tendons = [{**table["tendons"][0], "name": f"F{k}", "offset": one} for k, one in enumerate(offsets)]
    return {key: value for key, value in table.items() if key != "obstacle"} | {"tendons": tendons, "load": LOAD}


def test_more_tendons_get_lines_for_the_products_that_they_add(open_table):
    """Laws of t tensions are polynomials of t + 6 variables."""
    fitted = [Scene.model_validate(pulled_by(open_table, count) | {"preset": "draft"}) for count in range(1, 9)]
    lines = [one.sampling.lines for one in fitted]
    assert lines == [4, 8, 16, 32, 40, 48, 56, 64]
    assert all(one.on_coarse_mesh().sampling.lines == one.sampling.lines for one in fitted)
    costs = [one.expected.core_seconds for one in fitted]
    assert costs == sorted(costs)


def test_an_error_is_promised_up_to_the_number_of_tendons_that_it_was_measured_with(open_table):
    for count in range(1, 9):
        pulled = pulled_by(open_table, count)
        expected = Scene.model_validate(pulled | {"preset": "standard"}).expected
        assert (expected.error is None) == (count > 4)
        assert ("no error of the contact force is promised" in str(expected)) == (count > 4)
        if count > 4:
            assert Scene.model_validate(pulled | {"budget": "5h"}).expected.error is None
            with pytest.raises(ValueError, match="accuracy must be left out with more than 4 tendons"):
                Scene.model_validate(pulled | {"accuracy": "5 %"})


@pytest.mark.parametrize(
    ("more", "named"),
    [
        ({"material": {"law": "yeoh", "C1": 1e5, "D1": 4e-7}}, 'material.law = "yeoh"'),
        ({"gravity": {"direction": [-1, 0, 0], "density": 1080.0}}, "gravity"),
    ],
)
def test_no_error_is_promised_for_other_rubber_or_with_weight(open_table, more, named):
    table = open_table | more
    assert Scene.model_validate(table | {"preset": "standard"}).expected.error is None
    with pytest.raises(ValueError, match=f"accuracy must be left out with {named}"):
        Scene.model_validate(table | {"accuracy": "5 %"})


def test_other_fingers_get_cells_of_the_same_shape_and_as_many_lines_a_tension(pressed):
    usual = Scene.model_validate(pressed | {"preset": "standard"})
    longer = pressed | {"geometry": pressed["geometry"] | {"segments": [0.1]}, "preset": "standard"}
    twice = Scene.model_validate(longer)
    assert twice.mesh.cells == [2 * usual.mesh.cells[0], usual.mesh.cells[1]]
    assert twice.expected.core_seconds == pytest.approx(2 * usual.expected.core_seconds)
    single = Scene.model_validate(pressed | {"tendons": pressed["tendons"][:1], "preset": "standard"})
    assert single.sampling.lines == round(usual.sampling.lines / 2)


@pytest.mark.parametrize("name", ["two_segments", "four_tendons", "one_segment", "free"])
@pytest.mark.parametrize("preset", ["draft", "standard", "fine"])
def test_a_preset_fits_every_finger_that_is_shipped_and_its_cost_grows_with_its_cells(name, preset):
    shipped = tomllib.loads((ROOT / "scenes" / f"{name}.toml").read_text())
    del shipped["mesh"]
    plain = {key: value for key, value in shipped.items() if key not in ("sampling", "obstacle")}
    scene = Scene.model_validate(plain | {"preset": preset, "load": LOAD})
    (one,) = (one for one in front() if one["preset"] == preset)
    (along, across), bodies = scene.mesh.cells, len(scene.geometry.segments)
    assert across >= one["cells"][1]
    cells = along * across**2 * bodies / (one["cells"][0] * one["cells"][1] ** 2)
    lines = scene.sampling.lines / (2 * one["lines"])
    assert scene.expected.core_seconds == pytest.approx(one["core_seconds"] * cells * lines)
    assert Scene.model_validate(shipped | {"preset": preset}).mesh.order == one["order"]


@pytest.mark.parametrize("slenderness", [1.0, 4.9, 5.1, 5.2, 7.3, 33.0])
def test_every_choice_fits_fingers_of_any_length(open_table, slenderness):
    found = open_table | {"geometry": open_table["geometry"] | {"segments": [slenderness * 0.010]}}
    found["obstacle"] = {"distance": [0.001, 0.031], "method": "penalty"}
    for error in ERRORS:
        scene = Scene.model_validate(found | {"accuracy": share(error * 1.000001)})
        assert scene.expected.error <= error * 1.000001


def test_what_was_chosen_is_kept_and_is_no_other_finger(open_table):
    scene = Scene.model_validate(open_table | {"preset": "draft"})
    again = Scene.model_validate(json.loads(scene.model_dump_json()))
    assert again == scene
    plain = Scene.model_validate(open_table | {"mesh": scene.mesh.model_dump()})
    assert plain.fingerprint() == scene.fingerprint() and plain.expected is None


BROKEN = {
    "of two": ('preset = "draft"\nbudget = "1h"\n', "", "preset must be left out where budget is given"),
    "beside a mesh": ('preset = "draft"\n', "[mesh]\ncells = [20, 5]\n", "mesh.cells must be left out where preset"),
    "beside lines": ('preset = "draft"\n', "[sampling]\nlines = 9\n", "sampling.lines must be left out where preset"),
    "unknown": ('preset = "quick"\n', "", "preset must be one of draft, standard, fine, got 'quick'"),
    "too accurate": ('accuracy = "0.000001 %"\n', "", 'the best measured, got "0.000001 %"'),
    "no share": ("accuracy = 0.01\n", "", "accuracy must be a share"),
    "nothing": ('accuracy = "0 %"\n', "", "accuracy must be a share"),
    "too small": ('budget = "1s"\n', "", "budget must be at least"),
    "a list": ('preset = ["draft"]\n', "", "preset must be one of draft, standard, fine, got ['draft']"),
    "no table": ('preset = "draft"\nmesh = 3\n', "", "mesh "),
    "by hand": ("", "[expected]\nerror = 0.0\n", "expected must be left out where no accuracy or budget or preset"),
    "no time": ('budget = "soon"\n', "", "budget must be a time such as 90s, 30min or 2h, got 'soon'"),
}


@pytest.mark.parametrize("case", BROKEN)
def test_a_choice_that_cannot_be_made_is_refused_in_one_line(case, pressed, tmp_path):
    head, tail, words = BROKEN[case]
    file = tmp_path / "scene.toml"
    file.write_text(head + as_toml(pressed) + tail)
    with pytest.raises(ValueError) as refused:
        load_scene(file)
    assert words in str(refused.value) and "\n" not in str(refused.value)


@pytest.mark.parametrize("side", ["nan", "inf", "0.0", "-0.01", "1e-300", '"1 cm"'])
def test_a_finger_that_is_none_is_refused_as_such(side, open_table, tmp_path):
    file = tmp_path / "scene.toml"
    file.write_text('preset = "draft"\n' + as_toml(open_table).replace("side = 0.01", f"side = {side}"))
    with pytest.raises(ValueError, match=r"geometry\.side") as refused:
        load_scene(file)
    assert "\n" not in str(refused.value)


@pytest.mark.long
def test_the_command_says_what_is_expected(pressed, tmp_path):
    file = tmp_path / "scene.toml"
    file.write_text('preset = "draft"\n' + as_toml(pressed))
    line = command(2, file, tmp_path / "set", "--coarse", "--budget", "0.1s")
    done = subprocess.run(line, cwd=ROOT, capture_output=True, text=True)
    assert done.returncode == 0 and f"expected: {load_scene(file).expected}" in done.stderr, done.stderr
