"""Whatever is public can be pickled and copied, before it was used and after; processes that are spawned need it."""

import copy
import multiprocessing
import pickle
from pathlib import Path

import numpy as np
import pytest
from assembled import in_series

import control
import rom
from control import CalibrationOptions, Finger, Gripper, Limits, calibrate
from control.tracking import circle
from rom import Rod

LOG = Path(__file__).parents[2] / "examples" / "log.csv"
NOISE = {"tension": 0.02, "position": 5e-4, "orientation": 0.017}
POINT = [50.0, 20.0, 0.012]
HULL = {"vertices": [(x, y, z) for x in (0, 0.01) for y in (0, 0.01) for z in (0, 0.01)]}
WHERE = {"centre": (0.0, 0.01, 0.0), "direction": (0.0, 1.0, 0.0)}


def rod() -> Rod:
    return rom.load().rod


def grasp(table):
    gripper = Gripper(table)
    return gripper.grasp(1.0, [control.SimulatedPlant(gripper.model, 0.01) for _ in range(3)])


def answered(model) -> list:
    answer = model.evaluate(POINT)
    return [answer.tip, answer.contact_force, answer.error["contact_force"], model.jacobian(POINT)]


def pulled(plant) -> list:
    return [plant.pull([40.0, 5.0])]


# Of every class: how one is made, of a table if it needs a model; and what is asked of it, which makes what compiled
# code reads.
CLASSES = {
    "AmongObjects": (
        lambda table: rom.AmongObjects(rod=rod(), obstacles=[rom.load().obstacle, rom.Sphere(radius=0.01, **WHERE)]),
        lambda one: [one.evaluate([*POINT, np.inf]).contact_force, one.jacobian([*POINT, 0.02])],
    ),
    "Answer": (lambda table: table.evaluate(POINT), lambda one: [one.tip, one.contact_force]),
    "BaseMotion": (lambda table: rom.BaseMotion(*np.eye(3)), lambda one: [one.acceleration, one.spin_rate]),
    "Cylinder": (lambda table: rom.Cylinder(radius=0.01, **WHERE), lambda one: [one.numbers()["axis"]]),
    "Hull": (lambda table: rom.Hull(**HULL, **WHERE), lambda one: [one.numbers()["heights"]]),
    "MovingFinger": (
        lambda table: rom.MovingFinger(rom.load(), [0.0, 0.0, 0.02], density=1100.0),
        lambda one: [one.step([5.0, 0.0, 0.02], 1e-3).tip],
    ),
    "MovingPlant": (lambda table: control.MovingPlant(rom.load(), 0.02, 1100.0), lambda one: [one.pull([4.0, 1.0])]),
    "Plane": (lambda table: rom.Plane(normal=(0.0, -1.0, 0.0), **WHERE), lambda one: [one.numbers()["axis"]]),
    "Rod": (lambda table: in_series(rod(), 2), lambda one: [one.struct.plates, one.place([20.0, 0.0]).centres]),
    "Sphere": (lambda table: rom.Sphere(radius=0.01, **WHERE), lambda one: [one.numbers()["radius"]]),
    "table": (lambda table: table, answered),
    "TouchedSegment": (lambda table: rom.load(), answered),
    "Calibration": (
        lambda table: calibrate(rom.load(), LOG, CalibrationOptions(noise=NOISE)),
        lambda one: [one.correlations, one.rod.place([20.0, 0.0]).centres],
    ),
    "CalibrationOptions": (
        lambda table: CalibrationOptions(fit=["size"], noise=NOISE),
        lambda one: [one.noise["position"]],
    ),
    "Finger": (
        lambda table: Finger(table, Limits(upper=90.0, rate=400.0)),
        lambda one: [
            one.hold(1.0, 0.01).tensions,
            one.reach(one.rest + np.array([-0.005, 0.01, 0])).tensions,
            one.upper,
        ],
    ),
    "GuidedFinger": (
        lambda table: rom.GuidedFinger(model=rom.load(), friction=0.2),
        lambda one: [one.advance([tension, 0.0, 0.02]).element_tensions for tension in (60.0, 30.0)],
    ),
    "Flaws": (lambda table: control.Flaws(noise=0.1), lambda one: [one.noise]),
    "Grasp": (grasp, lambda one: [one.tensions, one.distances]),
    "GraspOptions": (lambda table: control.GraspOptions(noise=0.01), lambda one: [one.gain(1.0)]),
    "Gripper": (
        lambda table: Gripper(table, fingers=4, radius=0.02, limits=Limits(upper=80.0)),
        lambda one: [one.fingers[3].hold(1.0, 0.01).tensions, one.distances([0.001, 0.0], 0.01)],
    ),
    "Limits": (lambda table: Limits(rate=3.0), lambda one: [one.rate]),
    "Motion": (lambda table: Finger(table).hold(500.0, 0.01), lambda one: [one.tensions, one.reason]),
    "Object": (lambda table: control.Object(mass=0.1, friction=0.5, admissible_force=9.0), lambda one: [one.weight]),
    "SimulatedPlant": (
        lambda table: control.SimulatedPlant(table, 0.01, control.Flaws(noise=0.1), seed=3),
        pulled,
    ),
    "Targets": (
        lambda table: Gripper(table).targets(control.Object(mass=0.1, friction=0.5, admissible_force=9.0)),
        lambda one: [one.contact_forces],
    ),
    "TrackingController": (
        lambda table: control.TrackingController(
            rom.load(),
            circle([0.01, 0.01], 0.002, 4.0, 5e-3, 0.5),
            control.TrackingOptions(period=5e-3, density=1100.0),
        ),
        lambda one: [one.step(tip=[0.047, 0.011, 0.01]).copy() for _ in range(3)],
    ),
    "TrackingOptions": (lambda table: control.TrackingOptions(noise=1e-4), lambda one: [one.noise]),
    "Grip": (
        lambda table: Gripper(table).grips(1.0)[0],
        lambda one: [one.step(0.0).copy() for _ in range(3)] + [one.step(0.3).copy() for _ in range(3)],
    ),
}


