"""Deformations beyond what the rubber's law is good for are no answers."""

import numpy as np
import pytest
from scipy.optimize import brentq

from fingerfem import FingerModel, LoadNotReached
from fingerfem.scene.scene import Scene

E, AREA = 9.88e6, 1e-4  # [Pa], [m^2]
STRONGEST = E * AREA / 27**0.5  # largest compressive force of the law, at a stretch of 1/sqrt(3) [N]


@pytest.fixture
def saint_venant_kirchhoff(table):
    table["material"] = {"law": "saint-venant-kirchhoff", "E": E, "nu": 0.3}
    table["tendons"] = table["tendons"][:1]
    return table


@pytest.fixture
def compressed(saint_venant_kirchhoff):
    """A finger that two opposite tendons shorten."""
    one = saint_venant_kirchhoff["tendons"][0]
    saint_venant_kirchhoff["tendons"].append(one | {"name": "F3", "offset": [-0.004, 0.0]})
    return FingerModel(Scene.model_validate(saint_venant_kirchhoff))


def middle_stretch(model: FingerModel) -> float:
    """Stretch between two sections of the finger's middle [-]."""
    x = model.problem.space.tabulate_dof_coordinates()[:, 0]
    u = model.problem.displacement.reshape(-1, 3)[:, 0]
    sections = np.unique(x.round(6))
    a, b = (sections[np.argmin(abs(sections - at))] for at in (0.015, 0.035))
    moved = [u[abs(x - at) < 1e-4].mean() for at in (a, b)]
    return 1 + (moved[1] - moved[0]) / (b - a)


@pytest.mark.parametrize("share", [0.4, 0.8, 0.95])
def test_saint_venant_kirchhoff_in_compression_follows_its_closed_form_up_to_its_limit(compressed, share):
    """E A (l - l^3) / 2 = F1 + F3; the section is held at clamp and plate alone."""
    pull = share * STRONGEST / 2
    compressed.solve([pull, pull], sensitivities=False)
    stretch = brentq(lambda s: E * AREA * (s - s**3) / 2 - 2 * pull, 3**-0.5, 1.0)
    assert middle_stretch(compressed) == pytest.approx(stretch, rel=0.015)


@pytest.mark.long
def test_saint_venant_kirchhoff_at_half_its_length_is_refused_with_its_limit(compressed):
    with pytest.raises(LoadNotReached, match=r"compressed to a stretch of 0\.5\d+, below 0\.5774") as caught:
        compressed.solve([100.0, 100.0])
    assert 0.97 * STRONGEST < caught.value.tensions.sum() < STRONGEST
    assert compressed.problem.limits.extreme_stretches()["rubber"][0] >= 3**-0.5


@pytest.mark.long
def test_saint_venant_kirchhoff_beyond_its_limit_in_a_part_of_the_finger_is_refused(saint_venant_kirchhoff):
    """Bending compresses one side alone."""
    model = FingerModel(Scene.model_validate(saint_venant_kirchhoff))
    with pytest.raises(LoadNotReached, match=r"compressed to a stretch of 0\.5\d+, below 0\.5774"):
        model.solve([100.0])
    assert model.problem.limits.extreme_stretches()["rubber"][0] >= 3**-0.5


def test_neo_hookean_rubber_has_no_least_stretch(draft):
    draft.solve([100.0, 0.0], sensitivities=False)
    assert draft.problem.limits.extreme_stretches() == {}
    assert draft.problem.limits.exceeded() is None
