"""The trained draft finger: accuracy on states it never saw, derivatives, continuity, marks, and its file."""

import json
import shutil
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import h5py
import numpy as np
import pytest

from rom import Surrogate
from rom.errors import check
from rom.snapshots import SnapshotError, SnapshotSet
from rom.surrogate import ModelError

ROOT = Path(__file__).resolve().parents[2]
FREE, TOUCHING = [40.0, 30.0, 0.025], [60.0, 25.0, 0.012]


@pytest.fixture(scope="module")
def errors(surrogate, held_out):
    return check(surrogate, held_out)


def test_contact_force_and_touch_are_right_on_fresh_random_states(errors):
    """The goals: at least 50 states, median contact-force error below 2 %, touch decided right in 97 %."""
    assert errors["states"] >= 50 and errors["failed"] == 0
    assert errors["contact_force"]["count"] >= 50
    assert errors["contact_force"]["median"] < 0.02
    assert errors["touch"]["right"] >= 0.97
    assert errors["touch"]["force_without_touch"] <= 0.03 * errors["states"]


def test_tip_field_and_touch_distance_are_right_on_fresh_random_states(errors):
    for quantity in ("tip", "displacement"):
        assert errors[quantity]["median"] < 1e-3
        assert errors[quantity]["p95"] < 0.05
    assert errors["touch_distance"]["p95_absolute"] < 1e-5


def test_the_model_file_carries_the_accuracy_that_was_measured(surrogate, errors):
    for quantity, numbers in surrogate.accuracy.items():
        for name, value in numbers.items():
            assert errors[quantity][name] == pytest.approx(value, rel=1e-2, abs=1e-9)


def test_snapshots_it_was_trained_on_are_met(surrogate, demo):
    training = SnapshotSet(demo / "training")
    points, tips = training.free("parameters")[..., :2].reshape(-1, 2), training.free("tip").reshape(-1, 3)
    answer = surrogate.evaluate(np.column_stack([points, np.full(len(points), np.inf)]))
    assert np.abs(answer.tip - tips).max() < 1e-4 * 0.05
    points, forces = training.contact("parameters")[..., 1:, :], training.contact("contact_force")[..., 1:]
    answer = surrogate.evaluate(points.reshape(-1, 3))
    assert np.abs(answer.contact_force - forces.ravel()).max() < 1e-2 * forces.max()


@pytest.mark.parametrize("point", [FREE, TOUCHING, [30.0, 80.0, 0.004], [99.0, 5.0, 0.0011]], ids=str)
def test_the_jacobian_is_a_difference(surrogate, point):
    def outputs(x):
        answer = surrogate.evaluate(x)
        return np.array([*answer.tip, answer.contact_force, answer.touch_distance])

    jacobian = surrogate.jacobian(point)
    for j, h in enumerate((1e-4, 1e-4, 1e-8)):
        step = h * np.eye(3)[j]
        slope = (outputs(point + step) - outputs(point - step)) / (2 * h)
        assert jacobian[:, j] == pytest.approx(slope, rel=1e-4, abs=1e-5 * np.abs(slope).max() + 1e-9)


def test_everything_is_continuous_at_touch(surrogate):
    touch = float(surrogate.evaluate(FREE).touch_distance)
    before, after = (surrogate.evaluate([*FREE[:2], touch + gap]) for gap in (1e-9, -1e-9))
    assert before.contact_force == 0.0 and 0.0 <= after.contact_force < 1e-4
    assert before.tip == pytest.approx(after.tip, abs=1e-8)


def test_the_field_and_the_tip_tell_the_same_story(surrogate):
    plate = surrogate.nodes[:, 0] >= 0.049 - 1e-6
    for point in (FREE, TOUCHING):
        assert surrogate.displacement(point)[plate].mean(axis=0) == pytest.approx(
            surrogate.evaluate(point).tip, abs=2e-4
        )
    assert np.abs(surrogate.displacement(TOUCHING)[surrogate.nodes[:, 0] < 1e-9]).max() < 1e-8


def test_a_plane_out_of_reach_does_not_change_the_field(surrogate):
    free = surrogate.displacement([100.0, 0.0, np.inf])
    touch = float(surrogate.evaluate([100.0, 0.0, np.inf]).touch_distance)
    lowered = replace(surrogate, parameters=[*surrogate.parameters[:2], surrogate.parameters[2] | {"upper": 0.02}])
    for model, distance in ((surrogate, touch), (surrogate, 1.0), (lowered, touch), (lowered, np.inf)):
        assert np.array_equal(model.displacement([100.0, 0.0, distance]), free)
    assert not np.array_equal(lowered.displacement([100.0, 0.0, 0.015]), free)


def test_many_points_at_once_are_the_same_points_one_by_one(surrogate):
    points = np.array([FREE, TOUCHING, [0.0, 0.0, 0.031]])
    together = surrogate.evaluate(points)
    for k, point in enumerate(points):
        alone = surrogate.evaluate(point)
        assert np.array_equal(together.tip[k], alone.tip)
        assert together.contact_force[k] == alone.contact_force
        assert together.error["contact_force"][k] == alone.error["contact_force"]


@pytest.mark.parametrize(
    ("point", "inside"),
    [
        ([0.0, 0.0, 0.001], True),
        ([100.0, 100.0, 0.031], True),
        ([100.0, 0.0, 0.001], True),
        ([20.0, 0.0, np.inf], True),  # a plane that is not touched may stand anywhere
        ([-1e-6, 0.0, 0.01], False),
        ([100.1, 0.0, 0.01], False),
        ([50.0, 0.0, 0.0009], False),
        ([50.0, 0.0, -1.0], False),
        ([np.nan, 0.0, 0.01], False),
        ([50.0, 0.0, np.nan], False),
        ([1e300, 0.0, 0.01], False),
    ],
)
def test_what_lies_outside_is_marked_and_answered_from_the_nearest_inside(surrogate, point, inside):
    answer = surrogate.evaluate(point)
    assert bool(answer.inside) is inside
    assert np.isfinite(answer.tip).all() and np.isfinite(answer.contact_force)
    assert answer.contact_force >= 0
    assert np.isfinite(surrogate.displacement(point)).all()


