"""The bundled fingers: rods of elements."""

from pathlib import Path

import pytest

from rom import TouchedSegment
from rom.bundled import FINGERS, file_of
from rom.rod.scene.scene_of_rod import read_scene
from rom.rod.touched_segment import SHIPPED

MAKEFILE = Path(__file__).resolve().parents[2] / "Makefile"


def test_it_is_small_enough_to_track_and_made_by_a_command():
    assert SHIPPED.stat().st_size < 500_000
    text = MAKEFILE.read_text()
    assert "-o rom/finger.h5" in text[text.index("\nmodel:\n") :].split("\n\n")[0]


def test_the_finger_is_better_than_its_mesh_and_was_measured_on_held_out_states(model):
    left_out, measured = model.rod.elements.provenance["left_out"], model.rod.accuracy
    assert model.scene["mesh"]["cells"] == [24, 6] and model.scene["mesh"]["order"] == 2
    assert left_out["contact_force"]["p95"] < 0.02 and left_out["free_place_m"]["p95"] < 5e-5
    assert measured["contact_force"]["median"] < 0.005 and measured["contact_force"]["p95"] < 0.02
    answer = model.evaluate([50.0, 20.0, 0.010])
    assert all(error > 0 for error in answer.error.values())


def test_the_finger_is_made_of_clamp_interior_elements_and_plate(model):
    (own,) = model.rod.pieces
    assert [one.kind for one in own[:: len(own) - 1]] == ["plate", "clamp"]
    assert len(own) > 2 and {one.kind for one in own[1:-1]} == {"interior"}
    assert sum(one.length for one in own) == pytest.approx(model.rod.rest[0])


@pytest.mark.parametrize("name", FINGERS)
def test_a_bundled_finger_is_small_enough_to_track_and_predicts_what_was_left_out(name):
    assert file_of(name).stat().st_size < 1_000_000
    rod = TouchedSegment.load(name).rod
    left_out = rod.elements.provenance["left_out"]
    assert left_out["contact_force"]["p95"] < 0.02 and left_out["free_place_m"]["p95"] < 2e-3 * rod.rest[0]


@pytest.mark.parametrize("name", sorted(FINGERS.keys() - {"finger"}))
def test_the_silicone_fingers_are_those_of_their_scenes_and_weigh(name):
    rod = TouchedSegment.load(name).rod
    scene = read_scene(MAKEFILE.parent / "scenes" / "silicone" / f"{name}.toml")
    assert rod.scene == rod.assembled(scene).scene and rod.elements.scene["material"]["law"] == "yeoh"
    hanging, level = (one.place([0.0] * 4).centres[-1] for one in (rod, rod.with_gravity([0.0, -1.0, 0.0])))
    assert hanging[0] > rod.rest[0] and level[1] < -1e-3
