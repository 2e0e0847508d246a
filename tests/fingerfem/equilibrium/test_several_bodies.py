"""Several bodies at once: symmetry, one that is away, energy, balance, and rules that they share."""

import pytest

from fingerfem import FingerModel
from fingerfem.scene.scene import Scene, SceneError
from fingerfem.snapshots.design import describe
from fingerfem.versions import versions

ABOVE = {"shape": "sphere", "centre": [0.046, 0.018, 0.0], "radius": 0.012}
BELOW = {"shape": "sphere", "centre": [0.046, -0.018, 0.0], "radius": 0.012, "direction": [0.0, -1.0, 0.0]}
POST = {"shape": "cylinder", "centre": [0.025, -0.018, 0.0], "radius": 0.012, "axis": [0.1, 0.0, 1.0]}
POST |= {"direction": [0.2, -1.0, 0.0]}
FAR = POST | {"centre": [0.025, -0.1, 0.0]}
RANGE = {"distance": [-0.01, 0.03], "method": "penalty"}


def model(table: dict, first: dict, *others: dict, **more: object) -> FingerModel:
    return FingerModel(Scene.model_validate(table | {"obstacle": RANGE | first | {"others": list(others)} | more}))


@pytest.fixture(scope="module")
def draft():
    import tomllib

    from farm import ROOT

    return tomllib.loads((ROOT / "scenes" / "draft.toml").read_text())


@pytest.fixture(scope="module")
def pressed(draft):
    """A finger between a ball and a post, both of which press."""
    finger = model(draft, ABOVE, POST)
    return finger, finger.solve([6.0, 0.0], -0.0013)


def test_two_balls_that_squeeze_a_finger_press_alike(draft):
    finger = model(draft | {"tendons": draft["tendons"][:1]}, ABOVE, BELOW)
    state = finger.solve([0.0], -0.0015)
    above, below = state.contact_forces
    assert finger.scene.is_half and above > 1 and above == pytest.approx(below, rel=1e-6)
    assert state.contact_force == pytest.approx(above + below) and abs(state.tip[1]) < 1e-8
    assert state.clamp_reaction[1] == pytest.approx(0, abs=1e-5 * above)


@pytest.mark.long
def test_a_body_that_is_away_changes_nothing(draft):
    alone, among = (finger.solve([50.0, 20.0], 0.004) for finger in (model(draft, ABOVE), model(draft, ABOVE, FAR)))
    assert alone.contact_forces is None and among.contact_forces[1] == 0
    assert among.contact_force == pytest.approx(alone.contact_force, rel=1e-9) and alone.contact_force > 0.1
    assert among.touch_distance == alone.touch_distance
    for name, slope in alone.sensitivities["contact_force"].items():
        assert among.sensitivities["contact_force"][name] == pytest.approx(slope, rel=1e-6)


@pytest.mark.long
def test_forces_are_those_of_the_energy_and_balance_the_clamp(pressed):
    finger, state = pressed
    assert (state.contact_forces > 0.05).all() and state.stable
    problem, step, found = finger.problem, 1e-6, []
    finger.take(state)
    pushed = problem.contact.nodal_force().sum(axis=0)
    assert state.clamp_reaction[:2] == pytest.approx(pushed[:2], abs=1e-8 * problem.force_scale)
    along = [one.direction for one in problem.bodies]
    assert along[0] != along[1] and 0 < state.penetration < 2e-5
    for sign in (-1, 1):
        finger.take(state)
        finger.continuation.advance([6.0, 0.0], state.parameters["d"] + sign * step)
        found.append((problem.energy(), problem.contact.force()))
    energy, force = ((after - before) / (2 * step) for before, after in zip(*found, strict=True))
    assert -energy == pytest.approx(state.contact_force, rel=1e-5)
    assert force == pytest.approx(state.sensitivities["contact_force"]["d"], rel=2e-3)


@pytest.mark.long
def test_a_plane_beside_a_ball_is_the_plane_alone(draft):
    plane = {"shape": "plane", "centre": [0.0, 0.005, 0.0]}
    alone, among = (model(draft, plane, *others).solve([50.0, 20.0], 0.010) for others in ((), (FAR,)))
    assert among.contact_forces[0] == pytest.approx(alone.contact_force, rel=0.02) and alone.contact_force > 1
    assert among.touch_distance == pytest.approx(alone.touch_distance, rel=1e-9)


def test_several_bodies_are_written_as_they_are_read_and_wrong_ones_refused(draft):
    scene = model(draft, ABOVE, POST).scene
    table = scene.model_dump(mode="json")
    assert table["obstacle"]["others"][0]["radius"] == 0.012 and Scene.model_validate(table) == scene
    assert "others" not in Scene.model_validate(draft).model_dump(mode="json")["obstacle"]
    with pytest.raises((SceneError, ValueError), match="radius must be given for a sphere"):
        model(draft, ABOVE, {"shape": "sphere", "centre": [0.0, 0.1, 0.0]})
    with pytest.raises((SceneError, ValueError), match="pad must be left out"):
        model(draft, {"shape": "plane"}, POST, distance=[0.001, 0.03], pad=draft["obstacle"]["pad"])


@pytest.mark.long
def test_several_bodies_are_not_trained_on(draft):
    scene = model(draft, {"shape": "plane"}, POST, distance=[0.001, 0.03]).scene
    with pytest.raises(SceneError, match=r"obstacle must be the plane .* to train on it, got 2 bodies"):
        describe(scene, versions())
