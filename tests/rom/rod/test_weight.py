"""Fingers that weigh: balance, an independent rod, derivatives, turned bases, and what is refused."""

import numpy as np
import pytest
from assembled import in_series
from scipy.integrate import solve_ivp
from scipy.optimize import root

from control import Finger
from rom import friction_history
from rom.bundled import file_of
from rom.files.checked_file import ModelError
from rom.rod.compiled import reports
from rom.rod.objects.shapes import Cylinder, facing_plane
from rom.rod.rod import Rod
from rom.rod.scene.scene_of_rod import of_tables
from rom.rod.touched_segment import TouchedSegment
from rom.rod.weight import gravity_of, weight_of
from tests.rom.elements import elastic_rod as rod

RHO, STEEL, HEAVY = 1070.0, 7850.0, 300.0  # [kg/m^3], and an acceleration by which the finger sags by a tenth [m/s^2]
SKEW = (0.3, 0.8, -0.5)


def weighs(finger: Rod, direction=SKEW, acceleration: float = HEAVY) -> Rod:
    table = {"density": RHO, "plate_density": STEEL, "direction": list(direction), "acceleration": acceleration}
    return finger.assembled(finger.scene | {"gravity": table})


@pytest.fixture(scope="module")
def bundled() -> TouchedSegment:
    return TouchedSegment.load()


def test_masses_are_those_of_the_geometry(bundled):
    geometry = bundled.scene["geometry"] | {"segments": [0.05, 0.06]}
    tendons = [one | {"segment": 2} for one in bundled.scene["tendons"]]
    two = bundled.rod.assembled(bundled.scene | {"geometry": geometry, "tendons": tendons})
    side, plate = geometry["side"], geometry["plate"]
    weight = weight_of(weighs(two))
    assert weight.rubber.sum() == pytest.approx(0.11 - 2 * plate)
    assert weight.masses.sum() == pytest.approx(side**2 * (RHO * (0.11 - 2 * plate) + 2 * STEEL * plate))
    assert np.linalg.norm(weight.gravity) == pytest.approx(HEAVY)
    assert weight_of(two) is None


def test_a_tapered_finger_has_the_mass_of_a_truncated_pyramid(bundled):
    geometry = bundled.scene["geometry"] | {"taper": [0.8]}
    tendons = [one | {"tension": [0.0, 20.0]} for one in bundled.scene["tendons"]]
    one = weighs(bundled.rod.assembled(bundled.scene | {"geometry": geometry, "tendons": tendons}))
    side, plate, (length,) = geometry["side"], 0.8 * geometry["plate"], geometry["segments"]
    rubber = side**2 * (length - plate) * (1 + 0.8 + 0.64) / 3
    assert weight_of(one).masses.sum() == pytest.approx(RHO * rubber + STEEL * plate * (0.8 * side) ** 2, rel=1e-6)


def hanging(tensions: np.ndarray, gravity: np.ndarray) -> np.ndarray:
    """The plate's centre of the elastic rod that weighs, shape (3,) [m]: from the clamp, without the project's code."""
    arms = np.insert(rod.TWO, 0, 0.0, axis=1)
    line, tip = RHO * rod.SIDE**2, STEEL * rod.SIDE**2 * rod.PLATE  # [kg/m], [kg]
    pulled, bent = -tensions.sum() * np.array([1.0, 0, 0]), tensions @ np.cross(arms, [-1.0, 0, 0])

    def slope(s: float, y: np.ndarray) -> np.ndarray:
        turned, moment = y[3:12].reshape(3, 3), y[12:]
        force = gravity * (tip + line * (rod.LENGTH - rod.PLATE - s))  # of all that is farther from the clamp
        inner, curved = turned.T @ force + pulled, (turned.T @ moment + bent) / [rod.TORSION, rod.BENDING, rod.BENDING]
        along = turned[:, 0] * (1 + inner[0] / rod.AXIAL)
        return np.concatenate(
            [
                along,
                (turned @ _skew(curved)).ravel(),
                -np.cross(along, force),
            ]
        )

    def end(moment: np.ndarray) -> np.ndarray:
        begin = np.concatenate([np.zeros(3), np.eye(3).ravel(), moment])
        return solve_ivp(slope, (0.0, rod.LENGTH - rod.PLATE), begin, rtol=1e-10, atol=1e-13).y[:, -1]

    def rest(moment: np.ndarray) -> np.ndarray:
        y = end(moment)
        return y[12:] - np.cross(y[3:12].reshape(3, 3)[:, 0] * rod.PLATE / 2, tip * gravity)

    y = end(root(rest, np.zeros(3), tol=1e-14).x)
    return y[:3] + y[3:12].reshape(3, 3)[:, 0] * rod.PLATE / 2