def same(ours: list, theirs: list) -> bool:
    return len(ours) == len(theirs) and all(np.array_equal(a, b) for a, b in zip(ours, theirs, strict=True))


def test_every_public_class_is_here(table):
    public = {name: getattr(package, name) for package in (rom, control) for name in package.__all__}
    classes = {
        name for name, one in public.items() if isinstance(one, type) and not getattr(one, "_is_protocol", False)
    }
    assert classes == CLASSES.keys() - {"table"} | {type(table).__name__}
    for name in public.keys() - classes:  # functions and protocols, by their names
        assert pickle.loads(pickle.dumps(public[name])) is public[name]


@pytest.mark.parametrize("name", CLASSES)
def test_a_pickle_and_a_copy_answer_as_the_original(table, name):
    make, ask = CLASSES[name]
    one = make(table)
    for again in (pickle.loads(pickle.dumps(one)), copy.copy(one), copy.deepcopy(one)):
        assert type(again) is type(one) and same(ask(again), ask(make(table)))
    ask(one)
    used = pickle.loads(pickle.dumps(one)), copy.deepcopy(one)
    answers = ask(one)  # of a plant the next reading
    for again in used:
        assert same(ask(again), answers)


def held(finger: Finger) -> np.ndarray:
    return finger.hold(1.0, 0.01).tensions


def widths(gripper: Gripper) -> np.ndarray:
    return gripper.distances([0.0, 0.0], 0.01)


def drawn(environment) -> tuple:
    return environment.step(np.zeros(environment.action_space.shape, np.float32))[:2]


def test_processes_that_are_spawned_are_handed_fingers_grippers_and_environments(table):
    pytest.importorskip("gymnasium")
    from control.environment import HoldEnvironment

    finger, gripper, environment = Finger(table), Gripper(table), HoldEnvironment(table)
    environment.reset(seed=1)
    with multiprocessing.get_context("spawn").Pool(1) as pool:
        assert np.array_equal(pool.apply(held, (finger,)), held(finger))
        assert np.array_equal(pool.apply(widths, (gripper,)), widths(gripper))
        (theirs, reward), (ours, expected) = pool.apply(drawn, (environment,)), drawn(environment)
    assert np.array_equal(theirs, ours) and reward == expected


@pytest.mark.parametrize("steps", [0, 5])
def test_environments_go_on_from_a_pickle_with_equal_bits(table, steps):
    pytest.importorskip("gymnasium")
    from control.environment import HoldEnvironment

    environment = HoldEnvironment(table, flaws=control.Flaws(noise=0.1))
    assert pickle.loads(pickle.dumps(environment)).reset(seed=2)[1] == environment.reset(seed=2)[1]
    action = np.full(environment.action_space.shape, 0.3, np.float32)
    for _ in range(steps):
        environment.step(action)
    again = pickle.loads(pickle.dumps(environment))
    for _ in range(5):
        ours, theirs = environment.step(action), again.step(action)
        assert np.array_equal(ours[0], theirs[0]) and ours[1:] == theirs[1:]
    assert environment.reset()[1] == again.reset()[1]  # with the same random numbers
