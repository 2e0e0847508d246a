"""Reports of a state: plain data, the state at rest, and shortenings of a homogeneous deformation in closed form."""

import json
from types import SimpleNamespace

import numpy as np
import pytest

from fingerfem.equilibrium.state import State, _contact, channel_shortening, stretches

NEEDED = {
    "parameters": {"F1": 1.0},
    "displacement": np.zeros(9),
    "tip": np.array([1.0, 2.0, 3.0]),
    "clamp_reaction": np.zeros(3),
    "channel_shortening": {"F1": 0.5},
    "energy": 1.0,
    "smallest_volume_ratio": 0.9,
    "self_intersecting": False,
    "newton_iterations": 3,
    "steps": 1,
    "strategies": {"mixed": 1},
    "seconds": 0.1,
    "unknowns": 9,
}


@pytest.fixture(scope="module")
def at_rest(draft) -> State:
    return draft.solve([0.0, 0.0])


def test_plain_data_has_no_fields_and_leaves_out_what_a_scene_does_not_have():
    """Zero and False are known quantities."""
    nested = {"tip": {"F1": np.ones(3)}}
    state = State(**NEEDED, sensitivities=nested, displacement_sensitivities={"F1": np.ones(9)}, contact_force=0.0)
    found = json.loads(json.dumps(state.as_json(), allow_nan=False))
    assert found["tip"] == [1.0, 2.0, 3.0] and found["sensitivities"] == {"tip": {"F1": [1.0, 1.0, 1.0]}}
    assert found["contact_force"] == 0.0 and found["self_intersecting"] is False and found["converged"] is True
    assert not {"displacement", "displacement_sensitivities", "pad", "stable", "wrenches", "stretches"} & set(found)
    assert set(NEEDED) - {"displacement"} <= set(found)


def test_a_state_is_marked_by_the_materials_that_are_beyond_their_data_and_stretches_are_of_all_with_data():
    def problem(**found):
        return SimpleNamespace(limits=SimpleNamespace(beyond_data=lambda: found))

    within, beyond = ((0.8, 1.5), False), ((0.9, 2.01), True)
    assert stretches(problem()) == {}
    one = {"stretches": [0.8, 1.5], "beyond_data": False, "guesses": None}
    assert stretches(problem(rubber=within)) == one
    several = {"stretches": [0.8, 2.01], "beyond_data": True, "guesses": {"paper": [0.9, 2.01]}}
    assert stretches(problem(rubber=within, paper=beyond)) == several
    assert State(**NEEDED, **several).marks == [
        "the law of paper is a guess at stretches of 0.9 to 2.01: see material.stretches"
    ]


def test_complementarity_is_the_pressure_s_work_over_force_and_side_and_zero_without_a_force():
    def problem(forces, distance=0.01):
        contact = SimpleNamespace(forces=lambda: np.array(forces), gap_work=lambda: 6e-6)
        scene = SimpleNamespace(obstacle=SimpleNamespace(pad=None), geometry=SimpleNamespace(side=0.01))
        return SimpleNamespace(contact=contact, scene=scene, distance=distance, penetration=lambda: 2e-6)

    one, two = _contact(problem([3.0])), _contact(problem([1.0, 2.0]))
    assert one == {"contact_force": 3.0, "penetration": 2e-6, "complementarity": pytest.approx(2e-4)}
    assert two["contact_forces"].tolist() == [1.0, 2.0] and two["contact_force"] == 3.0
    assert _contact(problem([0.0]))["complementarity"] == 0.0
    assert _contact(problem([0.0], None)) == {"contact_force": 0.0}


def test_at_rest_nothing_has_moved_and_the_plane_touches_at_no_distance(at_rest):
    assert np.abs(at_rest.tip).max() < 1e-15 and np.abs(at_rest.clamp_reaction).max() < 1e-9
    assert at_rest.energy == pytest.approx(0.0, abs=1e-15) and at_rest.smallest_volume_ratio == pytest.approx(1.0)
    assert at_rest.touch_distance == pytest.approx(0.0, abs=1e-12) and at_rest.stable is True
    assert at_rest.contact_force == 0.0 and "d" not in at_rest.sensitivities["tip"]
    assert at_rest.parameters == {"F1": 0.0, "F2": 0.0} and not at_rest.self_intersecting


def test_sensitivities_at_rest_are_mutual_and_those_of_the_finger_s_symmetry(at_rest):
    """A tension shortens another's channel as that one does its own; y and z exchange the tendons."""
    by = at_rest.sensitivities["channel_shortening"]
    assert by["F1"]["F2"] == pytest.approx(by["F2"]["F1"], rel=1e-9)
    assert by["F1"]["F1"] == pytest.approx(by["F2"]["F2"], rel=1e-6) and by["F1"]["F1"] > abs(by["F1"]["F2"])
    one, other = (at_rest.sensitivities["tip"][name] for name in ("F1", "F2"))
    assert one == pytest.approx(other[[0, 2, 1]], rel=1e-6, abs=1e-9 * np.abs(one).max()) and one[1] > 0


def test_a_stretched_finger_s_tendons_are_longer_by_the_stretch(draft):
    """A channel ends before its plate, 1 mm from the tip; a turn of the whole finger adds nothing."""
    rest, kept = draft.problem.space.tabulate_dof_coordinates(), draft.problem.displacement.copy()
    try:
        draft.problem.displacement[:] = (rest * [0.02, -0.01, 0.03]).ravel()
        assert channel_shortening(draft.problem) == pytest.approx([-0.02 * 0.049] * 2)
        turned = rest @ np.array([[0.0, 0, 1], [1, 0, 0], [0, 1, 0]])
        draft.problem.displacement[:] = (turned - rest).ravel()
        assert channel_shortening(draft.problem) == pytest.approx([0.0, 0.0], abs=1e-12)
    finally:
        draft.problem.displacement[:] = kept
