"""The tip on a path in time: against PID, with delay, noise and another modulus, in contact, within limits."""

import copy
import re
from dataclasses import replace

import numpy as np
import pytest

import rom
from control import Flaws, Limits, MovingPlant, TrackingController, TrackingOptions, run
from control.tracking import PidController, circle, eight, inverse
from control.tracking.linearised import linearised
from control.tracking.plan import planned
from control.tracking.refinement import refined, simulated

DENSITY, PERIOD, RATE, RADIUS = 1100.0, 5e-3, 4.0, 0.004  # [kg/m^3], [s], [Hz], [m]
OPTIONS = TrackingOptions(period=PERIOD, density=DENSITY)
PATH = circle([0.010, 0.010], RADIUS, RATE, PERIOD, 2)
LAP = round(1 / RATE / PERIOD)


@pytest.fixture(scope="module")
def finger():
    return rom.load()


@pytest.fixture(scope="module")
def made(finger):
    return TrackingController(finger, PATH, OPTIONS)


@pytest.fixture(scope="module")
def pressing(finger):
    return TrackingController(finger, PATH, replace(OPTIONS, distance=0.010, most_force=0.4, margin=2e-4))


def other(finger, factor: float):
    """The finger with another modulus, pulled by the same tensions or less."""
    scene, material = finger.scene, finger.scene["material"]
    stiffer = material | {"C1": material["C1"] * factor, "D1": material["D1"] / factor}
    tendons = [one | {"tension": [0.0, 100.0 * min(factor, 1.0)]} for one in scene["tendons"]]
    return replace(finger, rod=finger.rod.assembled(scene | {"material": stiffer, "tendons": tendons}))


def moving(model, controller, flaws: Flaws, density=DENSITY, distance=np.inf) -> MovingPlant:
    return MovingPlant(model, distance, density, flaws, steps=5, tensions=controller.plan.tensions[0])


def track(controller, plant):
    """The report of a run of the whole path, without a pull that failed."""
    report = run([controller], [plant], controller.periods)
    assert report.unread == 0
    return report


def rms(found, path=PATH) -> float:
    return float(np.sqrt((found.errors(path)[LAP:] ** 2).mean()))


@pytest.mark.parametrize("delay", [0, 2])
def test_it_is_ten_times_as_near_as_a_pid(finger, made, delay):
    flaws = Flaws(period=PERIOD, delay=delay)
    found = track(copy.deepcopy(made), moving(finger, made, flaws))
    assert rms(found) < 0.002 * RADIUS
    errors = []
    for gains in ((0.0, 1.0, 0.0), (0.0, 3.0, 0.0), (0.0, 6.0, 0.0)):
        pid = PidController(finger, PATH, gains, OPTIONS)
        errors.append(rms(track(pid, moving(finger, made, flaws))))
    assert rms(found) < 0.1 * min(errors)


def test_a_figure_of_eight_is_followed_too(finger):
    path = eight([0.010, 0.010], RADIUS, RATE, PERIOD, 1.5)
    controller = TrackingController(finger, path, OPTIONS)
    assert rms(track(controller, moving(finger, controller, Flaws(period=PERIOD, delay=1))), path) < 0.005 * RADIUS


def test_one_tendon_leads_the_tip_along_its_own_line(finger):
    one = replace(finger, rod=finger.rod.assembled(finger.scene | {"tendons": finger.scene["tendons"][:1]}))
    pulled = 15.0 - 8.0 * np.cos(np.linspace(0.0, 2 * np.pi, 60))
    path = one.evaluate(np.column_stack([pulled, np.full(60, np.inf)])).tip[:, 1:]
    controller = TrackingController(one, path, OPTIONS)
    assert controller.reason == ""
    found = track(controller, moving(one, controller, Flaws(period=PERIOD, delay=1)))
    assert found.errors(path).max() < 0.002 * np.ptp(path[:, 0])
    assert controller.status == "done" and controller.row == 59


@pytest.mark.parametrize(("modulus", "density"), [(1.1, 0.9), (0.9, 1.1)])
def test_with_another_modulus_and_density_noise_and_delay_it_comes_near(finger, made, modulus, density):
    flaws, model = Flaws(period=PERIOD, delay=1, tip_noise=2e-5), other(finger, modulus)
    alone = copy.deepcopy(made)
    plant = moving(model, alone, flaws, DENSITY * density)
    blind = [plant.pull(tensions) * 0 + plant.true_tip[1:] for tensions in alone.plan.tensions[1:]]
    without = np.linalg.norm(np.array(blind) - PATH[1:], axis=1)[LAP:]
    found = track(alone, moving(model, alone, flaws, DENSITY * density))
    assert rms(found) < 0.035 * RADIUS
    assert rms(found) < 0.5 * np.sqrt((without**2).mean())


