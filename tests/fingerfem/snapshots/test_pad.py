"""The tactile pad, from states to control: pressure, derivatives, surrogate, and what is held by it."""

import numpy as np
import pytest
from farm import run

from control import Finger, Limits
from fingerfem import FingerModel, load_scene
from fingerfem.equilibrium.sensitivities import differentiate
from rom import Surrogate
from rom.build import train
from rom.export.c_header import header
from rom.held_out import check
from rom.separated.alternating_directions import EnrichmentOptions
from rom.snapshots.snapshot_set import SnapshotError, SnapshotSet

AREA = 0.001 * 0.010  # [m^2]


@pytest.fixture(scope="module")
def whole(spatial, tmp_path_factory):
    """A surrogate of a finger whose pad is the whole face of the plate."""
    folder = tmp_path_factory.mktemp("pad")
    file = folder / "pad.toml"
    file.write_text(spatial.read_text().split("[sampling]")[0] + '[sampling]\nlines = 20\nstore = ["pad_pressure"]\n')
    run(2, file, folder / "set")
    run(2, file, folder / "fresh", "--random", "10", "--distances", "3", "--seed", "4")
    model = train(SnapshotSet(folder / "set"), EnrichmentOptions())
    model.save(folder / "pad.h5")
    return Surrogate.load(folder / "pad.h5"), SnapshotSet(folder / "fresh")


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


def test_a_pad_that_bears_everything_presses_with_the_contact_force_over_its_area(whole):
    model, fresh = whole
    points = fresh.random("parameters")
    answer = model.evaluate(points)
    alone = np.array([model.regime(p) is not None and not any(model.regime(p).code[4:]) for p in points])
    assert alone.sum() > 10  # only the plate touches
    assert answer.pad_pressure[alone] * AREA == pytest.approx(answer.contact_force[alone], rel=1e-6, abs=1e-9)
    report = check(model, fresh)
    assert report["pad_pressure"]["median"] < 0.05
    assert np.isfinite(answer.error["pad_pressure"]).all() and np.all(
        answer.pad_pressure[answer.contact_force == 0] == 0
    )


def test_the_jacobian_has_a_row_for_it(whole):
    model, _ = whole
    point, steps = np.array([60.0, 20.0, 0.008]), np.array([1e-4, 1e-4, 1e-9])
    row = model.jacobian(point)[5]
    for j, h in enumerate(steps):
        high, low = (float(model.evaluate(point + side * h * np.eye(3)[j]).pad_pressure) for side in (1, -1))
        assert row[j] == pytest.approx((high - low) / (2 * h), rel=1e-4)
    assert model.value_and_jacobian(point)[0].shape == (6,)


def test_a_pressure_is_held_as_the_force_that_makes_it(whole):
    finger = Finger(whole[0])
    pressed, forced = (
        finger.hold(pad_pressure=1e5, distance=0.010),
        finger.hold(contact_force=1e5 * AREA, distance=0.010),
    )
    assert pressed.converged and pressed.tensions == pytest.approx(forced.tensions, abs=1e-3)
    assert pressed.residual <= 1e-6 / AREA and np.isfinite(pressed.error)


def test_what_an_object_bears_limits_what_is_held(whole):
    model, _ = whole
    finger = Finger(model, limits=Limits(pad_pressure=8e4))
    assert finger.hold(contact_force=0.5, distance=0.010).converged
    for motion, missed in (
        (finger.hold(contact_force=1.0, distance=0.010), 0.2),
        (finger.hold(pad_pressure=1e5, distance=0.010), 2e4),
    ):
        assert motion.status == "unreachable" and motion.residual == pytest.approx(missed, rel=1e-4)
        assert model.evaluate([*motion.tensions, 0.010]).pad_pressure == pytest.approx(8e4, rel=1e-4)


def test_the_c_header_of_a_model_with_a_pad_answers_it_too(whole):
    assert "#define finger_ROWS 6" in header(whole[0], "finger")


def test_models_and_sets_that_do_not_know_it_say_so(surrogate, whole, tmp_path):
    with pytest.raises(ValueError, match="model must know its pad's pressure"):
        Finger(surrogate).hold(pad_pressure=1e5, distance=0.010)
    with pytest.raises(ValueError, match="model must know its pad's pressure"):
        Finger(surrogate, limits=Limits(pad_pressure=1e5))
    with pytest.raises(ValueError, match="contact_force or pad_pressure, got None and None"):
        Finger(whole[0]).hold(distance=0.010)
    assert surrogate.evaluate([50.0, 0.0, 0.005]).pad_pressure is None and surrogate.jacobian([50, 0, 0.005]).shape == (
        5,
        3,
    )


def test_a_set_of_an_older_version_is_refused_in_one_line(scene, tmp_path):
    file = tmp_path / "old.toml"
    file.write_text(scene.read_text() + 'store = ["pad_pressure"]\n')
    run(1, file, tmp_path / "set")
    for task in (tmp_path / "set" / "tasks").glob("*.npz"):
        states = dict(np.load(task))
        states.pop("pad_pressure_jacobian")
        np.savez(task, **states)
    with pytest.raises(SnapshotError, match="must have derivatives of pad_pressure"):
        train(SnapshotSet(tmp_path / "set"), EnrichmentOptions())


def test_a_gripper_presses_no_harder_than_its_limit(whole):
    from control import Gripper, SimulatedPlant

    model, _ = whole
    plants = [SimulatedPlant(model, 0.010) for _ in range(3)]
    grasp = Gripper(model, limits=Limits(pad_pressure=5e4)).grasp(1.0, plants)
    assert grasp.status == ["unreachable"] * 3
    assert max(pull.contact_force for pull in grasp.history) / AREA <= 5e4 * 1.01
