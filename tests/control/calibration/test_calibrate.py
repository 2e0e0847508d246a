"""A log with known parameters gives them back, with intervals; what it does not determine is named."""

from dataclasses import replace

import numpy as np
import pytest
from synthetic_logs import BASE, PULLEY, columns, written

import rom
from control import Calibration, CalibrationOptions, calibrate
from control.calibration.scaled_finger import Scales
from rom import Rod, TouchedSegment
from rom.console.table import Table
from rom.rod.weight import gravity_of

TENSIONS, POSE = ("F1 [N]", "F2 [N]"), ("x", "y", "z", "qw", "qx", "qy", "qz")
NAMES = ["base_x", "base_y", "base_z", "base_rx", "base_ry", "base_rz"]


def fitted(file, *names, **options) -> Calibration:
    return calibrate(rom.load(), file, CalibrationOptions(fit=names, **options))


def check_truth(found: Calibration, scales: Scales, tolerance: float = 1e-8) -> None:
    start = {one.name: one.start for one in found.parameters}
    for name, value in scales._asdict().items():
        if name in start:
            assert found.value(name) == pytest.approx(value * start[name], rel=tolerance)
    for name, value in zip(NAMES, BASE, strict=True):
        if name in start:
            assert found.value(name) == pytest.approx(value, abs=tolerance)
    assert not found.undetermined


@pytest.mark.parametrize("contact", [False, True])
def test_without_noise_modulus_size_and_base_are_exact(tmp_path, contact):
    scales = Scales(modulus=0.8, size=1.05)
    values = columns(1, noise=0.0, scales=scales, contact=contact)
    file = written(tmp_path / "log.csv", values, *TENSIONS, *POSE, "contact", "d")
    check_truth(fitted(file, "modulus", "size", "base"), scales)


@pytest.mark.parametrize(
    ("motors", "names"),
    [
        ((*TENSIONS, "F1 [mm]", "F2 [mm]"), ()),
        (("F1 [N mm]", "F2 [N mm]", "F1 [rad]", "F2 [rad]"), ("pulley_radius",)),
    ],
)
def test_without_noise_motors_may_log_shortenings_torques_and_angles(tmp_path, motors, names):
    scales = Scales(modulus=1.1)
    file = written(tmp_path / "log.csv", columns(2, noise=0.0, scales=scales), *motors, *POSE)
    found = fitted(file, "modulus", "base", *names, pulley_radius=1.1 * PULLEY if names else None)
    check_truth(found, scales)
    assert not names or found.value("pulley_radius") == pytest.approx(PULLEY, rel=1e-8)


def test_without_noise_density_is_exact_where_the_finger_lies_down(tmp_path):
    model, scales = rom.load(), Scales(modulus=0.9, density=1.3)
    gravity = gravity_of({"density": 1100.0, "direction": [0.0, -0.6, -0.8], "acceleration": 200.0})  # a spun finger
    rod = Rod(elements=model.rod.elements, scene=model.rod.scene | {"gravity": gravity})
    model = TouchedSegment(rod=rod, obstacle=model.obstacle)
    file = written(tmp_path / "log.csv", columns(3, noise=0.0, scales=scales, model=model), *TENSIONS, *POSE)
    found = calibrate(model, file, CalibrationOptions(fit=["modulus", "density", "base"]))
    check_truth(found, scales)
    assert found.rod.scene["gravity"]["density"] == pytest.approx(1.3 * 1100.0)


def test_intervals_cover_the_truth_and_modulus_is_within_a_percent(tmp_path):
    """Noise of 0.5 mm, 1 degree and 2 %: a full count of 300 logs is in test-long."""
    check_coverage(tmp_path, range(16), least=0.87)


@pytest.mark.long
def test_intervals_cover_95_of_100_truths(tmp_path):
    check_coverage(tmp_path, range(300), least=0.93)


def check_coverage(folder, seeds, least):
    model, covered, errors = rom.load(), [], []
    for seed in seeds:
        file = written(folder / "log.csv", columns(seed, count=40), *TENSIONS, *POSE)
        found = calibrate(model, file)
        truth = [0.9 * found.parameters[0].start, *BASE]
        covered.append(
            [one.interval[0] < true < one.interval[1] for one, true in zip(found.parameters, truth, strict=True)]
        )
        errors.append(found.value("modulus") / truth[0] - 1)
    assert np.mean(covered) >= least
    assert np.sqrt(np.mean(np.square(errors))) < 0.01