def _skew(v: np.ndarray) -> np.ndarray:
    return np.cross(v[None], np.eye(3)).T


@pytest.mark.parametrize("direction", [(0, 1, 0), SKEW, (-1, 0, 0)])
def test_a_finger_hangs_where_an_elastic_rod_does(finger, direction):
    heavy = weighs(finger, direction, 100.0)
    for tensions in ([0.0, 0.0], [12.0, 4.0]):
        placed = heavy.place(tensions)
        expected = hanging(np.array(tensions), weight_of(heavy).gravity)
        assert placed.inside
        assert placed.centres[0] == pytest.approx(expected, abs=3e-6)
        sag = np.linalg.norm(placed.centres[0] - finger.place(tensions).centres[0])
        assert sag > (1e-3 if direction != (-1, 0, 0) else 1e-6)


def test_sections_carry_all_that_is_beyond_them(finger):
    """Forces exactly; moments with the elements' masses at the mean of a cubic curve."""
    two = weighs(in_series(finger, 2), SKEW, 60.0)
    tensions, wrenches = (
        np.array([6.0, 3.0]),
        np.array([[0.1, -0.2, 0.15, 2e-4, -3e-4, 2e-4], [-0.1, 0.1, 0.05, 3e-4, 1e-4, -2e-4]]),
    )
    placed, weight = two.place(tensions, wrenches), weight_of(two)
    g, row, half = weight.gravity, len(weight.masses), two.half_lengths[0]
    force, moment = np.zeros(3), np.zeros(3)  # about the origin, of all beyond
    poses = reports.elements(two.struct, tensions, wrenches)
    for k in (1, 0):
        places, rotations, carried = poses[k]
        row -= 1 + len(places)
        clamp = (
            (placed.centres[0] + half * placed.rotations[0][:, 0], placed.rotations[0])
            if k
            else (np.zeros(3), np.eye(3))
        )
        own = placed.rotations[k] @ wrenches[k, :3] + weight.masses[row] * g
        force += own
        moment += placed.rotations[k] @ wrenches[k, 3:] + np.cross(placed.centres[k], own)
        for e, (place, turned, wrench) in enumerate(zip(places, rotations, carried, strict=True)):
            mass, length = weight.masses[row + 1 + e], weight.rubber[row + 1 + e]
            after, next_turned = (places[e + 1], rotations[e + 1]) if e + 1 < len(places) else clamp
            begin = place - (0.0 if e else half) * turned[:, 0]
            through = force + mass / 2 * g
            about = moment + np.cross(begin - length / 6 * turned[:, 0], mass / 2 * g) - np.cross(place, through)
            assert turned @ wrench[:3] == pytest.approx(through, abs=1e-9)
            assert turned @ wrench[3:] == pytest.approx(about, abs=1e-9)
            middle = (begin + after) / 2 + length / 12 * (next_turned[:, 0] - turned[:, 0])
            force += mass * g
            moment += np.cross(middle, mass * g)
    assert force == pytest.approx(
        weight.masses.sum() * g + placed.rotations[0] @ wrenches[0, :3] + placed.rotations[1] @ wrenches[1, :3]
    )