def test_accuracy_that_could_not_be_measured_is_nan(surrogate):
    unmeasured = replace(surrogate, accuracy={**surrogate.accuracy, "contact_force": {"count": 0}})
    error = unmeasured.evaluate(TOUCHING).error
    assert np.isnan(error["contact_force"]) and error["tip"] > 0


@pytest.mark.parametrize("point", [[1.0, 2.0], [1.0, 2.0, 3.0, 4.0], [], [[[1.0, 2.0, 0.01]]]], ids=str)
def test_the_wrong_number_of_parameters_is_refused(surrogate, point):
    for ask in (surrogate.evaluate, surrogate.jacobian, surrogate.displacement):
        with pytest.raises(ModelError, match="parameters must be F1, F2, d"):
            ask(point)


def test_a_saved_model_is_the_model(surrogate, tmp_path):
    surrogate.save(tmp_path / "copy.h5")
    copy = Surrogate.load(tmp_path / "copy.h5")
    for point in (FREE, TOUCHING):
        assert np.array_equal(copy.evaluate(point).tip, surrogate.evaluate(point).tip)
        assert copy.evaluate(point).contact_force == surrogate.evaluate(point).contact_force
    assert copy.parameters == surrogate.parameters and copy.accuracy == surrogate.accuracy
    assert list(tmp_path.iterdir()) == [tmp_path / "copy.h5"]


def test_the_model_file_names_its_axes_and_units(demo):
    with h5py.File(demo / "finger.h5") as file:
        axes = {
            name: [tuple(file[name][f"nodes_{a}"].attrs[key] for key in ("axis", "unit")) for a in range(n)]
            for name, n in (("free", 2), ("onset", 1), ("contact", 3))
        }
        assert axes["free"] == [("F1", "N"), ("F2", "N")]
        assert axes["onset"] == [("F2", "N")]
        assert axes["contact"] == [("xi of F1", "-"), ("F2", "N"), ("s", "-")]
        assert file["contact/modes"].attrs["unit"] == "m, m, m, N"


def test_a_looser_tolerance_keeps_fewer_terms_and_errs_more(surrogate, demo, held_out):
    loose = Surrogate.load(demo / "finger.h5", tolerance=3e-2)
    full, few = (check(model, held_out) for model in (surrogate, loose))
    assert few["terms"]["contact"] < full["terms"]["contact"]
    assert few["bytes"] < full["bytes"]
    error = loose.evaluate(TOUCHING).error
    assert loose.accuracy == {} and all(np.isnan(value) for value in error.values())  # it was measured with all terms
    assert surrogate.evaluate(TOUCHING).error["contact_force"] > 0
    assert full["displacement"]["median"] < few["displacement"]["median"] < 0.1


def test_what_is_no_model_is_refused_in_one_line(tmp_path, demo):
    (tmp_path / "text.h5").write_text("not HDF5")
    for file in (tmp_path / "text.h5", tmp_path / "nowhere.h5"):
        with pytest.raises(ModelError, match=str(file)) as caught:
            Surrogate.load(file)
        assert "\n" not in str(caught.value)
    shutil.copy(demo / "finger.h5", tmp_path / "damaged.h5")
    with h5py.File(tmp_path / "damaged.h5", "r+") as file:
        file["contact/modes"][0, 0] = np.nan
        del file["onset"]
    with pytest.raises(ModelError, match=r"damaged model file \(onset, contact\)"):
        Surrogate.load(tmp_path / "damaged.h5")
    with pytest.raises(ModelError, match="tolerance must be"):
        Surrogate.load(demo / "finger.h5", tolerance=-1.0)


def rom(*arguments: object) -> subprocess.CompletedProcess:
    command = [sys.executable, "-m", "rom", *map(str, arguments)]
    return subprocess.run(command, cwd=ROOT, capture_output=True, text=True)


def test_build_check_and_info_agree(demo, tmp_path):
    model = tmp_path / "model.h5"
    built = rom("build", demo / "training", "-o", model, "--held-out", demo / "heldout", "--json")
    assert built.returncode == 0, built.stderr
    checked, told = (
        json.loads(rom(*words, "--json").stdout) for words in (("check", model, demo / "heldout"), ("info", model))
    )
    assert told == json.loads(built.stdout)
    assert checked["contact_force"]["median"] < 0.02
    assert [p["unit"] for p in told["parameters"]] == ["N", "N", "m"]
    assert told["provenance"]["versions"].keys() == {"fingerfem", "dolfinx", "petsc"}
    assert told["accuracy"]["tip"]["median"] == pytest.approx(checked["tip"]["median"], rel=1e-2)


def test_sets_in_the_wrong_place_are_refused(demo, tmp_path):
    for words in (
        ("build", demo / "heldout", "-o", tmp_path / "m.h5"),
        ("check", demo / "finger.h5", demo / "training"),
        ("build", tmp_path, "-o", tmp_path / "m.h5"),
        ("info", demo / "report.json"),
        ("info", tmp_path / "nowhere.h5"),
        ("build", demo / "training", "-o", tmp_path / "nowhere" / "m.h5"),
    ):
        done = rom(*words)
        assert done.returncode == 2
        assert len(done.stderr.strip().splitlines()) == 1
    with pytest.raises(SnapshotError, match="training set"):
        SnapshotSet(demo / "training").random("tip")
