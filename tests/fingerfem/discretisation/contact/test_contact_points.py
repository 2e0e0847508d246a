"""Points of the surface where contact is looked for: linear fields are exact there, and areas are the finger's."""

import tomllib

import numpy as np
import pytest
from farm import ROOT

from fingerfem.discretisation import regions
from fingerfem.discretisation.contact.contact_points import FixedPoints, SurfaceFacets, at_nodes, on_facets, tables
from fingerfem.discretisation.problem import Problem
from fingerfem.mechanics.obstacles import body
from fingerfem.scene.obstacle import Obstacle
from fingerfem.scene.scene import Scene

LENGTH, SIDE, STIFFNESS = 0.05, 0.010, 1e9  # [m], [m], [N/m^3]
LINEAR = np.array([[0.1, -0.2, 0.3], [0.05, 0.4, -0.1], [0.2, 0.1, 0.3]])
POINTS, WEIGHTS = np.polynomial.legendre.leggauss(3)
AT = np.array([[(1 + s) / 2, (1 + t) / 2] for s in POINTS for t in POINTS])
RULE = AT, np.outer(WEIGHTS, WEIGHTS).ravel() / 4


@pytest.fixture(scope="module", params=[1, pytest.param(2, marks=pytest.mark.long)])
def problem(request) -> Problem:
    from mpi4py import MPI

    table = tomllib.loads((ROOT / "scenes" / "draft.toml").read_text())
    table |= {"mesh": {"cells": [10, 5], "order": request.param}}
    return Problem(Scene.model_validate(table), MPI.COMM_SELF)


@pytest.fixture(scope="module")
def facets(problem) -> np.ndarray:
    return np.sort(np.concatenate([problem.mesh.facets.find(kind) for kind in regions.SURFACE]))


def linear(places: np.ndarray) -> np.ndarray:
    return places @ LINEAR.T + [1e-3, 2e-3, -3e-3]


def plane(problem) -> object:
    return body(Obstacle(distance=[0.001, 0.03], method="penalty"), SIDE / 2)


def test_linear_fields_are_exact_at_the_nodes_and_between_them(problem, facets):
    rest = problem.space.tabulate_dof_coordinates()
    for points in (at_nodes(problem.space, np.array([5, 0, 17])), on_facets(problem.space, [(facets, 4)])):
        assert points.field(linear(rest).ravel()) == pytest.approx(linear(points.rest), abs=1e-12)
        assert points.field(np.ones(rest.size)) == pytest.approx(np.ones_like(points.rest))
    assert len(points.rest) == 16 * len(facets)
    low, high = points.rest.min(axis=0), points.rest.max(axis=0)
    assert low == pytest.approx([0, -SIDE / 2, -SIDE / 2]) and high == pytest.approx([LENGTH, SIDE / 2, SIDE / 2])


def test_areas_of_all_facets_are_the_surface_of_a_prism_without_its_clamp(problem, facets):
    own = SurfaceFacets(problem.space, facets)
    area = float((own.areas(RULE[0]) @ RULE[1]).sum())
    assert area == pytest.approx(4 * LENGTH * SIDE + SIDE**2)
    assert own.shapes(RULE[0]).sum(axis=1) == pytest.approx(np.ones(9))
    assert own.places(linear(problem.space.tabulate_dof_coordinates()).ravel()) - own.rest == pytest.approx(
        linear(own.rest), abs=1e-12
    )


def test_points_press_by_how_deep_they_are_and_share_the_stiffness_of_their_face(problem, facets):
    """A rigid motion into a plane by 1 um, turned about z: a part of the face is inside."""
    points = FixedPoints(SurfaceFacets(problem.space, facets), RULE, STIFFNESS, plane(problem))
    rest, slope, depth = problem.space.tabulate_dof_coordinates(), 1e-4, 1e-6
    lifted = np.zeros_like(rest)
    lifted[:, 1] = depth + slope * (rest[:, 0] - LENGTH / 2)
    found = points.pressing(lifted.ravel(), 0.0, np.zeros(0, int))
    places = np.einsum("mn,mni->mi", found.weights, (rest + lifted)[found.nodes])
    assert found.gaps == pytest.approx(SIDE / 2 - places[:, 1], abs=1e-15) and found.gaps.max() < 0
    assert places[:, 0].min() > LENGTH / 2 - depth / slope - 1e-9 and (np.diff(found.slots) > 0).all()
    whole = points.pressing(np.tile([0.0, depth, 0.0], len(rest)), 0.0, np.zeros(0, int))
    assert whole.stiffness.sum() == pytest.approx(STIFFNESS * LENGTH * SIDE)
    assert whole.gaps == pytest.approx(np.full(len(whole.gaps), -depth), abs=1e-15)


def test_points_that_are_tried_are_there_with_their_gap_wherever_they_are(problem, facets):
    points = FixedPoints(SurfaceFacets(problem.space, facets), RULE, STIFFNESS, plane(problem))
    tried = np.array([3, 40, points.count - 1])
    rest = np.zeros(problem.displacement.size)
    found = points.pressing(rest, 0.002, tried)
    assert found.slots.tolist() == tried.tolist() and (found.gaps >= 0.002 - 1e-12).all()
    assert not len(points.pressing(rest, 0.002, np.zeros(0, int)).gaps)


def test_without_places_tables_have_the_shape_of_none(problem, facets):
    element = SurfaceFacets(problem.space, facets[:0]).element
    for most, count in ((0, 1), (1, 3), (2, 6)):
        assert tables(element, most, np.zeros((0, 2))).shape == (count, 0, len(element.points))
        assert tables(element, most, AT).shape == (count, 9, len(element.points))
    assert SurfaceFacets(problem.space, facets[:0]).areas(AT).shape == (0, 9)
