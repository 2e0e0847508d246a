"""Where a finger stands on the plane: forces add up, derivatives are differences, a half says what the whole says."""

import numpy as np
import pytest

from fingerfem import FingerModel
from fingerfem.equilibrium.sensitivities import differentiate
from fingerfem.scene.scene import Scene
from fingerfem.snapshots.plate_contact import PlateContact, PlateContacts

CORNER, EDGE, ARCH, FACE = ([60, 25], 0.012), ([60, 0], 0.012), ([100, 100], 0.001), ([100, 2], 0.021)


def sensitivities(model):
    return differentiate(model.problem, model.continuation.linearise())


def stand(model, tensions, distance) -> PlateContact:
    model.continuation.rest()
    model.continuation.advance(np.array(tensions, float), None)
    model.continuation.advance(np.array(tensions, float), distance)
    return PlateContacts(model.problem).at(sensitivities(model).displacement)


@pytest.mark.parametrize(
    ("state", "regime"),
    [
        (CORNER, [1, 1, 1, -1, 0]),
        (EDGE, [1, 1, 1, 0, 0]),
        (FACE, [1, 1, 0, 0, 0]),
        (ARCH, [1, 1, 1, -1, 1]),
    ],
    ids=["corner", "edge", "face", "arch"],
)
def test_the_plate_and_the_rubber_carry_the_contact_force(draft, state, regime):
    found = stand(draft, *state)
    force = draft.problem.contact.force()
    assert found.regime.tolist() == regime
    if not found.regime[-1]:
        assert found.plate_force.sum() == pytest.approx(force, rel=1e-9)
    else:
        assert 0 < found.plate_force.sum() < 0.9 * force
    assert np.all(np.abs(found.centre_of_pressure) <= 1 + 1e-12)
    # A rigid plate sees the plane's normal as a unit vector.
    assert np.linalg.norm(found.plate_tilt, axis=1) == pytest.approx(1.0, abs=1e-4)


def test_the_centre_of_pressure_balances_the_moments_of_the_nodes_forces(draft):
    """The moment of the plate's forces about its own z is force times centre: here summed node by node."""
    found = stand(draft, *FACE)
    forces = draft.problem.contact.nodal_force()[:, 1]
    points = draft.problem.space.tabulate_dof_coordinates()
    plate = points[:, 0] > 0.049 - 1e-9
    centre = forces[plate] @ points[plate, 1] / forces[plate].sum() / 0.005
    assert found.centre_of_pressure[0, 1] == pytest.approx(centre, rel=1e-9)
    assert -1 < centre < 1


@pytest.mark.parametrize("state", [CORNER, FACE, ARCH], ids=["corner", "face", "arch"])
def test_derivatives_are_differences(draft, state):
    tensions, distance = np.array(state[0], float), state[1]
    found = stand(draft, tensions, distance)
    plates = PlateContacts(draft.problem)
    for j, h in enumerate((1e-3, 1e-3, 1e-7)):
        sides = []
        for sign in (1, -1):
            moved = np.append(tensions, distance) + sign * h * np.eye(3)[j]
            draft.continuation.advance(moved[:2], moved[2])
            sides.append(plates.at(sensitivities(draft).displacement))
            draft.continuation.advance(tensions, distance)
        for name, slopes in found.jacobians.items():
            difference = (getattr(sides[0], name) - getattr(sides[1], name)) / (2 * h)
            size = np.abs(difference).max()
            assert slopes[..., j] == pytest.approx(difference, rel=1e-4, abs=1e-5 * size + 1e-9), name


def test_half_a_finger_stands_as_a_whole_one(table):
    table["tendons"] = table["tendons"][:1]
    table["mesh"]["cells"] = [10, 6]
    both = []
    for symmetry in (True, False):
        table["mesh"]["symmetry"] = symmetry
        both.append(stand(FingerModel(Scene.model_validate(table)), [60], 0.012))
    half, whole = both
    assert half.regime.tolist() == whole.regime.tolist() == [1, 1, 1, 0, 0]
    for name in ("plate_height", "plate_tilt", "plate_force", "centre_of_pressure", "rubber_reach"):
        assert getattr(half, name) == pytest.approx(getattr(whole, name), abs=5e-5)  # steel yields so much


def test_in_free_space_no_plate_carries_and_its_corners_are_as_high_as_the_mesh_says(draft):
    draft.continuation.rest()
    draft.continuation.advance(np.array([70.0, 20.0]), None)
    found = PlateContacts(draft.problem).at(sensitivities(draft).displacement)
    assert not found.regime.any() and not found.plate_force.any() and not found.centre_of_pressure.any()
    highest = found.plate_height[0] + np.abs(found.plate_tilt[0]) @ [0.0005, 0.005, 0.005]
    assert highest == pytest.approx(draft.problem.reach(), abs=2e-6)  # steel yields so much
