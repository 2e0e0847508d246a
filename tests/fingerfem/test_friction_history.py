"""Coulomb friction in the full-order model: the cone, sticking, sliding, dissipation; and the rod's histories."""

import numpy as np
import pytest
from farm import ROOT

from fingerfem import FingerModel
from fingerfem.friction_history import friction_history
from fingerfem.scene.scene import Scene
from rom import friction_history as of_the_rod

PRESSED = [40.0, 5.0, 0.0105]  # F1, F2 [N], d [m]


def moved(*ways: float) -> list[list[float]]:
    """Motions of the plane along the finger [m]."""
    return [[way, 0.0, 0.0] for way in ways]


def test_without_friction_it_is_the_frictionless_state(draft):
    (state,) = friction_history(draft, [PRESSED], 0.0, increments=2)
    assert state.normal_force == pytest.approx(draft.solve(PRESSED[:2], PRESSED[2], sensitivities=False).contact_force)
    np.testing.assert_allclose(state.force, [0.0, -state.normal_force, 0.0], atol=1e-9)


def test_where_all_slides_the_force_lies_on_the_cone_and_else_inside_it(draft):
    """The patch test of a block that is dragged: tangential force over normal force is the coefficient."""
    friction, ways = 0.3, moved(0.0, 0.002, 0.0019)
    first, sliding, back = friction_history(draft, [PRESSED] * 3, friction, moved=ways, increments=4)
    for state in (first, sliding, back):
        normal, tangential = state.pressing.T
        assert (tangential <= friction * normal + 1e-6).all() and state.normal_force > 0.5
    drag = np.hypot(sliding.force[0], sliding.force[2])
    assert sliding.sticks == 0.0 and drag == pytest.approx(friction * sliding.normal_force, rel=1e-6)
    assert sliding.force[0] > 0  # along the plane's motion
    assert np.hypot(back.force[0], back.force[2]) < 0.9 * friction * back.normal_force and back.sticks > 0.5


def test_what_sticks_is_elastic(draft):
    """A small motion and back, with much friction: the force is what it was, and nothing is dissipated."""
    begun, out, back = friction_history(draft, [PRESSED] * 3, 5.0, moved=moved(0.0, 5e-5, 0.0), increments=2)
    assert min(out.sticks, back.sticks) > 0.9 and np.abs(out.force - begun.force).max() > 0.01
    np.testing.assert_allclose(back.force, begun.force, atol=2e-4)
    assert back.dissipated == pytest.approx(begun.dissipated, abs=1e-7)


@pytest.mark.long
def test_the_plane_does_the_work_that_friction_dissipates(draft):
    """Once around a cycle that repeats itself, by the trapezoidal rule over its points."""
    there = np.linspace(0.0, 0.003, 9)
    ways = np.concatenate([there, there[::-1], there, there[::-1]])
    states = friction_history(draft, [PRESSED] * len(ways), 0.4, moved=moved(*ways), increments=1)
    cycle = slice(len(there) * 2 - 1, None)
    forces, along = np.array([state.force[0] for state in states])[cycle], ways[cycle]
    work = float(np.sum(np.diff(along) * (forces[1:] + forces[:-1]) / 2))
    dissipated = states[-1].dissipated - states[cycle.start].dissipated
    assert dissipated > 1e-4 and work == pytest.approx(dissipated, rel=0.1)


@pytest.mark.long
def test_shorter_increments_change_less(draft):
    ways = [[0.0, 0.0, 0.0], [0.001, 0.0, 0.001]]
    ends = [friction_history(draft, [PRESSED] * 2, 0.4, moved=ways, increments=n)[-1].force for n in (4, 8, 32)]
    errors = [np.linalg.norm(end - ends[2]) for end in ends[:2]]
    assert errors[1] < 0.7 * errors[0] < 0.05


@pytest.mark.long
@pytest.mark.parametrize("friction", [0.15, 0.3])
def test_a_rod_has_the_full_order_history(draft, touched, friction):
    """Press, drag, drag aside, pull more: forces within half a percent of the normal force."""
    points = [[40.0, 5.0, 0.0115]] * 3 + [[41.0, 6.0, 0.0115]]
    ways = [[0.0, 0.0, 0.0], [0.0005, 0.0, 0.0], [0.001, 0.0, 0.0005], [0.001, 0.0, 0.0005]]
    full = friction_history(draft, points, friction, moved=ways, increments=4)
    rod = of_the_rod(touched, points, friction, moved=ways, increments=4)
    assert all(state.status == "converged" for state in rod)
    for one, other in zip(full, rod, strict=True):
        assert np.linalg.norm(one.force - other.force) < 0.005 * one.normal_force + 0.005


