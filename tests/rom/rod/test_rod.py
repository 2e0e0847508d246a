"""Fingers assembled from the elements of one: other lengths, sizes, moduli, segments, tendons; and what is refused."""

from dataclasses import replace

import numpy as np
import pytest

from rom.files.checked_file import ModelError
from rom.rod.rod import Rod
from rom.separated.model import SeparatedModel
from tests.rom.elements import elastic_rod

LENGTHS = (0.021, 0.025, 0.040, 0.063, 0.080, 0.120)  # [m]


@pytest.mark.parametrize("length", LENGTHS)
def test_a_finger_of_another_length_is_the_rod_of_that_length(finger, length):
    inputs = elastic_rod.pressed(12, 5)
    inputs *= 0.5 * min(1.0, 0.050 / length)
    centres, rotations, inside = elastic_rod.placed(finger.assembled(elastic_rod.scene(length)), inputs)
    places, turned, _ = elastic_rod.in_space(inputs, length)
    assert inside.all()
    np.testing.assert_allclose(centres, places[:, -1], atol=1e-6)
    np.testing.assert_allclose(rotations, turned[:, -1], atol=3e-5)


def test_two_segments_are_one_after_the_other_and_the_first_transmits_the_second_ones_wrench(finger):
    scene = elastic_rod.scene()
    scene["geometry"] = scene["geometry"] | {"segments": [0.040, 0.060]}
    scene["tendons"] = [one | {"segment": k + 1} for k, one in enumerate(scene["tendons"])]
    both = finger.assembled(scene)
    tensions = np.array([12.0, 7.0])
    wrenches = np.array([[0.1, -0.2, 0.1, 1e-3, 2e-3, 0], [0.1, 0.2, -0.1, 0, 1e-3, 2e-3]])
    found = both.place(tensions, wrenches)
    tip, turned = elastic_rod.plate(np.array([0.0, 7.0]), wrenches[1], 0.060)
    # The wrench on the tip's plate, in the frame of the plate that clamps it and about that one's centre.
    arm, force = tip + np.array([elastic_rod.PLATE / 2, 0, 0]), turned @ wrenches[1, :3]
    carried = wrenches[0] + np.concatenate([force, turned @ wrenches[1, 3:] + np.cross(arm, force)])
    centre, frame = elastic_rod.plate(tensions, carried, 0.040)
    np.testing.assert_allclose(found.centres, [centre, centre + frame @ arm], atol=1e-6)
    np.testing.assert_allclose(found.rotations, [frame, frame @ turned], atol=3e-5)


def test_tendons_at_one_place_pull_by_the_sum_of_their_tensions(finger):
    """One ends at the first of two plates, the other at the second."""
    scene = elastic_rod.in_series(0.040, 0.060)
    first, beside = scene["tendons"]
    ends = [first | {"name": f"G{k}", "segment": k, "tension": [0.0, 20.0]} for k in (1, 2)]
    found = finger.assembled(scene | {"tendons": [*ends, beside]}).place([11.0, 5.0, 3.0])
    base, frame = elastic_rod.plate(np.array([16.0, 3.0]), np.zeros(6), 0.040)
    tip, _ = elastic_rod.plate(np.array([5.0, 3.0]), np.zeros(6), 0.060)
    np.testing.assert_allclose(found.centres[0], base, atol=1e-6)
    np.testing.assert_allclose(
        found.centres[1], base + frame @ (tip + np.array([elastic_rod.PLATE / 2, 0, 0])), atol=1e-6
    )


def test_a_tendon_that_is_left_out_must_have_been_trained_from_0_newton(finger):
    trained = elastic_rod.scene()
    trained["tendons"][1]["tension"] = [5.0, elastic_rod.MOST_TENSION]
    own = replace(finger, elements=replace(finger.elements, scene=trained), scene=trained)
    with pytest.raises(ModelError, match=r"segment 1 must lie in 5 to 40 N, .*, got 0 to 0 N of no tendon"):
        own.assembled(trained | {"tendons": trained["tendons"][:1]})


@pytest.mark.parametrize("size", [0.3, 2.0, 6.0])
@pytest.mark.parametrize("modulus", [0.01, 0.1, 10.0])
def test_a_finger_of_another_size_and_modulus_is_similar(finger, size, modulus):
    force, scene = modulus * size**2, elastic_rod.similar(size, modulus)
    inputs = elastic_rod.pressed(4, 9)
    one = elastic_rod.placed(finger, inputs)
    two = elastic_rod.placed(finger.assembled(scene), inputs * np.repeat([force, force * size], [5, 3]))
    np.testing.assert_allclose(two[0], size * one[0], rtol=0, atol=1e-13 * size)
    np.testing.assert_allclose(two[1], one[1], atol=1e-12)
    np.testing.assert_array_equal(one[2], two[2])


