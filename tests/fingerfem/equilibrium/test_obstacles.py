"""Obstacles of any shape: the same numbers where two describe one body, balance, and derivatives."""

import numpy as np
import pytest

from fingerfem import FingerModel
from fingerfem.equilibrium.sensitivities import differentiate
from fingerfem.scene.scene import Scene, SceneError
from fingerfem.snapshots.design import describe
from fingerfem.versions import versions

TENSIONS, D = [50.0, 20.0], 0.010
SHAPES = {
    "tilted plane": {"shape": "plane", "centre": [0.045, 0.005, 0.0], "normal": [0.3, -1.0, 0.2]},
    "sphere": {"shape": "sphere", "centre": [0.042, 0.017, 0.002], "radius": 0.012},
    "cylinder": {"shape": "cylinder", "centre": [0.040, 0.017, 0.0], "radius": 0.012, "axis": [0.1, 0.0, 1.0]},
    "box": {
        "shape": "box",
        "centre": [0.045, 0.012, 0.0],
        "sides": [0.014, 0.014, 0.030],
        "rotation": [0.05, 0.0, 0.4],
        "rounding": 0.002,
    },
}


def model(table: dict, **obstacle) -> FingerModel:
    kept = {key: table["obstacle"][key] for key in ("distance", "method")}
    return FingerModel(Scene.model_validate(table | {"obstacle": kept | obstacle}))


@pytest.fixture(
    scope="module", params=["sphere", *(pytest.param(one, marks=pytest.mark.long) for one in SHAPES if one != "sphere")]
)
def pressed(request):
    """A model, and its state pressed on an obstacle."""
    import tomllib

    from farm import ROOT

    table = tomllib.loads((ROOT / "scenes" / "draft.toml").read_text())
    finger = model(table, **SHAPES[request.param])
    free = finger.solve(TENSIONS)
    assert free.touch_distance is not None
    return finger, free, finger.solve(TENSIONS, free.touch_distance - 0.001)


@pytest.mark.long
def test_a_plane_that_says_where_it_is_gives_the_numbers_of_the_usual_one(table):
    usual = model(table).solve(TENSIONS, D)
    same = model(table, centre=[0.03, 0.005, 0.01], normal=[0, -2.0, 0], direction=[0, 3.0, 0]).solve(TENSIONS, D)
    assert same.contact_force == pytest.approx(usual.contact_force, rel=1e-10)
    assert same.touch_distance == pytest.approx(usual.touch_distance, rel=1e-12)
    assert np.abs(same.displacement - usual.displacement).max() < 1e-12
    for name in ("F1", "F2", "d"):
        ours, theirs = (state.sensitivities["contact_force"][name] for state in (same, usual))
        assert ours == pytest.approx(theirs, rel=1e-9)


@pytest.mark.long
def test_a_plane_beside_the_finger_is_the_plane_above_it_seen_from_the_side(table):
    above = model(table).solve(TENSIONS, D)
    beside = model(table, centre=[0, 0, 0.005], normal=[0, 0, -1.0]).solve(TENSIONS[::-1], D)
    assert beside.contact_force == pytest.approx(above.contact_force, rel=1e-8)
    assert beside.tip[[0, 2, 1]] == pytest.approx(above.tip, abs=1e-10)
    assert beside.sensitivities["contact_force"]["d"] == pytest.approx(
        above.sensitivities["contact_force"]["d"], rel=1e-6
    )


@pytest.mark.long
def test_large_spheres_and_cylinders_become_the_plane(table):
    flat = model(table).solve(TENSIONS, D)
    where = flat.displacement.reshape(-1, 3)  # touched near the tip: the apex of the round ones stands there
    apex = 0.05 + float(where[:, 0].min())
    for extra in ({"shape": "sphere"}, {"shape": "cylinder", "axis": [0.0, 0.0, 1.0]}):
        off = []
        for radius in (0.2, 0.8):
            state = model(table, radius=radius, centre=[apex, 0.005 + radius, 0.0], **extra).solve(TENSIONS, D)
            off.append(abs(state.contact_force / flat.contact_force - 1))
        assert off[1] < off[0] / 3 and off[1] < 0.02, off


def test_forces_and_moments_balance(pressed):
    finger, _, state = pressed
    problem = finger.problem
    finger.take(state)
    on_obstacle = problem.contact.nodal_force()
    reaction = problem.nodal(problem.forms.residual, problem.contact.spring_forces())  # zero but at the clamp
    places = problem.space.tabulate_dof_coordinates() + problem.displacement.reshape(-1, 3)
    force, pushed = reaction.sum(axis=0), on_obstacle.sum(axis=0)
    assert np.linalg.norm(pushed) > 0.1  # [N]
    assert np.abs(force - pushed).max() < 1e-8 * problem.force_scale
    assert state.clamp_reaction == pytest.approx(force, abs=1e-9 * problem.force_scale)
    moments = [np.cross(places, nodal).sum(axis=0) for nodal in (reaction, on_obstacle)]
    assert np.abs(moments[0] - moments[1]).max() < 1e-8 * problem.force_scale * 0.05
    assert state.contact_force == pytest.approx(float(pushed @ problem.bodies[0].direction), rel=1e-9)
    assert 0 < state.penetration < 2e-5 and state.stable


