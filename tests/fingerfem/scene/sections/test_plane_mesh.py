"""Plane meshes of sections: areas, moments and quality by closed forms, and what is made of them."""

import math

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from scipy.integrate import dblquad

from fingerfem.scene.sections import RUBBER, Circle, Column, PlaneMesh, Rectangle, Ring, Square, Wanted
from fingerfem.scene.sections.section import POOREST

DIAMETER, BORE, WIDTH = 0.020, 0.006, 0.003
FOUR = [(0.007, 0.0), (0.0, 0.007), (-0.007, 0.0), (0.0, -0.007)]
ACROSS = (10, 20, 40)


def wanted(offsets, across: int, width: float = WIDTH, half: bool = False, curved: bool = False) -> Wanted:
    columns = [Column(name=f"F{k}", path="channel", offset=np.array(one), tag=k) for k, one in enumerate(offsets)]
    return Wanted(columns=columns, width=width, across=across, half=half, curved=curved)


CIRCLE, RING = Circle(shape="circle", diameter=DIAMETER), Ring(shape="ring", diameter=DIAMETER, bore=BORE)


@pytest.mark.parametrize("section", [CIRCLE, RING], ids=["circle", "ring"])
def test_a_circle_s_area_is_exact_and_its_second_moments_converge_with_order_four(section):
    errors, edges = [], []
    for across in ACROSS:
        mesh = section.mesh(wanted(FOUR, across))
        assert mesh.area == pytest.approx(section.area, rel=1e-12)
        yy, zz, yz = mesh.second_moments
        assert yy == pytest.approx(zz, rel=1e-12) and abs(yz) < 1e-12 * yy
        errors.append(yy / section.second_moment - 1)
        edges.append(len(mesh.border))
    assert 0 < errors[0] < 5e-4  # the bound of the bending stiffness is ten times that
    assert np.log(errors[0] / errors[-1]) / np.log(edges[-1] / edges[0]) == pytest.approx(4, abs=0.5)


@pytest.mark.parametrize("section", [CIRCLE, RING], ids=["circle", "ring"])
def test_the_border_lies_on_circles_that_are_larger_with_order_two(section):
    grown, edges = [], []
    for across in ACROSS:
        mesh = section.mesh(wanted(FOUR, across))
        radii = np.hypot(*mesh.points[np.unique(mesh.border)].T)
        outer = radii[radii > 0.8 * DIAMETER / 2]
        assert np.ptp(outer) < 1e-12 * DIAMETER
        inner = radii[radii < 0.8 * DIAMETER / 2]
        assert len(inner) == (len(outer) if section is RING else 0)
        edges.append(len(outer))
        grown.append(outer.mean() / (DIAMETER / 2) - 1)
        assert not len(inner) or inner.mean() / (BORE / 2) - 1 == pytest.approx(grown[-1], rel=1e-9)
    assert 0 < grown[0] < 0.02
    assert np.log(grown[0] / grown[-1]) / np.log(edges[-1] / edges[0]) == pytest.approx(2, abs=0.3)


@pytest.mark.parametrize("half", [False, True])
@pytest.mark.parametrize("section", [CIRCLE, RING], ids=["circle", "ring"])
def test_a_circle_of_order_two_has_its_nodes_on_the_circle_and_an_area_that_converges_with_order_four(section, half):
    offsets, errors, edges = [(0.007, 0.0), (-0.007, 0.0)], [], []
    for across in ACROSS:
        mesh = section.mesh(wanted(offsets, across, half=half, curved=True))
        nodes, cells = mesh.of_order_2()
        radii = np.hypot(*nodes.T)
        outer = radii > (1 - 1e-9) * DIAMETER / 2
        assert radii.max() == pytest.approx(DIAMETER / 2, rel=1e-12)
        edges.append(int(outer.sum()))
        errors.append(abs(mesh.area / section.area - 1))
        assert mesh.column_centroid(0)[0] == pytest.approx(0.007, abs=1e-12)
        assert len(np.unique(cells)) == len(nodes)
        if section is RING:
            assert radii.min() == pytest.approx(BORE / 2, rel=1e-12)
    assert errors[0] < 5e-5
    assert np.log(errors[0] / errors[-1]) / np.log(edges[-1] / edges[0]) == pytest.approx(4, abs=0.6)


