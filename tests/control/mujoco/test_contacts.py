"""Contacts of rubber with geoms of every kind, and with friction."""

import numpy as np
import pytest

mujoco = pytest.importorskip("mujoco")

from control.mujoco import Simulation, attach, attach_gripper  # noqa: E402
from rom import Cylinder, Sphere, TouchedSegment, friction_history  # noqa: E402
from rom.rod.objects.shapes import Plane, box  # noqa: E402

TENSION = 40.0  # [N]
SCENE = """
<mujoco><option gravity="0 0 0" {options}/>
<asset><mesh name="prism" vertex="{vertices}"/></asset>
<worldbody><body name="palm"/><geom {geom}/></worldbody></mujoco>
"""
AROUND = 2 * np.pi * np.arange(48) / 48
# A prism about z, 12 mm long, with the mean radius of 8 mm.
CIRCLE = 0.008 / np.sqrt(np.cos(np.pi / 48)) * np.column_stack([np.cos(AROUND), np.sin(AROUND)])
PRISM = np.concatenate([np.column_stack([CIRCLE, np.full(48, z)]) for z in (-0.006, 0.006)])


def pressed(rod, geom, options="", tension=TENSION, friction=0.0):
    """A simulation at rest, and the force on a finger along y [N]."""
    vertices = " ".join(f"{x:.9g}" for x in PRISM.ravel())
    text = SCENE.format(geom=f'friction="{friction} 0 0" {geom}', options=options, vertices=vertices)
    spec = mujoco.MjSpec.from_string(text)
    finger = attach(spec, rod, "palm")
    simulation = Simulation(spec.compile(), [finger])
    simulation.pull(0, tension if np.ndim(tension) else [tension, 0.0])
    simulation.advance(0.8)
    return simulation, sum(simulation.data.sensor(one).data[1] for one in finger.sensors)


def force(rod, obstacle, tension=TENSION):
    return float(TouchedSegment(rod=rod, obstacle=obstacle).evaluate([tension, 0.0, 0.0]).contact_force)


def drawn(rod, random, shape, place):
    """A random object like those of docs/grasping.md, of which cylinders lie along the finger at the plate and across
    it at the rubber, tensions, and the force with which the rod presses [N]."""
    while True:
        radius, off = random.uniform(0.009, 0.018), random.uniform(-0.002, 0.002, 3)
        centre = np.array([0.0455, 0.030, 0.0]) + off
        if place == "rubber":
            centre = np.array([random.uniform(0.020, 0.036), 0.005 + radius + random.uniform(0.003, 0.007), off[2]])
        given = {"centre": tuple(centre.tolist()), "radius": radius, "direction": (0, 1, 0), "distances": (-0.02, 0.05)}
        axis = (1.0, 0.0, 0.0) if place == "plate" else (0.0, 0.0, 1.0)
        obstacle = Sphere(**given) if shape == "sphere" else Cylinder(**given, axis=axis)
        model = TouchedSegment(rod=rod, obstacle=obstacle)
        tensions = [random.uniform(15.0, 60.0), random.uniform(0.0, 8.0)]
        answer = model.evaluate([*tensions, 0.0])
        touched = {one.rubber for one in model.contact_forces([*tensions, 0.0])}
        if answer.inside and 0.25 < answer.contact_force < 4 and touched == {place == "rubber"}:
            return obstacle, tensions, float(answer.contact_force)


@pytest.mark.long
@pytest.mark.parametrize("shape", ["sphere", "cylinder"])
@pytest.mark.parametrize("place", ["plate", "rubber"])
def test_random_objects_are_pressed_as_the_rod_says(rod, shape, place):
    random, off = np.random.default_rng(60), []
    for _ in range(15):
        obstacle, tensions, expected = drawn(rod, random, shape, place)
        axis = " ".join(map(str, getattr(obstacle, "axis", (0, 0, 1))))
        size = f"{obstacle.radius} {0.1 if shape == 'cylinder' else ''}"
        geom = f'type="{shape}" size="{size}" pos="{" ".join(map(str, obstacle.centre))}" zaxis="{axis}"'
        off.append(abs(pressed(rod, geom, 'timestep="0.001"', tensions)[1] / expected - 1))
    assert max(off) < 0.003


@pytest.mark.parametrize("jacobian", ["dense", "sparse"])
def test_edges_of_a_box_press_as_the_rod_says(rod, jacobian):
    _, found = pressed(
        rod, 'type="box" size="0.006 0.004 0.02" pos="0.028 0.013 0" euler="0 0 20"', f'jacobian="{jacobian}"', 20.0
    )
    obstacle = box(
        centre=(0.028, 0.013, 0.0),
        sides=(0.012, 0.008, 0.04),
        rotation=(0.0, 0.0, np.radians(20)),
        direction=(0, 1, 0),
        rounding=1e-5,
    )
    assert found == pytest.approx(force(rod, obstacle, 20.0), rel=0.003) and found > 0.5


