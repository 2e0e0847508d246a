"""Controllers, FMUs, simulation and environments of a finger with chambers: pressures in Pa beside tensions in N."""

import numpy as np
import pytest

from control import Finger, Gripper, Limits
from control.export import fmu as control_fmu
from control.motion import for_each
from rom.export.fmu.variables import model_interface
from rom.export.rod_header import rod_header
from rom.rod.objects.shapes import facing_plane
from rom.rod.touched_segment import TouchedSegment
from tests.rom.elements.chambered_rod import HIGHEST, two_segments

UPPER = [10.0, HIGHEST, 0.0]  # the upper chamber would bulge the face that touches


@pytest.fixture(scope="module")
def model(chambered):
    return TouchedSegment(rod=chambered, obstacle=facing_plane(0.010, (0.0, 0.010)))


def test_a_force_is_held_by_pressure_alone(model):
    finger = Finger(model, Limits(upper=[0.0, *UPPER[1:]]))
    motion = finger.hold(0.2, 0.001)
    assert motion.converged and motion.tensions[0] == 0 and 1e4 < motion.tensions[1] < HIGHEST
    assert model.evaluate([*motion.tensions, 0.001]).contact_force == pytest.approx(0.2, abs=2e-6)
    assert motion.as_json()["units"] == ["N", "Pa", "Pa"]
    rows = motion.tables(["F1", "p1", "p2"])[0].rows
    assert [row[0] for row in rows[:3]] == ["F1", "p1", "p2"] and [row[-1] for row in rows[:3]] == ["N", "kPa", "kPa"]
    assert float(rows[1][1]) == pytest.approx(motion.tensions[1] / 1e3, rel=1e-3)


def test_points_are_reached_and_the_plane_is_found(model):
    finger, random = Finger(model, Limits(upper=UPPER)), np.random.default_rng(0)
    for _ in range(20):
        loads = np.array(UPPER) * random.random(3)
        tip = model.evaluate([*loads, np.inf]).tip
        motion = finger.reach(finger.rest + tip)
        assert motion.converged and motion.residual < 1e-4
    loads = [0.5, 0.9 * HIGHEST, 0.0]
    felt = float(model.evaluate([*loads, 0.001]).contact_force)
    assert felt > 0.1 and finger.locate(loads, felt).distance == pytest.approx(0.001, abs=1e-6)


def test_two_segments_are_moved_by_their_own_pressures(chambered):
    """Points in reach of lower chambers under pressure in both segments, and a force before a plane."""
    rod = chambered.assembled(two_segments())
    model = TouchedSegment(rod=rod, obstacle=facing_plane(0.010, (0.0, 0.020)))
    upper, random = np.array([10.0, HIGHEST, 0.0, HIGHEST, 0.0]), np.random.default_rng(0)
    finger = Finger(model, Limits(upper=upper))
    for _ in range(10):
        tip = model.evaluate([*(upper * random.random(5)), np.inf]).tip
        motion = finger.reach(finger.rest + tip)
        assert motion.converged and motion.residual < 1e-4
    motion = finger.hold(0.05, 0.004)
    assert motion.converged
    assert model.evaluate([*motion.tensions, 0.004]).contact_force == pytest.approx(0.05, abs=2e-6)
    text = rod_header(model, "arm")
    assert "p4 [Pa] from 0 to 500000" in text and "arm_TENSIONS = 5" in text
    assert {each.name: each.unit for each in model_interface(model).of("output")}["growth_p4"] == "m3"


def test_what_is_refused_names_pressures(model):
    finger = Finger(model, Limits(upper=UPPER))
    far = finger.hold(50.0, 0.001)
    assert (
        far.status == "unreachable" and "tensions and pressures from [0, 0, 0] to [10, 500000, 0] N, Pa" in far.reason
    )
    with pytest.raises(
        ValueError, match=r"start must be 3 tensions in N, the last 2 of them pressures in Pa, got shape"
    ):
        finger.hold(0.1, 0.001, start=[0.0])
    with pytest.raises(ValueError, match=r"limits.rate must be left out of a finger with chambers"):
        Finger(model, Limits(rate=100.0))
    with pytest.raises(ValueError, match=r"a grasp, .*, must be of a finger with tendons alone, got one with 2"):
        Gripper(model).grips(0.1)


def test_a_number_for_all_loads_is_refused_where_some_are_pressures(model):
    pytest.importorskip("gymnasium", reason="the optional extra [gymnasium]")
    from control.environment import HoldEnvironment

    loads = model.rod.parameters
    assert for_each("rate", [500.0, 1e6, 1e6], loads).tolist() == [500.0, 1e6, 1e6]
    with pytest.raises(ValueError, match=r"change must be one for each of F1, p1, p2, got 2.0"):
        HoldEnvironment(model, targets=(0.1, 0.2))
    environment = HoldEnvironment(model, targets=(0.05, 0.1), change=[0.5, 2e4, 2e4])
    environment.reset(seed=1, options={"distance": 0.001, "target": 0.1})
    observed, *_ = environment.step(np.array([0.0, 1.0, 0.0]))
    assert observed[1] == pytest.approx(2e4 / HIGHEST)


def test_an_fmu_has_pressures_in_pascal_and_growths_in_cubic_metres(model):
    inputs = {each.name: each.unit for each in model_interface(model).of("input")}
    assert inputs == {"F1": "N", "p1": "Pa", "p2": "Pa", "d": "m"}
    outputs = {each.name: each.unit for each in model_interface(model).of("output")}
    assert outputs["shortening_F1"] == "m" and outputs["growth_p1"] == outputs["growth_p2"] == "m3"
    held = {each.name: each.unit for each in control_fmu.interface(model).variables}
    assert held["p1"] == held["start_p2"] == "Pa" and held["F1"] == "N"


def test_a_header_names_the_units_of_its_point(model):
    text = rod_header(model, "arm")
    assert "F1 [N] from 0 to 10" in text and "p1 [Pa] from 0 to 500000" in text
    assert "then growths" in text and "arm_TENSIONS = 3" in text