def test_a_channel_at_the_border_has_the_area_and_centroid_of_its_arc():
    """Between two radial lines at the angle a and two circles."""
    mesh = CIRCLE.mesh(wanted([(0.0085, 0.0)], 40, curved=True))
    points = mesh.points[np.unique(mesh.quads[mesh.tags == 0])]
    radii, angles = np.hypot(*points.T), np.arctan2(*points.T[::-1])
    inner, outer, angle = radii.min(), radii.max(), angles.max()
    chord = np.sin(np.ptp(np.unique(angles.round(9))[:2])) / np.ptp(np.unique(angles.round(9))[:2])
    area = angle * (outer**2 - chord * inner**2)
    assert outer == pytest.approx(DIAMETER / 2, rel=1e-12)
    assert mesh.column_area(0) == pytest.approx(area, rel=1e-6)


@pytest.mark.parametrize("across", [4, 5, 8, 13])
@pytest.mark.parametrize("section", [CIRCLE, RING], ids=["circle", "ring"])
def test_channels_have_their_centroids_at_the_tendons_and_nearly_the_area_of_a_square(section, across):
    mesh = section.mesh(wanted(FOUR, across))
    for k, offset in enumerate(FOUR):
        assert mesh.column_centroid(k) == pytest.approx(offset, abs=1e-12)
        assert mesh.column_area(k) == pytest.approx(WIDTH**2, rel=0.03)


def test_a_channel_on_the_axis_is_a_square():
    mesh = CIRCLE.mesh(wanted([(0.0, 0.0), (0.006, 0.0)], 6))
    assert mesh.column_area(0) == pytest.approx(WIDTH**2, rel=1e-12)
    assert mesh.column_centroid(0) == pytest.approx([0, 0], abs=1e-15)


def test_moments_are_those_of_an_integral():
    corners = np.array([[0.1, 0.2], [1.3, 0.4], [0.3, 1.1], [1.7, 1.9]])
    mesh = PlaneMesh(points=corners, quads=np.array([[0, 1, 2, 3]]), tags=np.array([RUBBER]))

    def integral(value):
        def at(t, s):
            shape = np.array([(1 - s) * (1 - t), s * (1 - t), (1 - s) * t, s * t])
            ds = np.array([-(1 - t), 1 - t, -t, t]) @ corners
            dt = np.array([-(1 - s), -s, 1 - s, s]) @ corners
            return value(*(shape @ corners)) * (ds[0] * dt[1] - ds[1] * dt[0])

        return dblquad(at, 0, 1, 0, 1, epsabs=1e-12)[0]

    area = integral(lambda y, z: 1.0)
    centre = np.array([integral(lambda y, z: y), integral(lambda y, z: z)]) / area
    assert mesh.area == pytest.approx(area, rel=1e-9)
    assert mesh.centroids[0] == pytest.approx(centre, rel=1e-9)
    about = [lambda y, z: (y - centre[0]) ** 2, lambda y, z: (z - centre[1]) ** 2]
    about.append(lambda y, z: (y - centre[0]) * (z - centre[1]))
    assert mesh.second_moments == pytest.approx([integral(one) for one in about], rel=1e-9)


def test_scaled_jacobians_of_a_rhombus_and_of_one_turned_over():
    angle = 0.4
    points = np.array([[0, 0], [1, 0], [math.cos(angle), math.sin(angle)], [1 + math.cos(angle), math.sin(angle)]])
    mesh = PlaneMesh(points=points, quads=np.array([[0, 1, 2, 3]]), tags=np.array([RUBBER]))
    over = PlaneMesh(points=points, quads=np.array([[0, 2, 1, 3]]), tags=np.array([RUBBER]))
    assert mesh.scaled_jacobians == pytest.approx([math.sin(angle)])
    assert over.scaled_jacobians == pytest.approx([-math.sin(angle)])