@pytest.mark.parametrize(("count", "acceleration"), [(1, HEAVY), (2, 50.0)])
def test_motions_and_shortenings_are_those_of_differences(finger, count, acceleration):
    heavy = weighs(in_series(finger, count), SKEW, acceleration)
    inputs, ways = np.zeros(2 + 6 * count), np.array([1e-3] * 2 + ([1e-3] * 3 + [1e-5] * 3) * count)
    inputs[:8] = 7.0, 3.0, 0.1, -0.2, 0.15, 2e-4, -3e-4, 2e-4

    def at(one):
        return heavy.place(one[:2], one[2:].reshape(count, 6)), reports.shortenings(
            heavy.struct, one[:2].copy(), one[2:].copy()
        )

    placed, (_, changes) = at(inputs)[0], at(inputs)[1][:2]
    assert placed.inside
    for k, h in enumerate(ways):
        unit = h * np.eye(len(inputs))[k]
        (before, short), (after, shorter) = at(inputs - unit), at(inputs + unit)
        spin = np.einsum("pji,pjk->pik", placed.rotations, after.rotations - before.rotations) / (2 * h)
        turn = (
            np.stack(
                [spin[:, 2, 1] - spin[:, 1, 2], spin[:, 0, 2] - spin[:, 2, 0], spin[:, 1, 0] - spin[:, 0, 1]], axis=1
            )
            / 2
        )
        move = np.einsum("pji,pj->pi", placed.rotations, after.centres - before.centres) / (2 * h)
        found = np.concatenate([move, turn], axis=1)
        assert placed.motions[:, :, k] == pytest.approx(found, abs=1e-6 * np.abs(found).max())
        slope = (shorter[0] - short[0]) / (2 * h)
        assert changes[:, k] == pytest.approx(slope, abs=1e-6 * np.abs(changes[:, k]).max())


OBJECTS = {
    "plane": facing_plane(0.01, (0.0, 0.05)),
    "bar at the rubber": Cylinder(
        centre=(0.025, 0.017, 0.0), axis=(0.1, 0.0, 1.0), radius=0.006, direction=(0.1, 1.0, 0.0), distances=(-0.1, 0.1)
    ),
}