def test_a_plan_before_refinement_leads_a_slow_tip_along_the_path_and_counts_the_inertia(finger, made):
    system = linearised(finger, made.plan.tensions.mean(axis=0), DENSITY, PERIOD)
    plan = planned(finger, PATH, system, OPTIONS, Limits())
    at = finger.evaluate(np.column_stack([plan.tensions, np.full(len(PATH), np.inf)])).tip[:, 1:]
    assert at[0] == pytest.approx(PATH[0], abs=1e-5)
    turning = slice(LAP + 1, -1)  # where it turns at its rate: at rest, the tip would be nearer to the middle
    shorter = 1 - (2 * np.pi * RATE) ** 2 * system.inertia[0, 0]
    wanted = [0.010, 0.010] + shorter * (PATH[turning] - [0.010, 0.010])
    assert np.linalg.norm(at[turning] - wanted, axis=1).max() < 0.02 * (1 - shorter) * RADIUS + 1e-6


def test_refinement_reduces_the_simulated_error(finger, made):
    system = linearised(finger, made.plan.tensions.mean(axis=0), DENSITY, PERIOD)
    plans = planned(finger, PATH, system, OPTIONS, Limits()), made.plan
    sizes = [np.square(simulated(finger, plan.tensions, OPTIONS).tips - PATH).mean() for plan in plans]
    assert np.sqrt(sizes[1]) < 0.2 * np.sqrt(sizes[0])
    assert made.plan.goals == pytest.approx(simulated(finger, made.plan.tensions, OPTIONS).tips)


def test_a_plan_that_leaves_the_domain_in_motion_is_refused_with_the_row(finger, made):
    system = linearised(finger, made.plan.tensions.mean(axis=0), DENSITY, PERIOD)
    beyond = np.where(np.arange(len(PATH))[:, None] < 30, made.plan.tensions, 150.0)
    plan = refined(made.plan._replace(tensions=beyond), finger, system, OPTIONS, (np.zeros(2), np.full(2, 200.0)))
    assert re.search("path row 30 must lie in the trained domain in motion", plan.reason)


def test_a_long_path_at_a_short_period_is_solved_at_rows_that_its_bends_need(finger, monkeypatch):
    path, solves = circle([0.010, 0.010], RADIUS, 1.0, 2e-3, 1.5), []
    monkeypatch.setattr(inverse, "inverse", lambda *given, own=inverse.inverse: solves.append(1) or own(*given))
    tensions = inverse.inverses(finger, path, np.full(2, 5.0), (np.zeros(2), np.full(2, 100.0)))
    tips = finger.evaluate(np.column_stack([tensions, np.full(len(path), np.inf)])).tip[:, 1:]
    assert np.linalg.norm(tips - path, axis=1).max() <= inverse.SMOOTH
    assert len(solves) < 0.2 * len(path)


def test_tensions_keep_their_limits(finger):
    limits = Limits(upper=30.0, rate=800.0)
    controller = TrackingController(finger, PATH, OPTIONS, limits)
    assert controller.reason == ""
    flaws = Flaws(period=PERIOD, delay=1, tip_noise=1e-3)  # wild readings
    found = track(controller, moving(finger, controller, flaws))
    assert found.tensions.max() <= 30.0 and found.tensions.min() >= 0.0
    assert np.abs(np.diff(found.tensions, axis=0)).max() <= 800.0 * PERIOD + 1e-9
    assert np.isfinite(found.tips).all() and found.tensions.shape == (len(PATH) - 1, 1, 2)


@pytest.mark.parametrize("modulus", [1.0, 1.1])
def test_contact_at_speed_keeps_its_largest_force_and_follows_the_path_in_front_of_the_plane(finger, modulus):
    distance, most = 0.010, 0.4  # of the plane [m]: half of every lap lies behind it; [N]
    controller = TrackingController(finger, PATH, replace(OPTIONS, distance=distance, most_force=most))
    plan = controller.plan
    assert plan.contact_forces[0] == 0.0 < plan.contact_forces.max() <= most
    assert np.ptp(plan.tips[:, 0]) < 0.8 * np.ptp(PATH[:, 0])
    flaws = Flaws(period=PERIOD, delay=1, tip_noise=2e-5, noise=0.01)
    found = track(controller, moving(other(finger, modulus), controller, flaws, distance=distance))
    assert 0 < found.contact_forces.max() < most
    assert rms(found, plan.tips) < 0.04 * RADIUS


