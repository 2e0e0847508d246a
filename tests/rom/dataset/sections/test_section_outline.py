"""Outlines of sections: areas, supports and points by closed forms; what is no convex outline is refused."""

import h5py
import numpy as np
import pytest

from rom.dataset.sections.section_outline import SectionOutline
from rom.files.checked_file import ModelError

HEXAGON = np.array([[np.cos(a), np.sin(a)] for a in np.pi / 3 * np.arange(6)]) * 0.01
OUTLINES = {
    "circle": SectionOutline.circle(0.01),
    "rectangle": SectionOutline.rectangle(0.01, 0.004),
    "stadium": SectionOutline(vertices=[[-0.006, 0.0], [0.006, 0.0]], radius=0.004),
    "rounded": SectionOutline(vertices=[[-0.006, -0.002], [0.007, -0.001], [0.0, 0.005]], radius=0.002),
    "hexagon": SectionOutline.hull(np.vstack([HEXAGON, HEXAGON / 2, (HEXAGON + np.roll(HEXAGON, 1, axis=0)) / 2])),
}


@pytest.fixture(params=OUTLINES)
def outline(request) -> SectionOutline:
    return OUTLINES[request.param]


def test_points_enclose_the_area_along_the_perimeter(outline):
    points = outline.points(20000)
    following = np.roll(points, -1, axis=0)
    lengths = np.linalg.norm(following - points, axis=1)
    assert lengths.sum() == pytest.approx(outline.perimeter, rel=1e-4)
    assert np.sum(lengths < 0.99 * lengths.max()) <= 2 * len(outline.vertices)  # equal distances, but at corners
    area = (points[:, 0] * following[:, 1] - points[:, 1] * following[:, 0]).sum() / 2
    assert area == pytest.approx(outline.area, rel=1e-4)


def test_no_point_lies_farther_in_a_direction_than_its_support(outline):
    angles = np.random.default_rng(1).uniform(0, 2 * np.pi, 100)
    directions = np.column_stack([np.cos(angles), np.sin(angles)])
    farthest = (outline.support(directions) * directions).sum(axis=1)
    heights = outline.points(20000) @ directions.T
    assert (heights.max(axis=0) <= farthest + 1e-15).all()
    assert heights.max(axis=0) == pytest.approx(farthest, rel=1e-3)
    assert np.abs(outline.points(20000)).max(axis=0) == pytest.approx(outline.box, rel=1e-3)


def test_closed_forms():
    assert OUTLINES["circle"].area == pytest.approx(np.pi * 1e-4)
    assert OUTLINES["stadium"].area == pytest.approx(0.012 * 0.008 + np.pi * 0.004**2)
    assert OUTLINES["hexagon"].area == pytest.approx(1.5 * np.sqrt(3) * 1e-4)
    assert len(OUTLINES["hexagon"].vertices) == 6
    assert [name for name, one in OUTLINES.items() if one.is_rectangle] == ["rectangle"]


def test_scaled_and_stored(outline, tmp_path):
    large = outline.scaled(3.0)
    assert large.area == pytest.approx(9 * outline.area)
    with h5py.File(tmp_path / "section.h5", "w") as file:
        outline.write(file)
        for other in (SectionOutline.read(file), SectionOutline(**outline.table())):
            assert np.array_equal(other.vertices, outline.vertices)
            assert other.radius == outline.radius


@pytest.mark.parametrize(
    ("vertices", "radius", "rule"),
    [
        (np.zeros((0, 2)), 1.0, "must have shape"),
        (np.zeros((65, 2)), 1.0, "must have shape"),
        ([[0.0, np.nan]], 1.0, "must be finite"),
        ([[0.0, 0.0]], -1.0, "must be finite"),
        ([[0.0, 0.0]], 0.0, "must be above 0"),
        ([[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]][::-1], 0.0, "counterclockwise"),
        ([[1.0, 1.0], [-1.0, 1.0], [0.0, 0.1], [-1.0, -1.0], [1.0, -1.0]], 0.0, "convex"),
        ([[2.0, 0.0]], 1.0, "enclose the axis"),
        ([[3.0, 1.0], [2.0, 1.0], [2.0, -1.0], [3.0, -1.0]], 0.5, "enclose the axis"),
    ],
)
def test_what_is_no_convex_outline_around_the_axis_is_refused(vertices, radius, rule):
    with pytest.raises(ModelError, match=rule):
        SectionOutline(vertices=np.array(vertices), radius=radius)
