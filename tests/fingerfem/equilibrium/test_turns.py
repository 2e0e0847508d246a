"""Steps are measured by the rotation of a slender finger: closed forms of a beam of rubber."""

import numpy as np
import pytest

from fingerfem import FingerModel
from fingerfem.equilibrium.steps import Loads
from fingerfem.equilibrium.turns import turns
from fingerfem.scene.scene import Scene


def test_turns_are_those_of_a_beam_and_of_the_axial_strain(draft):
    """F e L / EI + F / EA, w L^2 / 2 EI, m L / EI."""
    found, law, side = turns(draft.problem), draft.scene.law, 0.010
    bending, axial = law.young_modulus * side**4 / 12, law.young_modulus * side**2
    assert found.actuators == pytest.approx(np.full(2, 0.004 * 0.05 / bending + 1 / axial), rel=1e-12)
    assert found.wrench == pytest.approx(np.repeat([0.05**2 / 2, 0.05], 3) / bending, rel=1e-12)
    assert found.weight == 0.0


def test_weight_turns_by_its_heaviest_part(table):
    """Q L^3 / 6 EI of a beam as heavy everywhere as its heaviest material."""
    table.pop("obstacle")
    layer = {"name": "joint", "region": "section", "x": [0.01, 0.03], "density": 9000.0, "material": table["material"]}
    gravity = {"density": 1000.0, "plate_density": 2000.0, "direction": [0.0, 1.0, 0.0]}
    problem = FingerModel(Scene.model_validate(table | {"gravity": gravity, "materials": [layer]})).problem
    bending = problem.law.young_modulus * 0.010**4 / 12
    expected = 9000.0 * 9.80665 * 0.010**2 * 0.05**3 / 6 / bending
    assert turns(problem).weight == pytest.approx(expected, rel=1e-12)


def test_loads_on_a_straight_path_end_at_the_target_itself():
    begin = Loads(np.array([1.0, 2.0]), None, np.zeros((1, 6)), 0.0)
    end = Loads(np.array([3.0, 2.0]), 0.02, np.ones((1, 6)), 1.0)
    half = begin.towards(end, 0.5)
    assert begin.towards(end, 1.0) is end
    assert half.tensions.tolist() == [2.0, 2.0] and half.weight == 0.5 and (half.wrenches == 0.5).all()
    assert half.distance == 0.02  # an obstacle that was away has no path
    assert begin._replace(distance=0.04).towards(end, 0.5).distance == pytest.approx(0.03)