def _changed(path: str, value):
    scene = elastic_rod.scene()
    table, keys = scene, path.split(".")
    for key in keys[:-1]:
        table = table[int(key)] if key.isdigit() else table[key]
    table[int(keys[-1]) if keys[-1].isdigit() else keys[-1]] = value
    return scene


WRONG = {
    "plate": ("geometry.plate", 0.002, "geometry.plate over geometry.side must be 0.1, as .* got 0.2"),
    "channel": ("geometry.channel", 0.001, "geometry.channel over geometry.side must be 0.2, .* got 0.1"),
    "short": ("geometry.segments", [0.020], "geometry.segments.0: segment must be at least 0.0205 m .* got 0.0195"),
    "no segment": ("geometry.segments", [], "geometry.segments must be at least one and at most 8, got 0"),
    "law": ("material.law", "mooney-rivlin", "material.law must be neo-hookean, .* got mooney-rivlin"),
    "Poisson's ratio": ("material.D1", 1e-9, r"material.D1 \(with C1 = .*\) must be .*, got 1e-09"),
    "offset": ("tendons.0.offset", [0.003, 0.0], r"tendons.F1.offset must be .* one of \[0.004, 0.0\], \[0.0"),
    "tension": ("tendons.1.tension", [0.0, 90.0], r"tendons.F2.tension must lie in 0 to 40 N, .* got \[0.0, 90.0\]"),
    "one place twice": (
        "tendons.1.offset",
        [0.004, 0.0],
        r"tensions at offset \[0.004, 0.0\] in segment 1 must lie in 0 to 40 N, .*, got 0 to 80 N of F1 and F2",
    ),
    "a segment without tendon": (
        "geometry.segments",
        [0.050, 0.050],
        "tendons must pass all segments, one at least of segment 2, got 1",
    ),
    "a length that is none": ("geometry.plate", float("nan"), "geometry.plate must be finite and above 0 m, got nan"),
    "a modulus that is none": ("material.C1", "soft", "material.C1 must be a finite number, got 'soft'"),
    "a negative modulus": ("material.C1", -1.0, "material.C1 must be above 0, got -1"),
    "far too long": ("geometry.segments", [1e6], "geometry.segments.0: segment must be at most .* m long"),
    "plate of a tendon": ("tendons.1.segment", 2, "tendons.F2.segment must be from 1 to 1, got 2"),
    "one name twice": ("tendons.1.name", "F1", "tendons and chambers must have names of their own, got F1, F1"),
}


@pytest.mark.parametrize("path, value, message", WRONG.values(), ids=WRONG)
def test_a_finger_that_the_elements_cannot_make_is_refused_with_what_is_missing(finger, path, value, message):
    with pytest.raises(ModelError, match=message):
        finger.assembled(_changed(path, value))


def test_a_scene_without_a_key_is_refused_with_its_name(finger):
    scene = _changed("name", "short of a side")
    del scene["geometry"]["side"]
    with pytest.raises(ModelError, match=r"^side is required in a table of the scene, and missing$"):
        finger.assembled(scene)


def test_inputs_beyond_what_was_trained_are_not_inside(finger):
    assert finger.place([40.0, 0.0]).inside
    assert not finger.place([41.0, 0.0]).inside
    wrench = np.zeros((1, 6))
    wrench[0, 1] = 1.2 * elastic_rod.MOST_FORCE
    assert not finger.place([10.0, 0.0], wrench).inside


def test_a_finger_read_from_its_file_is_the_same(finger, tmp_path):
    other = finger.assembled(elastic_rod.scene(0.073))
    other.save(tmp_path / "finger.h5")
    read = Rod.load(tmp_path / "finger.h5")
    inputs = elastic_rod.pressed(3, 2)
    for one, two in zip(*(elastic_rod.placed(rod, inputs) for rod in (other, read)), strict=True):
        np.testing.assert_array_equal(one, two)
    assert read.scene == other.scene and read.elements.provenance == other.elements.provenance
    with pytest.raises(ModelError, match="must be a fingerfem separated model, got a fingerfem rod"):
        SeparatedModel.load(tmp_path / "finger.h5")


def test_a_damaged_file_is_refused(finger, tmp_path):
    file = tmp_path / "finger.h5"
    finger.save(file)
    damaged = bytearray(file.read_bytes())
    damaged[-100] ^= 1
    file.write_bytes(damaged)
    with pytest.raises(ModelError, match="damaged"):
        Rod.load(file)


def test_a_scene_file_is_read_and_a_broken_one_refused(finger, tmp_path):
    file = tmp_path / "scene.toml"
    file.write_text("name = 'x'\n[geometry]\nside = 0.01\n")
    with pytest.raises(ModelError, match=r"scene\.toml: material must be given, got None"):
        finger.assembled(file)
    file.write_text("not TOML")
    with pytest.raises(ModelError, match=r"scene\.toml: must be a scene in TOML, got "):
        finger.assembled(file)