def test_readings_of_the_force_correct_it_on_a_softer_finger_before_a_nearer_plane(finger):
    waiting = np.repeat(PATH[LAP + 9 : LAP + 10], 80, axis=0)  # behind the plane
    path, errors, options = np.concatenate([PATH[: LAP + 10], waiting]), [], replace(OPTIONS, distance=0.010)
    for settling in (0.03, 1e6):
        controller = TrackingController(finger, path, replace(options, most_force=0.4, settling=settling))
        assert controller.plan.contact_forces[-1] > 0.1
        plant = moving(other(finger, 0.8), controller, Flaws(period=PERIOD, delay=1), distance=0.0097)
        found = track(controller, plant)
        errors.append(abs(found.contact_forces[-10:].mean() - controller.plan.contact_forces[-10:].mean()))
    assert errors[0] < 0.1 * errors[1]


def test_an_error_of_the_force_at_first_contact_moves_the_tip_by_the_compliance_of_contact(pressing):
    one, plan = copy.deepcopy(pressing), pressing.plan
    while one.row < np.flatnonzero(plan.contact_forces > 0)[0]:
        one.step(plan.contact_forces[one.row], tip=[0.047, *plan.goals[one.row]])
    more, force, tip = copy.deepcopy(one), plan.contact_forces[one.row], [0.047, *plan.goals[one.row]]
    changes = more.step(force + 0.1, tip=tip) - one.step(force, tip=tip)
    moved = np.linalg.norm(plan.motions[one.row] @ changes)
    assert 0 < moved < 0.1 / np.linalg.norm(plan.stiffness, axis=1).max()


def test_a_fast_plan_of_elastic_rubber_keeps_tendons_tight_and_the_finger_in_its_domain():
    path = circle([0.0, 0.0], 0.010, 4.0, 2e-3, 1.5)
    controller = TrackingController(rom.load("round"), path, TrackingOptions(period=2e-3))
    assert controller.reason == "" and controller.plan.tensions.min() > 0.1
    assert controller.plan.deviation < 2e-5


def test_friction_that_tensions_do_not_overcome_is_refused_with_the_row(finger):
    controller = TrackingController(finger, PATH[: LAP + 20], replace(OPTIONS, friction=20.0))
    assert controller.status == "unreachable"
    assert re.search(r"^path row \d+ must be reached against friction of 20 by tensions from", controller.reason)


def test_with_motor_tensions_the_tip_rests_where_the_plan_has_it_without_friction(finger, made):
    rubbing = TrackingController(finger, PATH, replace(OPTIONS, friction=0.2))
    guides = rom.GuidedFinger(model=finger.rod, friction=0.2)
    tips = np.array([guides.advance(tensions).tip[1:] for tensions in rubbing.plan.tensions])
    wanted = finger.evaluate(np.column_stack([made.plan.tensions, np.full(len(PATH), np.inf)])).tip[:, 1:]
    assert tips == pytest.approx(wanted, abs=5e-6)
    assert np.abs(rubbing.plan.tensions - made.plan.tensions).max() > 0.5


def test_compensated_friction_leaves_a_moving_finger_less_error(finger, made):
    flaws = Flaws(period=PERIOD, delay=1, friction=0.2)
    rubbing = TrackingController(finger, PATH, replace(OPTIONS, friction=0.2))
    errors = [rms(track(copy.deepcopy(one), moving(finger, one, flaws))) for one in (made, rubbing)]
    assert errors[1] < 0.5 * errors[0]


@pytest.mark.parametrize("moved", [-2e-4, 0.0, 2e-4])
def test_an_impact_keeps_the_largest_force_on_a_plane_that_is_displaced_by_the_margin(finger, pressing, moved):
    options = pressing.options
    found = simulated(finger, pressing.plan.tensions, replace(options, distance=options.distance + moved))
    assert 0 < found.contact_forces.max() <= pressing.plan.most_force <= options.most_force
    flaws = Flaws(period=PERIOD, delay=1, tip_noise=2e-5, noise=0.01)
    plant = moving(finger, pressing, flaws, distance=options.distance + moved)
    assert 0 < track(copy.deepcopy(pressing), plant).contact_forces.max() < options.most_force


def test_a_plan_that_passes_in_front_of_the_plane_is_marked(finger):
    options = replace(OPTIONS, distance=0.010, most_force=0.002)
    controller = TrackingController(finger, PATH, options)
    assert controller.reason == "" and controller.plan.contact_forces.max() == 0.0
    behind = (controller.plan.tips != PATH).any(axis=1)
    starts = [k for k in range(1, len(PATH)) if behind[k] and not behind[k - 1]]
    assert controller.events == [(k, "passes in front") for k in starts] and len(starts) == 2
    report = track(controller, moving(finger, controller, Flaws(period=PERIOD), distance=0.010))
    assert [event for *_, event in report.events] == ["passes in front"] * 2


def test_a_plane_that_was_not_planned_is_pressed_with_a_bounded_force(finger, made):
    distance = 0.010
    found = track(copy.deepcopy(made), moving(finger, made, Flaws(period=PERIOD, delay=1), distance=distance))
    planned = TrackingController(finger, PATH, replace(OPTIONS, distance=distance)).plan.contact_forces.max()
    assert 0 < found.contact_forces.max() < 1.6 * planned