def test_derivatives_are_differences(pressed):
    finger, free, state = pressed
    d, step = state.parameters["d"], 1e-6
    near = {}
    for k, (name, h) in enumerate((("F1", 1e-3), ("F2", 1e-3), ("d", step))):
        moved = []
        for sign in (-1, 1):
            finger.take(state)
            tensions = np.array(TENSIONS) + (sign * h * np.eye(3)[k][:2])
            finger.continuation.advance(tensions, d + (sign * h if name == "d" else 0.0))
            moved.append((finger.problem.contact.force(), finger.problem.energy()))
        near[name] = [(b - a) / (2 * h) for a, b in zip(*moved, strict=True)]
        assert state.sensitivities["contact_force"][name] == pytest.approx(near[name][0], rel=2e-3, abs=1e-6)
    assert -near["d"][1] == pytest.approx(state.contact_force, rel=1e-5)
    by_tensions = []
    for k in range(2):
        reaches = []
        for sign in (-1, 1):
            finger.take(free)
            finger.continuation.advance(np.array(TENSIONS) + sign * 1e-3 * np.eye(2)[k], None)
            reaches.append(finger.problem.reach())
        by_tensions.append((reaches[1] - reaches[0]) / 2e-3)
    finger.take(free)
    found = differentiate(finger.problem, finger.continuation.linearise()).touch_distance
    assert found == pytest.approx(by_tensions, rel=1e-4)


AHEAD = {
    "plane": {"centre": [0.05, 0.0, 0.0], "normal": [-1.0, 0.0, 0.0]},
    "sphere": {"shape": "sphere", "centre": [0.06, 0.0, 0.0], "radius": 0.01, "direction": [1.0, 0.0, 0.0]},
    "cylinder": {
        "shape": "cylinder",
        "centre": [0.06, 0.0, 0.0],
        "radius": 0.01,
        "axis": [0.0, 0.0, 1.0],
        "direction": [1.0, 0.0, 0.0],
    },
    "box": {
        "shape": "box",
        "centre": [0.06, 0.0, 0.0],
        "sides": [0.02, 0.02, 0.02],
        "rounding": 0.002,
        "direction": [1.0, 0.0, 0.0],
    },
}


@pytest.mark.long
@pytest.mark.parametrize(
    "shape", ["plane", *(pytest.param(one, marks=pytest.mark.long) for one in AHEAD if one != "plane")]
)
def test_an_obstacle_ahead_of_the_straight_finger_compresses_it(shape, table):
    table["mesh"]["cells"], table["obstacle"] = [10, 5], table["obstacle"] | {"distance": [-0.001, 0.01]}
    finger, pushed = model(table, **AHEAD[shape]), 1e-4  # [m]
    free = finger.solve([0.0, 0.0])
    assert free.touch_distance == pytest.approx(0.0, abs=1e-7)  # a round one is nearest between the points looked at
    state = finger.solve([0.0, 0.0], -pushed)
    stiffness = finger.scene.law.young_modulus * 0.010**2 / 0.049  # [N/m] of the rubber
    assert state.contact_force == pytest.approx(stiffness * pushed, rel=0.1)
    assert state.tip == pytest.approx([-pushed, 0, 0], abs=0.1 * pushed)
    assert state.clamp_reaction == pytest.approx([state.contact_force, 0, 0], rel=1e-6, abs=1e-6)


@pytest.mark.long
def test_an_obstacle_that_is_passed_by_presses_nothing(table):
    finger = model(table, shape="sphere", centre=[0.05, 0.02, 0.2], radius=0.01)
    state = finger.solve(TENSIONS, D)
    assert state.contact_force == 0.0 and state.touch_distance is None and state.penetration == 0.0


@pytest.mark.long
def test_half_the_finger_is_modelled_where_the_obstacle_is_its_own_mirror_image(table):
    table["tendons"] = table["tendons"][:1]
    sphere = {"shape": "sphere", "centre": [0.042, 0.017, 0.0], "radius": 0.012}
    half = model(table, **sphere)
    whole = model(table | {"mesh": table["mesh"] | {"symmetry": False}}, **sphere)
    assert half.scene.is_half and half.problem.unknowns < 0.7 * whole.problem.unknowns
    touch = half.solve([50.0]).touch_distance
    ours, theirs = (one.solve([50.0], touch - 0.001) for one in (half, whole))
    assert ours.contact_force == pytest.approx(theirs.contact_force, rel=1e-6)
    assert not model(table, **sphere | {"centre": [0.042, 0.017, 0.001]}).scene.is_half


def test_only_the_facing_plane_is_trained_on(table):
    scene = model(table, shape="sphere", centre=[0.042, 0.017, 0.0], radius=0.012).scene
    with pytest.raises(SceneError, match=r"obstacle must be the plane .* to train on it, got another sphere"):
        describe(scene, versions())