def test_a_plane_in_the_rubber_presses_as_the_rod_says(rod):
    normal = np.array([-0.6, -0.8, 0.0])
    _, found = pressed(rod, 'type="plane" size="1 1 1" pos="0.034 0.012 0" zaxis="-0.6 -0.8 0"')
    obstacle = Plane(centre=(0.034, 0.012, 0.0), normal=tuple(normal), direction=(0, 1, 0))
    expected = force(rod, obstacle)
    assert found == pytest.approx(expected, rel=0.003) and found > 0.3


def test_a_long_capsule_presses_as_a_cylinder(rod):
    place = 'size="0.01 0.1" pos="0.027 0.021 0.001"'
    forces = [pressed(rod, f'type="{kind}" {place}')[1] for kind in ("capsule", "cylinder")]
    assert forces[0] == pytest.approx(forces[1], rel=1e-9) and forces[0] > 0.5


@pytest.mark.parametrize("euler", ["90 0 0", "0 90 0"])
def test_the_ends_of_a_cylinder_press_as_those_of_a_prism(rod, euler):
    forces = [
        pressed(rod, f'{kind} pos="0.027 0.016 0.001" euler="{euler}"', tension=20.0)[1]
        for kind in ('type="cylinder" size="0.008 0.006"', 'type="mesh" mesh="prism"')
    ]
    assert forces[0] == pytest.approx(forces[1], rel=0.02) and forces[0] > 0.3


def test_an_object_deeper_than_it_is_large_is_marked(rod):
    simulation, _ = pressed(rod, 'type="sphere" size="0.0003" pos="0.027 0.0075 0"')
    assert simulation.lost.all()
    simulation, found = pressed(rod, 'type="sphere" size="0.001" pos="0.027 0.0085 0"')
    small = Sphere(centre=(0.027, 0.0085, 0.0), radius=0.001, direction=(0, 1, 0), distances=(-0.02, 0.02))
    assert found == pytest.approx(force(rod, small), rel=0.003) and not simulation.lost.any()


def test_an_ellipsoid_touches_the_blocks(rod):
    simulation, found = pressed(rod, 'type="ellipsoid" size="0.01 0.01 0.011" pos="0.027 0.021 0"')
    ball = Sphere(centre=(0.027, 0.021, 0.0), radius=0.01, direction=(0, 1, 0), distances=(-0.01, 0.02))
    assert found == pytest.approx(force(rod, ball), rel=0.2)
    assert np.count_nonzero(simulation.data.contact.exclude == 0) <= 2


def test_two_fingers_squeeze_a_free_ball_equally(rod):
    text = (
        '<mujoco><option gravity="0 0 0"/><worldbody><body name="palm"/><body pos="0 0 -0.028"><freejoint/>'
        '<geom type="sphere" size="0.015" mass="0.05" friction="0.8 0.001 0.0001" condim="4"/></body></worldbody>'
        "</mujoco>"
    )
    spec = mujoco.MjSpec.from_string(text)
    fingers = attach_gripper(spec, rod, "palm", fingers=2, radius=0.02)
    simulation = Simulation(spec.compile(), fingers)
    for finger in range(2):
        simulation.pull(finger, [40.0, 0.0])
    simulation.advance(1.0)
    before = simulation.data.qpos[:3].copy()
    simulation.advance(2.0)
    forces = simulation.contact_forces()
    assert forces[0] == pytest.approx(forces[1], rel=0.01) and forces[0] > 0.5
    assert np.linalg.norm(simulation.data.qpos[:3] - before) < 1e-6


@pytest.mark.parametrize("friction", [0.3, 0.8])
def test_rubber_that_sticks_and_slides_on_a_ball_feels_what_coulomb_s_law_says(rod, friction):
    centre, radius = (0.028, 0.020, 0.0), 0.010
    pulled = [*np.linspace(24, 40, 17), *np.linspace(40, 34, 13)[1:]]
    ball = Sphere(centre=centre, radius=radius, direction=(0, 1, 0), distances=(-0.01, 0.02))
    model = TouchedSegment(rod=rod, obstacle=ball)
    history = friction_history(model, [[tension, 0.0, 0.0] for tension in pulled], friction, increments=2)
    expected = np.array([one.contact_force for one in history])
    geom = f'type="sphere" size="{radius}" pos="{" ".join(map(str, centre))}" friction="{friction} 0 0"'
    spec = mujoco.MjSpec.from_string(SCENE.format(geom=geom, options="", vertices="0 0 0 1 0 0 0 1 0 0 0 1"))
    finger, found = attach(spec, rod, "palm"), []
    simulation = Simulation(spec.compile(), [finger], rate=20.0)
    for tension in pulled:
        simulation.pull(0, (tension, 0.0))
        simulation.advance(simulation.time + (1.5 if not found else 1.0 / simulation.rate[0]))
        found.append(sum(simulation.data.sensor(one).data[1] for one in finger.sensors))
    assert np.abs(found - expected)[4:].max() < 0.015 * expected.max()  # the first ones depend on how it was touched
    assert simulation.unsettled < 0.05 * simulation.time / simulation.model.opt.timestep
