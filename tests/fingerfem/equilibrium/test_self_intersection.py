"""Self-intersection of a surface: arcs of more than a turn, rigid motions, and crossings in closed form."""

import tomllib

import numpy as np
import pytest
from farm import ROOT
from mpi4py import MPI
from scipy.spatial.transform import Rotation

from fingerfem.discretisation.problem import Problem
from fingerfem.equilibrium.self_intersection import Surface, _cross
from fingerfem.scene.scene import Scene

LENGTH, SIDE = 0.05, 0.010


def problem(in_plane: bool = False) -> Problem:
    table = tomllib.loads((ROOT / "scenes" / "draft.toml").read_text())
    table |= {"mesh": {"cells": [20, 5], "order": 1}}
    table["tendons"][1]["offset"] = [-0.004, 0.0] if in_plane else [0.0, 0.004]
    return Problem(Scene.model_validate(table), MPI.COMM_SELF)


@pytest.fixture(scope="module")
def rest_and_surface() -> tuple[np.ndarray, Surface]:
    own = problem()
    return own.space.tabulate_dof_coordinates(), Surface(own)


def rolled(rest: np.ndarray, angle: float, rise: float = 0.0) -> np.ndarray:
    """Displacements by which the axis becomes an arc of an angle, which may rise like a screw [rad, m]."""
    radius, turned = LENGTH / angle, angle * rest[:, 0] / LENGTH
    inwards = radius - rest[:, 1]
    climb = rise * rest[:, 0] / LENGTH
    return np.column_stack([inwards * np.sin(turned), radius - inwards * np.cos(turned), rest[:, 2] + climb]) - rest


@pytest.mark.parametrize(("turns", "passes"), [(0.3, False), (0.9, False), (1.03, True), (1.2, True)])
def test_an_arc_passes_through_itself_from_a_whole_turn_on(rest_and_surface, turns, passes):
    rest, surface = rest_and_surface
    assert surface.passes_through_itself(rolled(rest, 2 * np.pi * turns)) is passes


def test_a_screw_of_more_than_a_turn_that_rises_by_more_than_a_side_does_not(rest_and_surface):
    rest, surface = rest_and_surface
    found = [surface.passes_through_itself(rolled(rest, 2.4 * np.pi, rise)) for rise in (0.3 * SIDE, 1.6 * SIDE)]
    assert found == [True, False]


def test_motions_stretches_and_turns_change_nothing(rest_and_surface):
    rest, surface = rest_and_surface
    random = np.random.default_rng(0)
    for angle, passes in ((4.0, False), (7.0, True)):
        moved = rest + rolled(rest, angle)
        for _ in range(2):
            turn, size = Rotation.from_rotvec(random.uniform(-2, 2, 3)), random.uniform(0.5, 2.0)
            assert surface.passes_through_itself(size * turn.apply(moved) + random.standard_normal(3) - rest) is passes
    assert not surface.passes_through_itself(np.zeros_like(rest))


def test_its_triangles_cover_every_side_and_the_tip_once(rest_and_surface):
    _, surface = rest_and_surface
    corners = surface._rest[surface._first][surface._triangles]
    areas = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1) / 2
    assert areas.sum() == pytest.approx(4 * LENGTH * SIDE + SIDE**2)
    assert len(np.unique(np.sort(surface._triangles, axis=1), axis=0)) == len(corners)


def test_half_a_finger_beyond_its_mirror_plane_meets_its_image():
    own = problem(in_plane=True)
    rest, surface = own.space.tabulate_dof_coordinates(), Surface(own)
    assert own.scene.is_half and rest[:, 2].min() == pytest.approx(0.0, abs=1e-12)
    for shift, passes in ((1e-4, False), (0.0, False), (-1e-4, True)):
        bent = np.outer(rest[:, 0] / LENGTH, [0.0, 0.0, shift])
        assert surface.passes_through_itself(bent) is passes


def test_segments_cross_triangles_where_the_closed_form_says_so_in_any_position():
    """The triangle (0,0,0), (1,0,0), (0,1,0): its plane z = 0 is met at a place with x, y >= 0, x + y <= 1."""
    random = np.random.default_rng(1)
    ends = random.uniform(-1, 2, (4000, 2, 3)) - [0, 0, 0.5]
    share = ends[:, :1, 2] / (ends[:, :1, 2] - ends[:, 1:, 2])
    place = (ends[:, 0] + share * (ends[:, 1] - ends[:, 0]))[:, :2]
    met = (share[:, 0] >= 0) & (share[:, 0] <= 1)
    expected = met & (place >= 0).all(axis=1) & (place.sum(axis=1) <= 1)
    corners = np.tile([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]], (len(ends), 1, 1))
    turn = Rotation.from_rotvec([0.3, -1.2, 2.0])
    assert 200 < expected.sum() < 2000
    for size in (1.0, 1e-6):
        given = [size * turn.apply(part.reshape(-1, 3)).reshape(part.shape) + 0.1 * size for part in (ends, corners)]
        assert np.array_equal(_cross(*given), expected)
    along = np.array([[[0.1, 0.1, 0.0], [0.9, 0.05, 0.0]]])  # in the triangle's plane: nothing passes through
    assert not _cross(along, corners[:1]).any()
