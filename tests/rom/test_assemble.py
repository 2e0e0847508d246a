"""rom assemble: the finger of a scene from the elements of another, which the other commands take."""

import json

import numpy as np
import pytest
from terminal import ROOT, ran

from rom import Rod

DRAFT = (ROOT / "scenes" / "draft.toml").read_text()


def scene(folder, *changes: tuple[str, str]):
    """The draft finger's scene with lines replaced."""
    text = DRAFT
    for before, after in changes:
        assert before in text
        text = text.replace(before, after)
    (folder / "scene.toml").write_text(text)
    return folder / "scene.toml"


TWO = ("segments = [0.050]", "segments = [0.040, 0.060]"), ("segment = 1", "segment = 2")


def test_two_segments_are_assembled_and_hold_a_force(tmp_path):
    file = tmp_path / "two.h5"
    done = ran("rom", "assemble", scene(tmp_path, *TWO), "rom/finger.h5", "-o", file, "--json")
    assert done.returncode == 0, done.stderr
    found = json.loads(done.stdout)
    lengths = [sum(one["length_m"] for one in own) for own in found["segments"]]
    assert lengths == pytest.approx([0.0395, 0.0595]) and found["size"] == found["modulus"] == 1.0
    assert Rod.load(file).scene["geometry"]["segments"] == [0.040, 0.060]
    found = json.loads(ran("rom", "info", file, "--json").stdout)
    assert len(found["segments"]) == 2 and found["accuracy"].startswith("not measured")
    held = ran("control", "hold", file, "--distance", "0.01", "--contact-force", "0.05", "--json")
    assert json.loads(held.stdout)["status"] == "converged"


def test_a_softer_and_larger_finger_is_the_bundled_one_at_its_scale(tmp_path):
    """Twice as large, of a tenth of the modulus: forces are 0.4 times as large."""
    numbers = ("side = 0.010", "side = 0.020"), ("segments = [0.050]", "segments = [0.100]"), ("0.001 ", "0.002 ")
    material = ("C1 = 1.9e6", "C1 = 1.9e5"), ("D1 = 2.43e-7", "D1 = 2.43e-6")
    tendons = ("0.004, 0.0]", "0.008, 0.0]"), ("0.0, 0.004]", "0.0, 0.008]"), ("[0.0, 100.0]", "[0.0, 40.0]")
    file, known = tmp_path / "large.h5", Rod.load(ROOT / "rom" / "finger.h5")
    done = ran("rom", "assemble", scene(tmp_path, *numbers, *material, *tendons), "rom/finger.h5", "-o", file)
    assert done.returncode == 0, done.stderr
    large, small = Rod.load(file).place([16.0, 4.0]), known.place([40.0, 10.0])
    np.testing.assert_allclose(large.centres, 2 * small.centres, rtol=1e-9)


def test_a_tapered_finger_is_assembled_and_holds_a_force(tmp_path):
    file, taper = tmp_path / "tapered.h5", ("plate = 0.001 ", "taper = [0.7]\nplate = 0.001 ")
    done = ran("rom", "assemble", scene(tmp_path, taper, ("[0.0, 100.0]", "[0.0, 49.0]")), "rom/finger.h5", "-o", file)
    assert done.returncode == 0, done.stderr
    assert Rod.load(file).scene["geometry"]["taper"] == [0.7]
    assert Rod.load(file).half_lengths == pytest.approx([0.00035, 0.0035, 0.0035])
    held = ran("control", "hold", file, "--distance", "0.01", "--contact-force", "0.05", "--json")
    assert json.loads(held.stdout)["status"] == "converged"


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ([("plate = 0.001 ", "taper = [0.7]\nplate = 0.001 ")], "F1.tension must lie in 0 to 49 N, where the elements"),
        ([("segments = [0.050]", "segments = [0.015]")], "geometry.segments.0: segment must be at least 0.02"),
        ([("side = 0.010", "side = 0.0")], "geometry.side must be finite and above 0 m, got 0.0"),
        ([TWO[0]], "tendons must pass all segments, one at least of segment 2, got 1"),
        ([("[geometry]", "[nothing]")], "geometry must be given, got None"),
    ],
)
def test_a_scene_that_the_elements_cannot_make_is_refused_in_one_line(tmp_path, changes, message):
    done = ran("rom", "assemble", scene(tmp_path, *changes), "rom/finger.h5", "-o", tmp_path / "finger.h5")
    (line,) = done.stderr.splitlines()
    assert done.returncode == 2 and message in line and not (tmp_path / "finger.h5").exists()
