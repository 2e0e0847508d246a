"""Indentation of rubber (rom/native/shapes/indentation.c): Hertz's contact, and no dependence on the slices."""

import numpy as np
import pytest
from scipy.optimize import brentq, nnls
from scipy.special import ellipe, ellipk

from rom import AmongObjects, Sphere, TouchedSegment
from rom.rod.compiled.indentation import indentations
from tests.rom.rod.linear_elasticity import ball_on_edge, cylinder_across_face


def squeezed(rod, radius, depth, aside=0.0):
    """The force of two balls that press on both sides of the straight finger, which neither bends nor moves [N]."""
    middle, half = rod.rest[0] / 2 + aside, rod.half_lengths[1]
    balls = [
        Sphere(centre=(middle, way * (half + radius), 0), direction=(0, way, 0), distances=(-0.01, 0.1), radius=radius)
        for way in (1.0, -1.0)
    ]
    answer = AmongObjects(rod=rod, obstacles=balls).evaluate([0.0] * rod.elements.tensions + [-depth, -depth])
    assert answer.inside
    return float(answer.contact_force[0])


@pytest.mark.parametrize("radius", [0.003, 0.005])
def test_a_ball_presses_as_in_contact_of_hertz(rod, radius):
    """4/3 E/(1 - nu^2) sqrt(R) delta^(3/2) of a half-space; the finger is as thick as 10 contact radii or more."""
    material = rod.scene["material"]
    shear, bulk = 2 * material["C1"], 2 / material["D1"]
    young, poisson = 9 * bulk * shear / (3 * bulk + shear), (3 * bulk - 2 * shear) / (2 * (3 * bulk + shear))
    for depth in (5e-5, 1e-4, 2e-4):
        hertz = 4 / 3 * young / (1 - poisson**2) * np.sqrt(radius) * depth**1.5
        assert squeezed(rod, radius, depth) == pytest.approx(hertz, rel=0.2)


def elliptic(ratio):
    """Force of a contact of Hertz with a ratio of curvatures, over that without the larger one (Johnson 1985, 4.2)."""

    def differs(m):
        return (ellipe(m) / (1 - m) - ellipk(m)) / (ellipk(m) - ellipe(m)) - ratio

    m = brentq(differs, 1e-9, 1 - 1e-12)
    # Half axes 1 / sqrt(1 - m) and 1, largest pressure 1: curvature along the longer one, depth and force over E*.
    curvature, depth, force = 2 * (1 - m) / m * (ellipk(m) - ellipe(m)), ellipk(m), 2 / 3 * np.pi / np.sqrt(1 - m)
    return force / (4 / 3 * curvature**-0.5 * depth**1.5)


@pytest.mark.parametrize("radius", [0.4, 1.0, 2.0, 4.0])
def test_a_ball_presses_on_a_circle_as_in_contact_of_hertz(radius):
    """Both round, of elliptic contact area; the radius is over the finger's. Deeper, the finger is no half space.

    The finger has no weight, which would stretch it: then it is thinner by up to a tenth of the depth.
    """
    circle = TouchedSegment.load("round").rod.with_gravity((1, 0, 0), 1e-9)
    young, poisson, half = circle.segments[0].young_modulus, circle.segments[0].poisson, circle.half_lengths[1]
    for depth in (0.005 * half, 0.01 * half):
        flat = 4 / 3 * young / (1 - poisson**2) * np.sqrt(radius * half) * depth**1.5
        assert squeezed(circle, radius * half, depth) == pytest.approx(elliptic(1 + radius) * flat, rel=0.1)


def test_a_ball_presses_on_nearly_incompressible_rubber_as_in_contact_of_hertz():
    square = TouchedSegment.load("square").rod.with_gravity((1, 0, 0), 1e-9)
    young, poisson, half = square.segments[0].young_modulus, square.segments[0].poisson, square.half_lengths[1]
    for radius, depth in ((0.4, 0.01), (1.0, 0.01), (1.0, 0.02)):
        hertz = 4 / 3 * young / (1 - poisson**2) * np.sqrt(radius * half) * (depth * half) ** 1.5
        assert poisson > 0.49 and squeezed(square, radius * half, depth * half) == pytest.approx(hertz, rel=0.1)


def test_the_force_does_not_depend_on_where_slices_begin(rod):
    forces = [squeezed(rod, 0.005, 1e-4, aside) for aside in np.linspace(0.0, 7e-4, 8)]
    assert np.ptp(forces) < 0.02 * np.mean(forces)


def line_force(poisson, radius, depth, pitch=0.1):
    """The force of two cylinders across opposite faces, by the compliances of lines: half side and modulus are 1."""
    count = 41
    given = indentations((1.0, poisson), 1.0, pitch, count)
    at = pitch * (np.arange(count) - count // 2)
    apart = np.abs(np.subtract.outer(np.arange(count), np.arange(count)))
    compliance = (given["row_compliance"] + given["opposite_compliance"])[apart]
    wanted = depth - at**2 / (2 * radius)
    root = np.linalg.cholesky(compliance)  # forces of at least 0 minimise f C f / 2 - w f
    return nnls(root.T, np.linalg.solve(root, wanted))[0].sum()


@pytest.mark.parametrize("poisson", [0.0, 0.49])
def test_a_line_across_a_face_presses_as_in_linear_elasticity_at_every_poissons_ratio(poisson):
    change, true = (
        force(1.2, 0.02, poisson) / force(1.2, 0.02, 0.3)
        for force in (lambda r, d, nu: line_force(nu, r, d), cylinder_across_face)
    )
    assert abs(true - 1) > 0.03 and change == pytest.approx(true, abs=0.02)


@pytest.mark.long
@pytest.mark.parametrize(("radius", "depth"), [(0.8, 0.03), (0.4, 0.06)])
def test_an_edge_presses_as_in_linear_elasticity_at_every_poissons_ratio(radius, depth):
    first, *others = (ball_on_edge(radius, depth, poisson) for poisson in (0.3, 0.0, 0.49))
    given = np.array([indentations((1.0, nu), 1.0, 0.1, 2)["edge_compliance"] for nu in (0.3, 0.0, 0.49)])
    assert min(others) < 0.98 * first and max(others) > 1.1 * first
    assert given[0] / given[1:] == pytest.approx(np.array(others) / first, abs=0.04)
