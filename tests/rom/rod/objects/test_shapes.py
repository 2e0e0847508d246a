"""Numbers of rigid objects: unit vectors, a box's sides, and what is refused."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from rom import Cylinder, Hull, Plane, Sphere, box
from rom.rod.objects.shapes import facing_plane

PARTS = st.tuples(*[st.floats(-1, 1)] * 3).filter(lambda one: max(map(abs, one)) > 1e-3)


@given(PARTS, PARTS, st.sampled_from([1e-300, 1e-160, 1.0, 1e160, 1e300]))
def test_directions_normals_and_axes_are_unit_vectors_of_the_same_way_at_any_length(direction, axis, scale):
    longer = {"centre": (0, 0, 0), "direction": tuple(scale * part for part in direction)}
    own = tuple(scale * part for part in axis)
    for one in (Cylinder(**longer, axis=own, radius=1.0), Plane(**longer, normal=own)):
        for name, wanted in (("direction", direction), ("axis", axis)):
            assert one.numbers()[name] == pytest.approx(np.array(wanted) / np.linalg.norm(wanted), abs=1e-12)


@given(
    st.tuples(*[st.floats(0.002, 0.05)] * 3),
    st.tuples(*[st.floats(-3, 3)] * 3),
    st.floats(1e-6, 0.9),
    st.integers(0, 2),
)
def test_a_box_reaches_as_far_as_its_sides_say_rounded_edges_included(sides, rotation, share, axis):
    rounding = share * min(sides) / 2
    hull = box(centre=(0, 0, 0), direction=(0, 1, 0), sides=sides, rotation=rotation, rounding=rounding)
    normal = Rotation.from_rotvec(rotation).as_matrix()[:, axis]
    reach = np.asarray(hull.vertices) @ normal
    assert reach.max() + rounding == pytest.approx(sides[axis] / 2) and reach.min() == pytest.approx(-reach.max())
    assert hull.numbers()["corners"] == 8 and hull.numbers()["radius"] == rounding


def test_the_facing_plane_is_the_finger_s_face_at_no_distance():
    plane = facing_plane(0.012, (0.001, 0.03))
    numbers = plane.numbers()
    assert np.array(numbers["centre"]) @ numbers["direction"] == pytest.approx(0.006)
    assert numbers["axis"] == [-one for one in numbers["direction"]]
    assert (numbers["nearest"], numbers["farthest"]) == (0.001, 0.03)


WHERE = {"centre": (0, 0, 0), "direction": (0, 1, 0)}
CUBE = [(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]


@pytest.mark.parametrize(
    ("shape", "own", "message"),
    [
        (Sphere, {"radius": 0.01, "centre": (0, np.nan, 0)}, "centre must be finite"),
        (Sphere, {"radius": 0.01, "distances": (0.0, np.inf)}, "distances must be finite"),
        (Sphere, {"radius": 0.01, "direction": (0, 0, 0)}, "direction must be a vector of some length"),
        (Sphere, {"radius": -1e-3}, "radius must be above 0 m, got -0.001"),
        (Sphere, {"radius": 0.0}, "radius must be above 0 m"),
        (Plane, {"normal": (0, 0, np.inf)}, "normal must be finite"),
        (Plane, {"normal": (0, 0, 0)}, "normal must be a vector of some length"),
        (Cylinder, {"radius": 0.01, "axis": (0, 0, 0)}, "axis must be a vector of some length"),
        (Hull, {"vertices": CUBE[:3]}, "vertices"),
        (Hull, {"vertices": [(0, 0)]}, "vertices"),
        (Hull, {"vertices": CUBE, "rounding": 0.0}, "rounding"),
        (box, {"sides": (0.01, 0.002, 0.01), "rounding": 0.001}, "rounding must be below half the shortest side, "),
        (box, {"sides": (0.01, np.nan, 0.01)}, "sides must be three finite numbers"),
        (box, {"sides": (0.01,) * 3, "rotation": (0, np.nan, 0)}, "rotation must be three finite numbers"),
    ],
)
def test_what_is_not_finite_or_has_no_length_is_refused_by_its_name(shape, own, message):
    with pytest.raises(ValueError, match=message):
        shape(**WHERE | own)