def test_without_readings_it_follows_its_plan_and_says_so(finger, made):
    blind = copy.deepcopy(made)
    for k in range(30):
        blind.step()
        assert blind.tensions == pytest.approx(made.plan.tensions[2 + k], abs=1e-12)
    assert blind.status == "sensor_failed"
    again = copy.deepcopy(blind)
    while not again.done:
        again.step()
    assert again.status == "sensor_failed"
    blind.step(tip=[0.047, *PATH[31]])
    assert blind.status == "moving" and np.isfinite(blind.tensions).all()
    assert [event for _, event in blind.events] == ["blind", "sees again"]
    with pytest.raises(ValueError, match=r"tip must be numbers x, y and z \[m\], got array"):
        blind.step(tip=PATH[32])
    before = copy.deepcopy(blind)
    for wild, age in ((0.01, 1.0), (0.01, -1.0), (0.01, np.nan), (1e300, 0.0)):  # too old, of no time, or no finger's
        blind.step(tip=[wild, wild, wild], age=age)
        before.step()
        assert np.array_equal(blind.tensions, before.tensions)


@pytest.mark.parametrize(
    ("path", "options", "limits", "reason"),
    [
        (PATH + 0.05, OPTIONS, Limits(), "must be reached with its inertia, at .* move or slow the path"),
        (PATH + 1e3, OPTIONS, Limits(), "must be reached with its inertia, at .* move or slow the path"),
        (
            np.where(np.arange(len(PATH))[:, None] < 30, PATH, PATH + 0.004),
            replace(OPTIONS, correction=5e-4),
            Limits(),
            "must be followed within options.correction, 0.0005 m, got a simulated distance of 0.00",
        ),
        (PATH, OPTIONS, Limits(rate=100.0), "must be reached with limits.rate, by 0.5 N a period, but needs"),
    ],
)
def test_a_path_out_of_reach_is_refused_with_its_row(finger, path, options, limits, reason):
    controller = TrackingController(finger, path[: LAP + 20], options, limits)
    assert controller.status == "unreachable" and controller.done
    assert re.search(rf"^path row \d+ {reason}", controller.reason)
    assert np.array_equal(controller.step(tip=[0.047, 0.01, 0.01]), controller.plan.tensions[0])


@pytest.mark.parametrize(
    ("path", "options", "message"),
    [
        (np.zeros((9, 3)), {}, r"path must be finite numbers \[m\] of shape \(n, 2\), got shape"),
        (PATH * np.nan, {}, "path must be finite numbers"),
        (PATH + 1j, {}, "path must be finite numbers"),
        (PATH[:2], {}, "path must have at least three rows of y and z, got 2"),
        ("circle", {}, r"path must be finite numbers \[m\] of shape \(n, 2\), got 'circle'"),
        (PATH, {"distance": 9.0}, "distance must be from"),
        (PATH, {"distance": np.nan}, "distance must be a number"),
        (PATH, {"distance": "near"}, "distance must be a number of at least 0 m, got 'near'"),
        (PATH, {"period": 0.0}, "period must be a finite number above 0 s, got 0.0"),
        (PATH, {"period": "1 ms"}, "period must be a finite number above 0 s, got '1 ms'"),
        (
            PATH,
            {"period": 2e-5},
            r"period must be at least 7.*e-05 s, 256 of which last as long as the finger's lowest mode",
        ),
        (PATH, {"noise": 1e-300}, r"noise must be a finite number from 1e-09 to 1e\+09 m, got 1e-300"),
        (PATH, {"drift": np.nan}, "drift must be a finite number from"),
        (PATH, {"pretension": 2.0}, "pretension must be a finite number from 0 to 1, got 2.0"),
        (PATH, {"margin": -1e-4}, "margin must be a finite number of at least 0 m, got -0.0001"),
        (PATH, {"distance": 0.0, "most_force": 0.4}, "distance must be from 0.0001 to "),
        (PATH, {"friction": -0.1}, "friction must be a finite number of at least 0, got -0.1"),
        (PATH, {"most_force": "1 N"}, "most_force must be a number above 0 N, got '1 N'"),
        (PATH, {"density": True}, "density must be a finite number above 0 kg/m.3, got True"),
    ],
)
def test_wrong_input_is_refused_in_a_line(finger, path, options, message):
    with pytest.raises(ValueError, match=message):
        TrackingController(finger, path, replace(OPTIONS, **options))


def test_a_finger_among_several_objects_is_refused(finger):
    among = rom.AmongObjects(rod=finger.rod, obstacles=2 * finger.objects)
    with pytest.raises(ValueError, match="model must be of a finger before one object, got 2"):
        TrackingController(among, PATH, OPTIONS)