def before(table, shape):
    """The draft finger under a round object that d brings obliquely: down and along the finger."""
    way = np.array([-0.6, 0.8, 0.0])
    place = {"centre": [0.03, 0.016, 0.0], "direction": way.tolist(), "distance": [-0.006, 0.03], "method": "penalty"}
    return FingerModel(Scene.model_validate(table | {"obstacle": shape | place}))


SHAPES = {
    "sphere": {"shape": "sphere", "radius": 0.008},
    "cylinder": {"shape": "cylinder", "radius": 0.008, "axis": [0.0, 0.0, 1.0]},
    "box": {"shape": "box", "sides": [0.014, 0.014, 0.014], "rotation": [0.0, 0.0, 0.3], "rounding": 0.002},
}


@pytest.mark.long
@pytest.mark.parametrize("shape", SHAPES)
def test_round_objects_drag_the_rubber_along(table, shape):
    """Sliding nodes are on their cones; without friction the state is the frictionless one; work is dissipated."""
    friction, model = 0.3, before(table, SHAPES[shape])
    touch = model.solve([10.0, 0.0], None, sensitivities=False).touch_distance
    points = [[10.0, 0.0, touch - depth] for depth in (0.0005, 0.001, 0.0015)]
    states = friction_history(model, points, friction, increments=4)
    for state in states:
        normal, tangential = state.pressing.T
        assert (tangential <= friction * normal + 1e-6).all() and state.normal_force > 0.1
    assert tangential.sum() == pytest.approx(friction * states[-1].normal_force, rel=1e-4)
    assert states[-1].sticks == 0.0 and states[-1].dissipated > states[0].dissipated > 0
    smooth = friction_history(model, points[-1:], 0.0, increments=2)[0]
    state = model.solve(points[-1][:2], points[-1][2], sensitivities=False)
    np.testing.assert_allclose(smooth.tip, state.tip, atol=1e-8)
    assert smooth.force @ model.problem.bodies[0].direction == pytest.approx(-state.contact_force, rel=1e-6)
    dragged = states[-1].force - smooth.force
    assert dragged[0] > 0.05  # along the object's way: it moves towards the tip as d decreases


def test_several_obstacles_and_bad_input_are_refused(table, draft):
    model = before(table, SHAPES["sphere"])
    with pytest.raises(ValueError, match="moved must be 0 for a round obstacle"):
        friction_history(model, [[*PRESSED[:2], 0.003]], 0.3, moved=[[0.001, 0.0, 0.0]])
    model = before(
        table,
        SHAPES["sphere"]
        | {"others": [{"shape": "sphere", "radius": 0.008, "centre": [0.03, -0.02, 0], "direction": [0, -1, 0]}]},
    )
    with pytest.raises(ValueError, match="obstacle must be a single body with the penalty method"):
        friction_history(model, [PRESSED], 0.3)
    with pytest.raises(ValueError, match="points must be tensions and d"):
        friction_history(draft, [[1.0, 2.0]], 0.3)
    with pytest.raises(ValueError, match="coefficient at least 0"):
        friction_history(draft, [PRESSED], -0.1)
    with pytest.raises(ValueError, match=r"F1 must lie in \[0, 100\] N, got 400"):
        friction_history(draft, [[400.0, 0.0, 0.01]], 0.3)


@pytest.mark.long
def test_a_finger_that_leaves_the_plane_comes_back_without_memory(draft):
    begun, away, again = friction_history(draft, [PRESSED, [40.0, 5.0, 0.02], PRESSED], 0.4, increments=3)
    assert away.normal_force == 0.0 and np.isnan(away.sticks) and not away.force.any()
    np.testing.assert_allclose(again.force, begun.force, atol=0.02)


@pytest.mark.long
@pytest.mark.mpi
def test_ranks_that_share_a_finger_have_its_history():
    """One of two ranks has no node in contact."""
    from mpi4py import MPI

    from fingerfem import load_scene

    path = ROOT / "scenes" / "draft.toml"
    way = [[0.0, 0.0, 0.0], [0.001, 0.0, 0.0002]]
    shared, alone = (FingerModel(load_scene(path), comm) for comm in (MPI.COMM_WORLD, MPI.COMM_SELF))
    ours, theirs = (friction_history(one, [PRESSED] * 2, 0.3, moved=way, increments=2) for one in (shared, alone))
    for one, other in zip(ours, theirs, strict=True):
        np.testing.assert_allclose(one.force, other.force, atol=1e-6)
        assert one.dissipated == pytest.approx(other.dissipated, abs=1e-8) and one.sticks == other.sticks
