"""Contact forces that neither drop nor crush: against closed forms, and against the balance itself."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from control.grasping.grasp_forces import GRAVITY, SIDES, Object, carries, targets

ANGLES = 2 * np.pi * np.arange(3) / 3
THREE = np.column_stack([np.cos(ANGLES), np.sin(ANGLES)])
INSIDE = np.cos(np.pi / SIDES)  # the polygon's share of the circle, where its sides are nearest


def test_hanging_down_every_finger_carries_a_third_of_the_weight():
    held = Object(mass=0.1, friction=0.5, admissible_force=5.0)
    found = targets(THREE, held)
    least = 0.1 * GRAVITY / (3 * 0.5)
    assert found.exist and found.least == pytest.approx(least, rel=1 / INSIDE - 1 + 1e-9)
    assert found.contact_forces == pytest.approx(np.full(3, np.sqrt(found.least * 5.0)))


def test_with_the_weight_in_the_fingers_plane_the_lower_fingers_press_harder():
    held = Object(mass=0.05, friction=0.1, admissible_force=5.0, down=(0.0, -1.0, 0.0))
    found = targets(THREE, held)
    # Friction is small: fingers 1 and 2, 60 degrees below the horizontal, carry the weight against finger 0 above.
    assert found.exist and carries(THREE, held, found.contact_forces)
    assert found.contact_forces[1] == pytest.approx(found.contact_forces[2])
    assert found.contact_forces[1] > found.contact_forces[0]


@given(st.floats(0.001, 0.5), st.floats(0.1, 1.5), st.lists(st.floats(-1, 1), min_size=3, max_size=3))
def test_targets_carry_the_object_and_less_than_the_least_does_not(mass, friction, down):
    if np.linalg.norm(down) < 0.1:
        return
    held = Object(mass=mass, friction=friction, admissible_force=1e3, down=tuple(down))
    found = targets(THREE, held)
    assert found.exist
    assert carries(THREE, held, found.contact_forces)
    assert carries(THREE, held, found.contact_forces / 1.05) and found.contact_forces.max() * 1.05 < 1e3
    assert not carries(THREE, held, np.full(3, 0.99 * found.least) * 0.9)


def test_why_there_are_none_is_said():
    crushed = targets(THREE, Object(mass=1.0, friction=0.2, admissible_force=5.0))
    assert not crushed.exist and np.isnan(crushed.contact_forces).all()
    assert "1 kg at a friction of 0.2 drop below 16.4 N a finger, but are crushed above 5 N" in crushed.reason
    one = targets(THREE[:1], Object(mass=0.1, friction=0.5, admissible_force=5.0))
    assert one.reason == "no contact forces balance its weight" and one.least == np.inf


@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        ({"mass": 0.0}, "mass must be above 0, got 0"),
        ({"friction": np.nan}, "friction must be above 0, got nan"),
        ({"admissible_force": np.inf}, "admissible_force must be above 0, got inf"),
        ({"down": (0.0, 0.0, 0.0)}, "down must be a direction"),
    ],
)
def test_an_object_that_is_none_is_refused(wrong, said):
    with pytest.raises(ValueError, match=said):
        Object(**({"mass": 0.1, "friction": 0.5, "admissible_force": 5.0} | wrong))


def test_a_finger_that_cannot_press_so_hard_where_the_object_is_says_so(table):
    from control import Gripper

    gripper = Gripper(table)
    held = Object(mass=0.2, friction=0.3, admissible_force=8.0)
    assert gripper.targets(held, [0.010, 0.011, 0.012]).exist
    far = gripper.targets(held, [0.010, 0.0305, 0.012])
    assert not far.exist and far.reason.startswith("finger 1 cannot press 4.19 N") and "unreachable" in far.reason


def test_one_finger_carries_what_friction_lets_it():
    held = Object(mass=0.06, friction=0.5, admissible_force=3.0, down=(0.0, 1.0, 0.0))
    found = targets(THREE[:1], held)
    assert not found.exist or carries(THREE[:1], held, found.contact_forces)


@pytest.mark.parametrize("mass", [1e-9, 1e9])
def test_the_lightest_and_the_heaviest_balance_alike(mass):
    held = Object(mass=mass, friction=0.5, admissible_force=1e2 * mass)
    found = targets(THREE, held)
    assert found.exist and carries(THREE, held, found.contact_forces)
    assert found.least == pytest.approx(mass * GRAVITY / 1.5, rel=1 / INSIDE - 1 + 1e-9)


def test_a_margin_that_is_none_is_refused():
    with pytest.raises(ValueError, match="margin must be at least 0, got nan"):
        targets(THREE, Object(mass=0.1, friction=0.5, admissible_force=5.0), margin=np.nan)


def leaning(lean: float) -> np.ndarray:
    """Inward normals of faces that rise by an angle [rad], shape (1, 3, 3)."""
    return np.column_stack([np.full(3, -np.sin(lean)), -np.cos(lean) * THREE])[None]


@pytest.mark.parametrize("lean", [-0.3, -0.1, 0.0, 0.1, 0.3])
def test_faces_that_rise_carry_weight_and_faces_that_fall_add_to_it(lean):
    held = Object(mass=0.1, friction=0.5, admissible_force=50.0, faces=leaning(lean))
    least, highest = (0.1 * GRAVITY / (3 * (mu * np.cos(lean) + np.sin(lean))) for mu in (0.5, 0.5 * INSIDE))
    found = targets(THREE, held)
    assert least * (1 - 1e-9) <= found.least <= highest * (1 + 1e-9)
    assert found.most == 50.0 and carries(THREE, held, found.contact_forces)


def test_an_object_is_pushed_out_above_a_force_where_its_faces_rise_beyond_the_friction():
    lean = 0.6
    held = Object(mass=0.1, friction=0.5, admissible_force=50.0, faces=leaning(lean))
    most, lowest = (0.1 * GRAVITY / (3 * (np.sin(lean) - mu * np.cos(lean))) for mu in (0.5, 0.5 * INSIDE))
    found = targets(THREE, held)
    assert found.exist and lowest * (1 - 1e-9) <= found.most <= most * (1 + 1e-9)
    assert carries(THREE, held, np.full(3, 0.95 * most)) and not carries(THREE, held, np.full(3, 1.05 * most))


def test_forces_hold_in_every_case_of_an_uncertain_pose():
    cases = np.concatenate([leaning(lean) for lean in (-0.2, 0.0, 0.2)])
    held = Object(mass=0.1, friction=0.5, admissible_force=50.0, faces=cases)
    alone = Object(mass=0.1, friction=0.5, admissible_force=50.0, faces=cases[:1])
    assert targets(THREE, held).least == pytest.approx(targets(THREE, alone).least)


def test_faces_that_fall_by_more_than_the_angle_of_friction_are_refused():
    found = targets(THREE, Object(mass=0.01, friction=0.5, admissible_force=50.0, faces=leaning(-0.5)))
    assert found.reason == "no contact forces balance its weight on all faces that fingers may touch"
    beyond = targets(THREE, Object(mass=0.01, friction=0.5, admissible_force=50.0, faces=leaning(np.pi / 2 + 0.1)))
    assert beyond.reason == found.reason
    with pytest.raises(ValueError, match="faces must be of 3 fingers"):
        targets(THREE, Object(mass=0.01, friction=0.5, admissible_force=50.0, faces=leaning(0.0)[:, :2]))
    with pytest.raises(ValueError, match="faces must be finite, of shape"):
        Object(mass=0.01, friction=0.5, admissible_force=50.0, faces=leaning(0.0)[0])


@pytest.mark.parametrize("scale", [1e-200, 1e-6, 1e6, 1e200])
def test_the_direction_of_gravity_may_have_any_length(scale):
    down = (0.3, -0.8, 0.1)
    ours, theirs = (
        targets(THREE, Object(mass=0.05, friction=0.4, admissible_force=5.0, down=one))
        for one in (tuple(scale * part for part in down), down)
    )
    assert theirs.exist and ours.contact_forces == pytest.approx(theirs.contact_forces, rel=1e-9)
