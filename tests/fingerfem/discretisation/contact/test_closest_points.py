"""Springs at closest points: where they are, that they have an energy, and what they are for."""

import numpy as np
import pytest
from mpi4py import MPI

from fingerfem import FingerModel
from fingerfem.discretisation import regions
from fingerfem.discretisation.contact.closest_points import ClosestPoints
from fingerfem.mechanics.contact import touch_at_nodes
from fingerfem.mechanics.obstacles import body
from fingerfem.scene.obstacle import Obstacle
from fingerfem.scene.scene import Scene

END, SIDE = 0.05, 0.010  # of the finger [m]
STIFFNESS = 1e10  # [N/m^3]
# Each presses 2 um into the tip plate: its face, an edge, a corner.
BALL = {"shape": "sphere", "centre": [END + 0.003 - 2e-6, 0.0013, 0.0007], "radius": 0.003}
ROLLER = {"shape": "cylinder", "centre": [END + 0.002, 0.007, 0.0007], "radius": 8**0.5 * 1e-3 + 2e-6}
AT_CORNER = {"shape": "sphere", "centre": [END + 0.002, 0.007, 0.007], "radius": 12**0.5 * 1e-3 + 2e-6}
SHAPES = {"face": BALL, "edge": ROLLER | {"axis": [0.3, -0.3, 1.0]}, "corner": AT_CORNER}

RING = {
    "name": "ring",
    "section": {"shape": "ring", "diameter": 0.020, "bore": 0.010},
    "geometry": {"segments": [0.060], "plate": 0.002, "channel": 0.003},
    "material": {"law": "neo-hookean", "E": 1e6, "nu": 0.3},
    "tendons": [{"name": "up", "offset": [0.0065, 0.0], "segment": 1, "tension": [0.0, 5.0]}],
    "mesh": {"cells": [6, 8], "order": 2, "symmetry": False},
}


def points(table: dict, shape: dict, order: int = 1) -> tuple[ClosestPoints, np.ndarray]:
    """The plates' springs, and a displacement that bends them."""
    table = {name: value for name, value in table.items() if name != "sampling"}
    table |= {"mesh": {"cells": [10, 5], "order": order}}
    problem = FingerModel(Scene.model_validate(table)).problem
    obstacle = body(Obstacle(distance=[0.001, 0.03], method="penalty", direction=[1.0, 0.5, 0.2], **shape), SIDE)
    facets = np.concatenate([problem.mesh.facets.find(kind) for kind in regions.PLATE_FACETS])
    found = ClosestPoints(problem.space, np.sort(facets), STIFFNESS, obstacle)
    rest = problem.space.tabulate_dof_coordinates()
    bent = np.random.default_rng(0).standard_normal((3, 3)) * 1e-5
    moved = (rest - [END, 0, 0]) @ bent.T
    return found, moved.ravel()