def test_noise_is_estimated(tmp_path):
    found = fitted(written(tmp_path / "log.csv", columns(5, count=200), *TENSIONS, *POSE))
    assert found.noise["position"] == pytest.approx(5e-4, rel=0.1)
    assert found.noise["orientation"] == pytest.approx(np.deg2rad(1), rel=0.1)
    assert found.noise["tension"] == pytest.approx(0.02, rel=0.15)
    assert not found.warnings


@pytest.mark.parametrize(
    ("kept", "names", "lacking", "words"),
    [
        (("F1 [mm]", "F2 [mm]", *POSE), ("modulus", "base"), {"modulus"}, "log the tension of every tendon too"),
        (
            (*TENSIONS, "qw", "qx", "qy", "qz"),
            ("modulus", "size"),
            {"modulus", "size"},
            "modulus together are not determined by this log: to determine it, log the position of the tip too",
        ),
    ],
)
def test_what_a_log_does_not_determine_is_named_with_a_remedy(tmp_path, kept, names, lacking, words):
    found = fitted(written(tmp_path / "log.csv", columns(6), *kept), *names)
    assert set(found.undetermined[0].parameters) == lacking
    assert words in found.undetermined[0].line()
    assert {one.name for one in found.parameters if not one.determined} == lacking


def test_one_tendon_alone_does_not_determine_its_base_turn_and_a_motion_does(tmp_path):
    values = {name: one.copy() for name, one in columns(7, noise=0.0).items()}
    pulled = np.column_stack([np.zeros(30), np.zeros(30)])
    outputs_at_rest = rom.load().rod.rest
    for k, name in enumerate(("x [mm]", "y [mm]", "z [mm]")):
        values[name] = np.full(30, 1e3 * outputs_at_rest[k]) + 1e-3 * np.arange(30)
    values["F1 [N]"], values["F2 [N]"] = pulled.T + 1e-2 * (1 + np.arange(30) % 2)
    found = fitted(
        written(tmp_path / "log.csv", values, *TENSIONS, "x", "y", "z"),
        "modulus",
        noise={"position": 5e-4, "tension": 0.02},
    )
    assert "log 5 poses with F1 alone up to" in found.undetermined[0].line()


def test_the_calibrated_finger_carries_its_log_and_is_not_surer_than_the_residuals(tmp_path):
    file = written(tmp_path / "log.csv", columns(8, contact=True), *TENSIONS, *POSE, "contact", "d")
    found = fitted(file)
    found.rod.save(tmp_path / "mine.h5")
    read = rom.load(tmp_path / "mine.h5")
    record = read.rod.calibration
    assert record == found.as_json()
    assert record["log"] == "log.csv" and record["poses"] == 30 and len(record["sha256"]) == 64
    assert read.rod.similarity.modulus == pytest.approx(found.value("modulus") / found.parameters[0].start)
    p95 = record["residuals"]["left_out"]
    answer = read.evaluate([[30.0, 20.0, np.inf], [60.0, 5.0, 0.012]])
    assert (answer.error["tip"] >= p95["position"]["p95"] * (1 - 1e-9)).all()
    assert (answer.orientation_error >= p95["orientation"]["p95"]).all()
    assert answer.contact_force[1] > 0.1
    assert answer.error["contact_force"][1] >= p95["contact_force"]["p95"] * answer.contact_force[1] * (1 - 1e-9)
    assert any(one.title.startswith("calibrated on log.csv") for one in read.rod.tables() if isinstance(one, Table))