def differences(model: TouchedSegment, point: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Derivatives of an answer, shape (5, p), and of the tip's orientation, shape (4, p), by tensions and finite d."""
    outs, turns = np.zeros((5, len(point))), np.zeros((4, len(point)))
    for k, way in enumerate([*[1e-3] * (len(point) - 1), 1e-7][: len(point) - np.isinf(point[-1])]):
        unit = way * np.eye(len(point))[k]
        after, before = (model.evaluate(point + sign * unit) for sign in (1, -1))
        found = (
            np.array([*one.tip, one.contact_force, one.touch_distance, *one.orientation]) for one in (after, before)
        )
        slopes = np.subtract(*found) / (2 * way)
        outs[:, k], turns[:, k] = slopes[:5], slopes[5:]
    return outs, turns


@pytest.mark.parametrize("count", [1, 2])
@pytest.mark.parametrize("name", OBJECTS)
def test_free_and_touched_it_has_the_derivatives_of_differences(bundled, name, count):
    """On the rubber they are good to some percent, with weight as without: the tangent leaves out its shape."""
    heavy = weighs(in_series(bundled.rod, count), (0.1, 0.9, -0.2), HEAVY / count**3)
    model, pressed = TouchedSegment(rod=heavy, obstacle=OBJECTS[name]), 1e-3 if name == "plane" else 4e-2
    for tensions in ([14.0, 3.0], [20.0, 9.0]):
        touch = model.outputs(np.array([[*tensions, np.inf]]))[0, 4]
        for d, near in ((np.inf, 1e-6), (touch - 0.0008, pressed)):
            point = np.array([*tensions, d])
            answer, report = model.answers(point), model.report(point)
            outs, turns = differences(model, point)
            scale = np.abs(outs[:3]).max(axis=0)
            assert answer.inside[0] and (answer.out[0, 3] > 0.02) == np.isfinite(d)
            assert np.abs(answer.jacobians[0, :3] - outs[:3]).max(axis=0) == pytest.approx(0, abs=near * scale.max())
            assert answer.jacobians[0, 3, :2] == pytest.approx(outs[3, :2], abs=near * np.abs(outs[3, :2]).max())
            assert answer.jacobians[0, 3, 2] == pytest.approx(outs[3, 2], rel=near)
            assert answer.jacobians[0, 4, :2] == pytest.approx(outs[4, :2], abs=1e-5 * scale[:2].max())
            off = np.abs(report.orientation_jacobian - turns).max(axis=0)
            assert off == pytest.approx(0, abs=max(near, 1e-5) * np.abs(turns).max())


def test_a_turned_base_turns_the_answer(bundled):
    """The elements' training has the mirror images of all states: both tendons change places with y and z."""
    down, aside = (weighs(bundled.rod, direction) for direction in ((0.2, 1, 0), (0.2, 0, 1)))
    one, other = down.place([20.0, 8.0]).centres[0], aside.place([8.0, 20.0]).centres[0]
    assert other[[0, 2, 1]] == pytest.approx(one, abs=2e-5)
    assert abs(one[1] - bundled.rod.place([20.0, 8.0]).centres[0, 1]) > 1e-3
    turned = down.with_gravity((0.4, 0, 2.0))
    assert turned.scene == aside.scene | {"gravity": aside.scene["gravity"] | {"direction": [0.4, 0.0, 2.0]}}
    assert turned.place([8.0, 20.0]).centres[0] == pytest.approx(other, abs=1e-15)
    assert turned.segments is down.segments and down.place([20.0, 8.0]).centres[0] == pytest.approx(one, abs=1e-15)
    model = TouchedSegment(rod=down, obstacle=bundled.obstacle).with_gravity((0.2, 0, 1), acceleration=0.0)
    light = TouchedSegment(rod=bundled.rod, obstacle=bundled.obstacle)
    point = np.array([[20.0, 8.0, 0.004]])
    assert model.outputs(point).tobytes() == light.outputs(point).tobytes()


def test_without_friction_a_history_is_the_answer(bundled):
    model = TouchedSegment(rod=weighs(bundled.rod), obstacle=bundled.obstacle)
    point = np.array([[20.0, 5.0, 0.006]])
    answer, state = model.answers(point), friction_history(model, point, 0.0)[-1]
    assert answer.inside[0] and answer.out[0, 3] > 0.1 and state.status == "converged"
    assert state.contact_force == pytest.approx(answer.out[0, 3], rel=1e-6)
    assert state.tip == pytest.approx(answer.out[0, :3], abs=2e-8)


def test_controllers_hold_and_reach_with_weight(bundled):
    heavy = TouchedSegment(rod=weighs(bundled.rod), obstacle=bundled.obstacle)
    motion = Finger(heavy).hold(0.5, 0.006)
    held = heavy.evaluate([*motion.tensions, 0.006])
    assert held.inside and float(held.contact_force) == pytest.approx(0.5, rel=1e-3)
    assert float(bundled.evaluate([*motion.tensions, 0.006]).contact_force) != pytest.approx(0.5, rel=0.05)
    target = heavy.rod.place([22.0, 6.0]).centres[0]
    assert Finger(heavy).reach(target, tolerance=1e-6).tensions == pytest.approx([22.0, 6.0], abs=0.01)


@pytest.mark.parametrize("direction", [(0, 1, 0), (0, -1, 0), (-1, 0, 0), (1, 0, 0), SKEW])
def test_however_heavy_it_answers_or_marks_its_answer(bundled, direction):
    model, marked = TouchedSegment(rod=weighs(bundled.rod, direction), obstacle=bundled.obstacle), 0
    points = np.array([[0.0, 0.0, np.inf], [30.0, 10.0, np.inf], [30.0, 10.0, 0.008]])
    for heavier in (1, 10, 100, 1000, 10_000 / HEAVY):
        found = model.with_gravity(direction, heavier * HEAVY if heavier * HEAVY <= 1e4 else 1e4).evaluate(points)
        for one in (found.tip, found.contact_force, found.orientation, found.shortenings):
            assert not np.isnan(one).any()
        assert not (found.inside & np.isinf(found.error["tip"])).any()
        marked += (~found.inside).sum()
    assert marked >= 3


def test_a_column_that_buckles_under_its_weight_is_no_answer(bundled):
    """Upright, by Greenhill's length for the rubber alone: g rho A L^3 / E I = 7.84; the plate makes it less."""
    upright = weighs(bundled.rod, (-1, 0, 0), 10.0)
    model = TouchedSegment(rod=upright, obstacle=bundled.obstacle)
    (segment,), side = upright.segments, upright.scene["geometry"]["side"]
    most = 7.84 * segment.young_modulus * side**2 / 12 / (RHO * 0.05**3)
    inside = [model.with_gravity((-1, 0, 0), a).evaluate([0.0, 0.0, np.inf]).inside for a in (0.4 * most, 0.99 * most)]
    assert inside == [True, False]


def test_a_long_soft_finger_is_found_where_weight_straightens_it():
    """Twenty diameters long; from the pose without weight no step of Newton's method leads to that with all of it."""
    own = Rod.load(file_of("round"))
    soft = {"C1": 0.5, "C2": 0.5, "C3": 0.5, "D1": 2.0}
    material = own.scene["material"] | {name: own.scene["material"][name] * share for name, share in soft.items()}
    tendons = [one | {"tension": [0.0, 5.0]} for one in own.scene["tendons"]]
    geometry = own.scene["geometry"] | {"segments": [0.4]}
    long = own.assembled(own.scene | {"geometry": geometry, "material": material, "tendons": tendons})
    placed = [long.with_gravity((1, 0, 0), a).place([1.25, 0, 0, 0]) for a in (2.0, 4.0, 6.0, 8.0)]
    aside = np.array([one.centres[0, 1] for one in placed])
    assert all(one.inside for one in placed)
    assert (np.diff(aside) < 0).all() and (np.diff(aside, 2) > 0).all() and aside[-1] < aside[0] / 2


REFUSED = {
    "gravity.density must be given, got none": {"direction": [0, 1, 0]},
    "gravity.direction must be given, got none": {"density": 1000.0},
    "gravity.direction must be three numbers, the largest from": {"density": 1000.0, "direction": [0, 0, 0]},
    "gravity.acceleration must be from 0 to 10000,": {"density": 1e3, "direction": [0, 1, 0], "acceleration": -1},
    "gravity.density must be from 10 to 30000, got 1.08": {"density": 1.08, "direction": [0, 1, 0]},
    "gravity must have the keys .*, got weight": {"density": 1e3, "direction": [0, 1, 0], "weight": 1},
}


@pytest.mark.parametrize("message", REFUSED)
def test_a_table_that_is_none_is_refused(message):
    with pytest.raises(ModelError, match=message):
        of_tables(rod.scene() | {"gravity": REFUSED[message]})


def test_what_is_left_out_is_steel_and_standard_gravity_and_a_file_keeps_it(finger, tmp_path):
    own = finger.assembled(finger.scene | {"gravity": {"density": 1070, "direction": [0, 2, 0]}})
    assert own.scene["gravity"] == {
        "density": 1070.0,
        "plate_density": 7850.0,
        "direction": [0.0, 2.0, 0.0],
        "acceleration": 9.80665,
    }
    own.save(tmp_path / "own.h5")
    again = Rod.load(tmp_path / "own.h5")
    assert "mass 6.03 g, acceleration (0, 9.81, 0) m/s^2" in again.tables()
    assert again.scene == own.scene
    assert again.place([5.0, 1.0]).centres == pytest.approx(own.place([5.0, 1.0]).centres, abs=1e-15)


def test_a_finger_without_weight_has_no_direction_to_change(finger):
    with pytest.raises(ModelError, match="gravity must be in the finger's scene"):
        finger.with_gravity((0, 1, 0))


@pytest.mark.parametrize(
    ("table", "rule"),
    [
        (True, "gravity must be a table .gravity., got True"),
        ({"density": "x", "direction": [0, -1, 0]}, "gravity.density must be a number, got 'x'"),
        ({"density": 1e3, "direction": "down"}, "gravity.direction must be a number, got 'down'"),
        ({"density": 1e3, "direction": [0, -1e200, 0]}, "gravity.direction must be three numbers"),
    ],
)
def test_a_table_of_wrong_types_is_refused_by_its_key(table, rule):
    with pytest.raises(ModelError, match=rule):
        gravity_of(table)


def test_densities_may_stand_in_a_table_of_their_own():
    gravity = {"direction": [0, -1, 0], "density": None, "plate_density": 7850.0}
    found = gravity_of(gravity, {"rubber": 1070.0, "plates": 8000.0})
    assert found["density"] == 1070.0 and found["plate_density"] == 8000.0 and found["acceleration"] == 9.80665
    with pytest.raises(ModelError, match="density must be a number, got None"):
        gravity_of(gravity, {})
