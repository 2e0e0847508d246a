"""The tactile pad: its pressure and derivatives, of a state and in a set."""

import numpy as np
import pytest
from farm import run

from fingerfem import FingerModel, load_scene
from fingerfem.equilibrium.sensitivities import differentiate
from rom.dataset.snapshot_set import SnapshotSet

AREA = 0.001 * 0.010  # [m^2]


def test_the_pressures_derivatives_are_those_of_finite_differences(spatial, tmp_path):
    file = tmp_path / "pad.toml"
    file.write_text(spatial.read_text() + 'store = ["pad_pressure"]\n')
    model, tensions, distance = FingerModel(load_scene(file)), np.array([93.0, 95.0]), 0.0014
    state = model.solve(tensions, distance)
    assert 0.05 < state.pad_pressure * AREA / state.contact_force < 0.95  # the rubber touches too, beside the pad
    slopes = differentiate(model.problem, model.continuation.linearise()).pad_pressure
    for j, h in enumerate((1e-3, 1e-3, 1e-7)):
        low, high = (
            model.solve(tensions + side * h * np.eye(3)[j, :2], distance + side * h * (j == 2), sensitivities=False)
            for side in (-1, 1)
        )
        assert slopes[j] == pytest.approx((high.pad_pressure - low.pad_pressure) / (2 * h), rel=1e-3)


@pytest.mark.long
def test_a_pad_under_everything_presses_with_the_contact_force_over_its_area(scene, tmp_path):
    """Here the pad is the whole face of the plate, and the rubber does not touch."""
    file = tmp_path / "pad.toml"
    file.write_text(scene.read_text() + 'store = ["pad_pressure"]\n')
    run(2, file, tmp_path / "set")
    states = SnapshotSet(tmp_path / "set")
    force, pressure = states.contact("contact_force"), states.contact("pad_pressure")
    slopes, by = states.contact("contact_force_jacobian"), states.contact("pad_pressure_jacobian")
    assert (force > 0.5).sum() > 10
    reached = np.isfinite(force)
    assert pressure[reached] * AREA == pytest.approx(force[reached], rel=1e-6, abs=1e-9)
    assert by[reached] * AREA == pytest.approx(slopes[reached], rel=1e-6, abs=1e-6 * np.abs(slopes[reached]).max())