@pytest.mark.parametrize("order", [1, pytest.param(2, marks=pytest.mark.long)])
@pytest.mark.parametrize("name", ["face", *(pytest.param(one, marks=pytest.mark.long) for one in ("edge", "corner"))])
def test_forces_are_differences_of_the_energy_and_the_stiffness_of_the_forces(table, name, order):
    found, displacement = points(table, SHAPES[name], order)
    d = 0.0
    while not (springs := found.springs(displacement, d)).energy and d > -3e-3:
        d -= 1e-5  # the object comes nearer until it presses
    assert len(springs.gaps) and springs.gaps.max() < 0
    at, h = np.unique(springs.nodes), 1e-8
    random = np.random.default_rng(1)
    for _ in range(3):
        along = np.zeros((len(displacement) // 3, 3))
        along[at] = random.standard_normal((len(at), 3))
        ends = [found.springs(displacement + sign * h * along.ravel(), d) for sign in (-1, 1)]
        slope = np.sum(springs.forces * along[springs.nodes])
        assert (ends[1].energy - ends[0].energy) / (2 * h) == pytest.approx(slope, rel=1e-3)
        nodal = []
        for one in ends:
            nodal.append(np.zeros_like(along))
            np.add.at(nodal[-1], one.nodes, one.forces)
        change = np.zeros_like(along)
        moved = np.einsum("mij,mj->mi", springs.stiffness, along[springs.nodes].reshape(len(springs.nodes), -1))
        np.add.at(change, springs.nodes, moved.reshape(springs.forces.shape))
        difference = (nodal[1] - nodal[0]) / (2 * h)
        assert np.abs(difference - change).max() < 2e-3 * np.abs(change).max()


def test_a_ball_presses_a_face_where_it_is_nearest_between_all_nodes(table):
    found, _ = points(table, BALL)
    springs = found.springs(np.zeros(3 * (found._facets.nodes.max() + 1)), 0.0)
    force = springs.forces.sum(axis=(0, 1))
    by_node = dict(zip(found._facets.nodes.ravel(), found._facets.rest.reshape(-1, 3), strict=True))
    places = np.array([[by_node[node] for node in nodes] for nodes in springs.nodes])
    centre = np.einsum("mn,mni->i", springs.forces[..., 0], places) / force[0]
    assert centre == pytest.approx([END, 0.0013, 0.0007], abs=1e-8)  # facets are slightly domed
    assert springs.gaps == pytest.approx([-2e-6], rel=1e-3)
    assert force[1:] == pytest.approx([0, 0], abs=1e-5 * abs(force[0]))


def test_a_ring_of_curved_cells_rolls_on_a_plane():
    """At every turn the plane presses 10 um deep, towards the axis: at nodes alone with levers of 0.14 radii."""
    radius, depth = 0.010, 1e-5
    scene = Scene.model_validate(RING)
    problem = FingerModel(scene).problem
    plane = body(Obstacle(distance=[0.001, 0.03], method="penalty"), scene.geometry.shape.top)
    facets = np.concatenate([problem.mesh.facets.find(kind) for kind in regions.PLATE_FACETS])
    found = ClosestPoints(problem.space, np.sort(facets), STIFFNESS, plane)
    rest = problem.space.tabulate_dof_coordinates()
    for angle in np.radians(np.linspace(-16.0, 17.0, 12)):
        turned = rest @ np.array([[1, 0, 0], [0, np.cos(angle), -np.sin(angle)], [0, np.sin(angle), np.cos(angle)]]).T
        springs = found.springs((turned - rest).ravel(), -depth)
        assert springs.gaps.min() == pytest.approx(-depth, rel=0.1)  # a side of 16 degrees is a parabola
        force, at = springs.forces.reshape(-1, 3), turned[springs.nodes.ravel()]
        torque = np.cross(at, force).sum(axis=0)[0]
        assert abs(torque) < 2e-2 * radius * np.abs(force[:, 1].sum())
    straight = Scene.model_validate(RING | {"mesh": {"cells": [6, 8]}})
    assert touch_at_nodes(straight) and not touch_at_nodes(scene)


def test_what_is_held_pulls_only_where_nothing_presses(table):
    found, _ = points(table, BALL)
    rest = np.zeros(3 * (found._facets.nodes.max() + 1))
    pressed, held = (found.springs(rest, 0.0, held=held) for held in (False, True))
    assert held.forces == pytest.approx(pressed.forces, abs=1e-12)
    away = found.springs(rest, 1e-4, held=True)
    assert found.springs(rest, 1e-4).gaps.size == 0 and away.gaps.size >= 1 and away.gaps.min() > 0
    assert np.sum(away.forces[..., 0]) * np.sum(pressed.forces[..., 0]) < 0


BEFORE_A_BALL = {"shape": "sphere", "centre": [0.042, 0.017, 0.002], "radius": 0.012}


def ball_scene(table: dict) -> Scene:
    kept = {key: table["obstacle"][key] for key in ("distance", "method")}
    return Scene.model_validate(table | {"obstacle": kept | BEFORE_A_BALL})


@pytest.mark.long
def test_a_state_on_a_ball_costs_what_a_state_on_a_plane_costs(table):
    finger = FingerModel(ball_scene(table))
    touch = finger.solve([50.0, 20.0]).touch_distance
    on_ball = finger.solve([50.0, 20.0], touch - 0.001)
    flat = FingerModel(Scene.model_validate(table))
    on_plane = flat.solve([50.0, 20.0], flat.solve([50.0, 20.0]).touch_distance - 0.001)
    assert on_ball.contact_force > 0.5 and on_ball.complementarity < 1e-4
    assert on_ball.newton_iterations <= 2 * on_plane.newton_iterations
    assert set(on_ball.strategies) <= {"mixed", "plain"}


@pytest.mark.long
@pytest.mark.mpi
def test_ranks_share_a_finger_before_a_ball():
    import tomllib

    from farm import ROOT

    scene = ball_scene(tomllib.loads((ROOT / "scenes" / "draft.toml").read_text()))
    alone, shared = FingerModel(scene), FingerModel(scene, MPI.COMM_WORLD)
    d = alone.solve([50.0, 20.0]).touch_distance - 0.001
    ours, theirs = shared.solve([50.0, 20.0], d), alone.solve([50.0, 20.0], d)
    assert ours.contact_force == pytest.approx(theirs.contact_force, rel=1e-8)
    assert ours.penetration == pytest.approx(theirs.penetration, rel=1e-6)
    for name in ("F1", "F2", "d"):
        assert ours.sensitivities["contact_force"][name] == pytest.approx(
            theirs.sensitivities["contact_force"][name], rel=1e-5
        )