def test_leave_one_out_errors_are_those_of_fits_without_a_pose(tmp_path):
    values = columns(9, count=12)
    noise = {"tension": 0.02, "position": 5e-4, "orientation": 0.0175}
    whole = fitted(written(tmp_path / "log.csv", values, *TENSIONS, *POSE), noise=noise)
    errors = []
    for k in range(12):
        others = {name: np.delete(one, k) for name, one in values.items()}
        part = fitted(written(tmp_path / "part.csv", others, *TENSIONS, *POSE), noise=noise)
        pulled = np.array([[values[name][k] for name in TENSIONS]])
        alone = whole.measured.log.only(np.array([k]))
        unknowns = [np.log(part.value("modulus") / part.parameters[0].start)]
        unknowns += [part.value(name) - whole.measured.unknowns.starts[name] for name in NAMES]
        before = type(whole.measured)(log=alone, finger=whole.measured.finger, unknowns=whole.measured.unknowns)
        errors.append(np.linalg.norm(before.residuals(np.array(unknowns), pulled).values[0, 2:5]))
    assert whole.errors["left_out"]["position"]["median"] == pytest.approx(np.median(errors), rel=0.05)
    assert whole.errors["left_out"]["position"]["max"] == pytest.approx(np.max(errors), rel=0.05)


def test_an_outlier_is_left_out_and_named(tmp_path):
    values = columns(10)
    values["y [mm]"][4] += 15.0
    found = fitted(written(tmp_path / "log.csv", values, *TENSIONS, *POSE))
    assert found.warnings == ["outliers: position in line 6; left out"]
    clean = fitted(written(tmp_path / "clean.csv", columns(10), *TENSIONS, *POSE))
    assert found.value("modulus") == pytest.approx(clean.value("modulus"), rel=0.004)


@pytest.mark.parametrize("effect", ["asymmetry", "hysteresis"])
def test_effects_that_no_parameter_explains_are_warned_of(tmp_path, effect):
    values = columns(11, count=40)
    for name in TENSIONS:
        rising = np.sign(np.diff(values[name], prepend=0.0))
        values[name] *= 1 + (0.08 * rising if effect == "hysteresis" else 0.12 * (name == "F1 [N]"))
    found = fitted(written(tmp_path / "log.csv", values, *TENSIONS, *POSE))
    assert any(line.startswith(f"{effect}: at equal readings,") for line in found.warnings), found.warnings


def test_poses_beyond_the_trained_domain_are_left_out_and_named(tmp_path):
    model, values = rom.load(), columns(12)
    tendons = [one | {"tension": [0.0, 70.0]} for one in model.scene["tendons"]]
    weaker = replace(model, rod=model.rod.assembled(model.scene | {"tendons": tendons}))
    found = calibrate(weaker, written(tmp_path / "log.csv", values, *TENSIONS, *POSE))
    beyond = 2 + np.flatnonzero(np.max([values[name] for name in TENSIONS], axis=0) > 0.9 * 72.0)
    (line,) = found.warnings
    assert line.startswith("beyond the trained domain at the fitted parameters: lines ")
    assert set(map(str, beyond)) <= set(line.partition("lines ")[2].partition(";")[0].split(", "))
    assert found.poses <= 30 - len(beyond)
    assert found.value("modulus") == pytest.approx(0.9 * found.parameters[0].start, rel=0.03)


def test_without_noise_friction_of_the_guides_is_exact(tmp_path):
    scales = Scales(modulus=0.9, friction=0.2)
    file = written(tmp_path / "log.csv", columns(13, count=16, noise=0.0, scales=scales), *TENSIONS, *POSE)
    found = fitted(file, "modulus", "base", "friction")
    assert found.value("friction") == pytest.approx(0.2, abs=1e-7)
    assert found.value("modulus") == pytest.approx(0.9 * found.parameters[0].start, rel=1e-7)
    assert not found.undetermined and not found.warnings
    assert found.rod.errors.position > 1e-4  # answers have no friction of the guides


def test_friction_that_is_not_fitted_is_warned_of_as_hysteresis(tmp_path):
    values = columns(14, count=30, noise=0.3, scales=Scales(modulus=0.9, friction=0.3))
    found = fitted(written(tmp_path / "log.csv", values, *TENSIONS, *POSE), "modulus", "base")
    assert any(line.startswith("hysteresis: at equal readings,") for line in found.warnings), found.warnings


def test_friction_needs_tensions_or_torques(tmp_path):
    file = written(tmp_path / "log.csv", columns(1), "F1 [mm]", "F2 [mm]", *POSE)
    with pytest.raises(ValueError, match="friction must be fitted to tensions or torques, got neither in"):
        fitted(file, "modulus", "friction")
