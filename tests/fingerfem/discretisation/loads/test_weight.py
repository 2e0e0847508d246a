"""Weight: closed forms, balance of forces, the potential's derivative, and directions."""

import numpy as np
import pytest
from pydantic import ValidationError

from fingerfem import FingerModel
from fingerfem.scene.scene import Scene

RHO, STEEL = 1070.0, 7850.0  # [kg/m^3]


def weighed(table: dict, direction, **changes) -> FingerModel:
    gravity = {"density": RHO, "plate_density": STEEL, "direction": list(direction)} | changes
    table.pop("obstacle", None)
    return FingerModel(Scene.model_validate(table | {"gravity": gravity}))


def mass(model: FingerModel) -> float:
    geometry = model.scene.geometry
    return geometry.side**2 * (RHO * (geometry.length - geometry.plate) + STEEL * geometry.plate)


def test_the_clamp_carries_weight_and_no_other_force(table):
    model = weighed(table, (0.3, -0.5, 0.8))
    state = model.solve([20.0, 5.0])
    weight = mass(model) * model.scene.gravity.vector
    assert state.clamp_reaction == pytest.approx(-weight, rel=1e-6, abs=1e-9 * model.problem.force_scale)
    assert np.linalg.norm(weight) > 0.05


def test_a_hanging_bar_of_poisson_s_ratio_zero_stretches_by_its_closed_form(table):
    """u = g (rho L^2 / 2 + m L / A) / E at the plate, whose mass m hangs below rubber of length L; small strains."""
    E = 1e6
    table["material"] = {"law": "saint-venant-kirchhoff", "E": E, "nu": 0.0}
    model = weighed(table, (1, 0, 0), acceleration=1e-3)
    geometry = model.scene.geometry
    L = geometry.length - geometry.plate
    expected = 1e-3 * (RHO * L**2 / 2 + STEEL * geometry.plate * L) / E
    assert model.solve([0.0, 0.0]).tip[0] == pytest.approx(expected, rel=2e-4)  # steel's own stretch is 1e-6 of it


@pytest.mark.long
def test_a_slender_bar_sags_by_its_closed_form(table):
    """Euler and Bernoulli's with Timoshenko's shear, w = q L^4 / 8 EI + q L^2 / 2 GA k, and the plate's weight."""
    E, length, side, g = 1e6, 0.2, 0.01, 1e-3
    table["geometry"] = {"side": side, "segments": [length], "plate": 0.0002}
    table["material"] = {"law": "saint-venant-kirchhoff", "E": E, "nu": 0.0}
    table["mesh"] = {"cells": [80, 5], "order": 2}
    model = weighed(table, (0, 1, 0), acceleration=g)
    L, I, q, P = length - 0.0002, side**4 / 12, RHO * g * side**2, STEEL * g * side**2 * 0.0002  # noqa: E741
    shear = E / 2 * side**2 * 5 / 6
    expected = q * L**4 / (8 * E * I) + q * L**2 / (2 * shear) + P * L**3 / (3 * E * I) + P * L / shear
    assert model.solve([0.0, 0.0]).tip[1] == pytest.approx(expected, rel=2e-3)


def test_more_gravity_changes_the_potential_by_the_centre_of_mass_s_fall(table):
    """dP/da = -(density, displacement): Hellmann and Feynman."""
    step, potentials = 0.5, []
    for a in (9.0 - step, 9.0, 9.0 + step):
        model = weighed(table, (0, -1, 0), acceleration=a)
        potentials.append(model.solve([30.0, 0.0], sensitivities=False).energy)
        if a == 9.0:
            own = model.problem.displacement[: len(model.problem._weight)]
            fallen = model.problem.summed(model.problem._weight @ own) / a
    assert np.ptp(potentials) / (2 * step) == pytest.approx(abs(fallen), rel=1e-4)
    assert (potentials[2] - potentials[0]) * fallen < 0


def test_a_finger_that_bends_down_bends_sideways_by_the_same_when_gravity_turns(table):
    table["mesh"] = table["mesh"] | {"symmetry": False}
    table["material"] = {"law": "neo-hookean", "E": 3e5, "nu": 0.3}
    down, aside = (weighed(table, direction).solve([0.0, 0.0]).tip for direction in ((0, -1, 0), (0, 0, -1)))
    assert abs(down[1]) > 1e-3 and aside == pytest.approx([down[0], 0.0, down[1]], abs=1e-9)


@pytest.mark.long
def test_the_softest_rubber_sags_until_its_tip_hangs(table):
    """Modulus 5 kPa, length 100 mm."""
    table["geometry"] = {"side": 0.02, "segments": [0.1], "plate": 0.002}
    table["material"] = {"law": "yeoh", "C1": 5e3, "C2": 1e2, "D1": 4e-6}
    table["tendons"] = [one | {"offset": [2 * value for value in one["offset"]]} for one in table["tendons"]]
    model = weighed(table, (0, -1, 0))
    state = model.solve([0.0, 0.0])
    assert state.tip[1] < -0.07 and state.stable
    assert state.clamp_reaction[1] == pytest.approx(mass(model) * 9.80665, rel=1e-6)


def test_densities_of_either_table_are_the_same_weight(table):
    one = weighed(table, (0, -1, 0)).solve([5.0, 0.0], sensitivities=False)
    own = table | {"density": {"rubber": RHO, "plates": STEEL}, "gravity": {"direction": [0.0, -1.0, 0.0]}}
    other = FingerModel(Scene.model_validate(own)).solve([5.0, 0.0], sensitivities=False)
    assert other.tip == pytest.approx(one.tip, rel=1e-12)


@pytest.mark.parametrize(
    ("changes", "rule"),
    [
        ({"gravity": {"density": RHO, "direction": [0.0, 0.0, 0.0]}}, "direction must have a length from 1e-6 to 1e6"),
        ({"gravity": {"density": 0.0, "direction": [0.0, 1.0, 0.0]}}, "greater than or equal to 10"),
        (
            {"gravity": {"density": RHO, "direction": [0.0, 0.0, 1.0]}, "mesh": {"cells": [20, 5], "symmetry": True}},
            "mesh.symmetry must be false where obstacle or weight is not its own mirror image|off the plane z = 0",
        ),
        (
            {"gravity": {"density": RHO, "direction": [0.0, 1.0, 0.0]}, "load": {"force": 5.0}},
            "gravity must be left out of a scene with a load",
        ),
        (
            {"gravity": {"direction": [0.0, 1.0, 0.0]}},
            "gravity.density must be given, or a table",
        ),
        (
            {"density": {"rubber": RHO}, "gravity": {"density": RHO, "direction": [0.0, 1.0, 0.0]}},
            "gravity.density must be left out where .density. has it, got 1070",
        ),
    ],
)
def test_weight_that_a_scene_cannot_have_is_refused(table, changes, rule):
    table.pop("obstacle", None)
    with pytest.raises(ValidationError, match=rule):
        Scene.model_validate(table | changes)
