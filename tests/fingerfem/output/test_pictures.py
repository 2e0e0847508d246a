"""Renders show tendons where they run, and a plane that nothing seems to pass, in a colour of no stress."""

from dataclasses import replace

import numpy as np
import pytest
from farm import ROOT
from matplotlib.colors import to_rgb
from PIL import Image

from fingerfem import FingerModel, load_scene
from fingerfem.output import panels
from fingerfem.output.pictures import FIELDS, Deformed, draw

CLOSE = 0.08  # colours of a PNG with 256 of them, from those that were asked for [-]


@pytest.fixture(scope="module")
def pressed(draft):
    """The draft finger, its second tendon slack, against a plane."""
    return draft.solve([50.0, 0.0], 0.005, sensitivities=False)


@pytest.fixture(scope="module")
def picture(draft, pressed, tmp_path_factory):
    """The pixels of its render, shape (height, width, 3), from 0 to 1."""
    file = tmp_path_factory.mktemp("pictures") / "pressed.png"
    draw([Deformed.of(draft, pressed)], file)
    return np.asarray(Image.open(file).convert("RGB")) / 255.0


def of_colour(picture: np.ndarray, colour: str) -> np.ndarray:
    return np.asarray(np.linalg.norm(picture - to_rgb(colour), axis=2) < CLOSE)


@pytest.mark.long
def test_a_picture_shows_finger_plates_plane_and_tendons(picture):
    assert len(np.unique(picture.reshape(-1, 3), axis=0)) > 50
    for colour, least in ((panels.PULLED, 300), (panels.OBSTACLE, 5000), (panels.PLATES, 300)):
        assert of_colour(picture, colour).sum() > least, colour


@pytest.mark.parametrize("field", FIELDS)
def test_obstacle_and_tendons_have_no_colour_of_a_field(field):
    shown = panels.colour_map(field)(np.linspace(0, 1, 256))[:, :3]
    for colour in (panels.OBSTACLE, panels.PULLED):
        assert np.linalg.norm(shown - to_rgb(colour), axis=1).min() > 0.25


def test_nothing_seems_to_pass_the_plane_and_the_corner_seems_to_touch_it(picture):
    plane = of_colour(picture, panels.OBSTACLE)
    rows = np.flatnonzero(plane.sum(axis=1) > 0.5 * picture.shape[1])  # not the legend's patch
    columns = np.flatnonzero(plane[rows].all(axis=0))
    assert len(columns) > 0.9 * np.ptp(np.flatnonzero(plane[rows[0]]))  # but for the lines that rule it
    just_below = picture[rows[-1] + 4, columns]
    touched = np.flatnonzero(just_below.min(axis=1) < 0.5)
    assert 0 < len(touched) < 0.1 * len(columns)  # the plate's corner, nothing else


def test_tendons_end_in_the_plate_as_far_from_its_centre_as_at_rest(draft, pressed):
    panel = Deformed.of(draft, pressed)
    rest = np.array([draft.scene.geometry.length - draft.scene.geometry.plate / 2, 0.0, 0.0])
    assert [line.tension for line in panel.tendons] == [50.0, 0.0]
    for path, tendon in zip(panels.tendon_paths(panel), draft.scene.tendons, strict=True):
        assert path[0] == pytest.approx([0.0, *tendon.offset], abs=1e-7)
        apart = np.linalg.norm(path[-1] - rest - pressed.tip)
        assert apart == pytest.approx(np.linalg.norm(tendon.offset), rel=1e-3)


@pytest.mark.long
def test_tendons_of_half_a_finger_are_found_on_its_plane_of_symmetry():
    """There the mesh ends."""
    model = FingerModel(load_scene(ROOT / "scenes" / "free.toml"))
    panel = Deformed.of(model, model.solve([20.0], sensitivities=False))
    assert panel.half
    (path,) = panels.tendon_paths(replace(panel, displacement=1e-3 * np.ones_like(panel.displacement)))
    assert path == pytest.approx(panel.tendons[0].points + 1e-3, abs=1e-9)


def test_the_title_says_tensions_and_d_with_units(draft, pressed):
    assert Deformed.of(draft, pressed).title == "F1 = 50 N, F2 = 0 N, d = 5 mm"


def test_a_field_that_is_not_known_is_refused(draft, pressed):
    with pytest.raises(ValueError, match="field must be one of S11, von_mises, J, got S22"):
        Deformed.of(draft, pressed, "S22")