@pytest.mark.parametrize("section", [CIRCLE, RING, Square(side=0.02)], ids=["circle", "ring", "square"])
def test_divided_quadrilaterals_have_the_same_area_and_meet_each_other(section):
    mesh = section.mesh(wanted(FOUR, 7))
    finer = mesh.divided(3)
    assert finer.area == pytest.approx(mesh.area, rel=1e-12) and len(finer.quads) == 9 * len(mesh.quads)
    assert finer.second_moments == pytest.approx(mesh.second_moments, rel=1e-9, abs=1e-18)
    assert finer.column_area(2) == pytest.approx(mesh.column_area(2), rel=1e-12)
    assert len(finer.border) == 3 * len(mesh.border)
    # Euler: points - edges + quads = 1 less the holes
    holes = 1 if section is RING else 0
    for one in (mesh, finer):
        edges = (4 * len(one.quads) + len(one.border)) // 2
        assert len(one.points) - edges + len(one.quads) == 1 - holes
    assert finer.scaled_jacobians.min() > 0


@pytest.mark.parametrize("offsets", [[(0.007, 0.0)], [(0.0065, 0.0), (-0.007, 0.0)]])
@pytest.mark.parametrize(
    "section",
    [CIRCLE, RING, Square(side=0.02), Rectangle(shape="rectangle", height=0.02, width=0.013)],
    ids=["circle", "ring", "square", "rectangle"],
)
def test_half_a_section_is_half_of_the_whole(section, offsets):
    whole, half = section.mesh(wanted(offsets, 10)), section.mesh(wanted(offsets, 10, half=True))
    assert whole.is_mirrored and not (half.points[:, 1] < 0).any()
    assert half.area == pytest.approx(whole.area, rel=1e-12)
    for k in range(len(offsets)):
        assert half.column_area(k) == pytest.approx(whole.column_area(k), rel=1e-12)
    cut = half.points[np.unique(half.border)]
    assert len(half.quads) * 2 == len(whole.quads) and (cut[:, 1] == 0).sum() >= 4


MILLIMETRE = st.floats(3.0, 100.0).map(lambda value: 1e-3 * value)


@st.composite
def sections(draw):
    size = draw(MILLIMETRE)
    kind = draw(st.sampled_from(["circle", "ring", "rectangle"]))
    if kind == "rectangle":
        section = Rectangle(shape=kind, height=size, width=size * draw(st.floats(0.2, 5.0)))
    elif kind == "circle":
        section = Circle(shape=kind, diameter=size)
    else:
        section = Ring(shape=kind, diameter=size, bore=size * draw(st.floats(0.1, 0.95)))
    return section


@st.composite
def cases(draw):
    section = draw(sections())
    width = section.channel_width * draw(st.floats(0.2, 1.4))
    count = draw(st.integers(1, 5))
    radii = st.floats(0.0, 0.5).map(lambda share: share * section.extent)
    if draw(st.booleans()):  # as fingers are made: all alike, evenly around
        radius, first = draw(radii), draw(st.sampled_from([0.0, math.pi / 4, 0.3]))
        places = [(radius, first + 2 * math.pi * k / count) for k in range(count)]
    else:
        places = [(draw(radii), draw(st.floats(0.0, 6.28))) for _ in range(count)]
    offsets = [(r * math.cos(a), r * math.sin(a)) for r, a in places]
    return section, wanted(offsets, draw(st.integers(4, 16)), width)


REASONS = ("must fit", "thinner", "sine", "centroid", "inside the section", "outside the bore", "on the axis")


@settings(deadline=None, max_examples=300, suppress_health_check=[HealthCheck.too_slow])
@given(cases())
def test_any_section_is_meshed_well_or_refused_with_a_reason(case):
    section, asked = case
    refused = [reason for one in asked.columns if (reason := section.refusal(one, asked.width))]
    for k, one in enumerate(asked.columns):
        refused += ["apart" for other in asked.columns[:k] if not section.are_apart(one, other, asked.width)]
    if refused:
        assert all(reason == "apart" or any(known in reason for known in REASONS) for reason in refused)
        return
    try:
        mesh = section.mesh(asked)
    except ValueError as error:
        assert any(reason in str(error) for reason in REASONS), error
        return
    assert mesh.scaled_jacobians.min() >= POOREST
    assert mesh.area == pytest.approx(section.area, rel=1e-9)
    least = np.linalg.eigvalsh([mesh.second_moments[[0, 2]], mesh.second_moments[[2, 1]]])[0]
    assert least == pytest.approx(section.second_moment, rel=0.03)
    for k, one in enumerate(asked.columns):
        assert np.linalg.norm(mesh.column_centroid(k) - one.offset) <= 0.02 * asked.width
        assert mesh.column_area(k) == pytest.approx(asked.width**2, rel=0.15)
