"""A finger with mass as a plant: it comes to the model's force, later than the pull; its failures have a reason."""

import numpy as np
import pytest

from control.plant import Flaws, MovingPlant, SimulatedPlant
from rom import MovingFinger
from rom.files.checked_file import ModelError

DENSITY, PLANE, PULL = 1100.0, 0.003, [20.0, 0.0]  # [kg/m^3], [m], [N]


def test_the_force_comes_after_the_pull_and_is_the_model_s_at_the_end(model):
    plant = MovingPlant(model, PLANE, DENSITY, Flaws(period=2e-3), steps=2)
    felt = np.array([plant.pull(PULL) for _ in range(600)])
    wanted = model.evaluate([*PULL, PLANE]).contact_force
    assert felt[0] == 0.0 < wanted
    assert felt.max() > 1.05 * wanted  # it swings
    assert felt[-300:].mean() == pytest.approx(wanted, rel=0.01)
    assert felt[-300:].std() < felt[:300].std()
    assert plant.state.time == pytest.approx(1.2)


def test_flaws_of_the_sensor_are_in_what_is_felt_alone(model):
    plant = MovingPlant(model, PLANE, DENSITY, Flaws(noise=0.1, delay=3), seed=2)
    felt = [plant.pull(PULL) for _ in range(20)]
    assert plant.contact_force != felt[-1] and plant.age == pytest.approx(3e-3)


def test_a_pull_out_of_the_domain_and_a_finger_without_density_are_refused(model):
    with pytest.raises(ValueError, match="got out_of_domain at"):
        MovingPlant(model, PLANE, DENSITY).pull([200.0, 0.0])
    with pytest.raises(ModelError, match="density must be given"):
        MovingPlant(model, PLANE)


def test_friction_of_the_tendons_is_that_of_the_moving_finger_and_refused_without_mass(model):
    plants = [MovingPlant(model, PLANE, DENSITY, Flaws(friction=one)) for one in (0.0, 0.2)]
    own = MovingFinger(model, [0.0, 0.0, PLANE], DENSITY, friction=0.2)
    for k in range(10):
        pulled = [2.0 * k, 0.0]
        for plant in plants:
            plant.pull(pulled)
        assert plants[1].state.tip == pytest.approx(own.step([*pulled, PLANE], 1e-3).tip, abs=1e-12)
    assert np.linalg.norm(plants[1].state.tip - plants[0].state.tip) > 1e-5
    with pytest.raises(ValueError, match=r"flaws\.friction must be 0 except in a MovingPlant, got 0.2"):
        SimulatedPlant(model, PLANE, Flaws(friction=0.2))
    with pytest.raises(ValueError, match="friction must be finite and at least 0, got nan"):
        Flaws(friction=np.nan)
