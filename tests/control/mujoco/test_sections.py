"""Sections as bodies in MuJoCo: their masses, weight on any base, frequencies, bases that accelerate."""

from dataclasses import replace

import numpy as np
import pytest
from assembled import in_series, scaled
from scipy.linalg import eigh
from scipy.spatial.transform import Rotation

mujoco = pytest.importorskip("mujoco")

from control.mujoco import Simulation, SimulationStopped, attach  # noqa: E402
from control.mujoco.sections import bodies_of  # noqa: E402
from rom import MovingFinger, Rod, TouchedSegment  # noqa: E402
from rom.rod import shape  # noqa: E402
from rom.rod.motion.lumps import lumps_of  # noqa: E402

DENSITY = 1100.0  # [kg/m^3]
YOUNG = 47.7e3  # [Pa], of silicone
BUNDLED = 9.88e6  # [Pa], of the bundled finger
SCENE = """
<mujoco>
  <option timestep="0.001" gravity="{gravity}"/>
  <worldbody>
    <body name="palm">{joints}<geom type="sphere" size="0.01" mass="{mass}" contype="0" conaffinity="0"/></body>
  </worldbody>
</mujoco>
"""


@pytest.fixture(scope="module")
def silicone(rod):
    """A finger of 20 x 20 x 100 mm with a plate of 2 mm."""
    return scaled(rod, 2.0, YOUNG / BUNDLED)


def simulation_of(rod, gravity=(0.0, 0.0, 0.0), joints="", mass=1.0, relaxation=0.2, **options):
    text = SCENE.format(gravity=" ".join(map(str, gravity)), joints=joints, mass=mass)
    spec = mujoco.MjSpec.from_string(text)
    finger = attach(spec, rod, "palm", relaxation=relaxation, density=DENSITY, **options)
    return Simulation(spec.compile(), [finger])


def places(simulation):
    """Positions of the plates, seen from the clamp, shape (plates, 3) [m]."""
    clamp = simulation.data.body("finger clamp")
    away = [simulation.data.body(plate).xpos - clamp.xpos for plate in simulation.fingers[0].plates]
    return np.array(away) @ clamp.xmat.reshape(3, 3)


def loaded(rod):
    """Bodies of a rod's loads among those of `bodies_of`: plates, then sections of each from the plate to the clamp."""
    bodies = bodies_of(rod)
    plates = [k for k, body in enumerate(bodies) if body.is_plate]
    return plates + [k for begin, end in zip([0, *plates], plates, strict=False) for k in range(end - 1, begin, -1)]


def static_places(rod, tensions, gravity):
    """The rod's own answer, with the weight of every body at its centre."""
    lumps, order = lumps_of(rod, DENSITY, DENSITY), np.array(loaded(rod)) - 1
    loads = np.zeros((len(lumps.masses), 6))
    for _ in range(60):
        sections = shape.placed(rod, np.asarray(tensions, float), loads.ravel())
        own = np.array([sections[k].rotation.T @ gravity for k in order])
        weights = np.hstack([lumps.masses[:, None] * own, np.cross(lumps.moments, own)])
        loads = 0.5 * (loads + weights)
    return rod.place(tensions, loads.ravel()).centres


@pytest.mark.parametrize("count", [1, 2])
def test_bodies_have_the_masses_of_the_rod_s_lumps(rod, count):
    own = in_series(rod, count)
    lumps, bodies, order = lumps_of(own, DENSITY, DENSITY), bodies_of(own), loaded(own)
    assert len(order) == len(bodies) - 1 == len(lumps.masses)
    for k, mass, moment, inertia in zip(order, lumps.masses, lumps.moments, lumps.inertias, strict=True):
        found, centre, moments = bodies[k].inertia(own, DENSITY)
        about = moments + found * (centre @ centre - centre**2)
        assert found == pytest.approx(mass) and found * centre == pytest.approx(moment, abs=1e-15)
        assert np.diag(about) == pytest.approx(inertia, abs=1e-15)
    whole = sum(body.inertia(own, DENSITY)[0] for body in bodies)
    assert whole == pytest.approx(DENSITY * 0.01**2 * 0.05 * count)


def frequencies_of(simulation):
    """By MuJoCo's inertia and the stiffness of all elements, at rest without tensions, shape (nv,) [Hz]."""
    model, data, h = simulation.model, simulation.data, simulation.model.opt.timestep
    mujoco.mj_step1(model, data)
    masses, both = np.zeros((2, model.nv, model.nv))
    mujoco.mju_sym2dense(masses, data.M, model.M_rownnz, model.M_rowadr, model.M_colind)
    simulation.rubber[0].pull(np.zeros(2), h)
    mujoco.mju_sym2dense(both, data.M, model.M_rownnz, model.M_rowadr, model.M_colind)
    return np.sqrt(eigh((both - masses) / h**2, masses, eigvals_only=True)) / (2 * np.pi)


def test_frequencies_are_nearly_those_of_a_moving_finger(rod):
    """Lumps alone: the first is right within 0.2 %, the second across the axis within 2.5 %, the third within 8 %."""
    finger = MovingFinger(TouchedSegment.load(), [0.0, 0.0, 0.03], density=DENSITY, plate_density=DENSITY)
    off = frequencies_of(simulation_of(rod, relaxation=0.0))[:8] / finger.frequencies(np.zeros(2), 8) - 1
    assert np.abs(off[:2]).max() < 0.002 and np.abs(off[2:6]).max() < 0.025 and np.abs(off[6:]).max() < 0.08


def test_a_released_finger_rings_at_its_first_frequency(rod):
    simulation = simulation_of(rod, relaxation=0.0)
    expected = frequencies_of(simulation)[0]
    simulation.model.opt.timestep = 5e-5
    simulation.reset()
    tip, at_rest = simulation.data.body("finger plate 0"), rod.place(np.zeros(2)).centres[0, 1]
    simulation.data.xfrc_applied[tip.id, 1] = 0.02
    simulation.advance(0.05)
    simulation.data.xfrc_applied[:] = 0.0
    heights = []
    for _ in range(1600):
        simulation.step()
        heights.append(tip.xpos[1] - at_rest)
    rising = np.flatnonzero(np.diff(np.sign(heights)) > 0)
    assert 1 / (np.diff(rising).mean() * 5e-5) == pytest.approx(expected, rel=0.01)


@pytest.mark.parametrize(("gravity", "beam"), [(0.1, 0.854e-3), (0.3, 2.56e-3)])
def test_a_horizontal_finger_sags_like_a_beam(silicone, gravity, beam):
    simulation = simulation_of(silicone, (0.0, -gravity, 0.0))
    simulation.advance(6.0)
    sag = silicone.place(np.zeros(2)).centres[0, 1] - places(simulation)[0, 1]
    area, length, half, bending = 0.02**2, 0.098, 0.001, YOUNG * 0.02**4 / 12
    load, weight = DENSITY * area * gravity, DENSITY * area * 2 * half * gravity
    formula = load * length**3 / bending * (length / 8 + half / 6) + weight * (length + half) ** 3 / (3 * bending)
    assert formula == pytest.approx(beam, rel=0.002)
    assert sag == pytest.approx(formula, rel=0.035)  # shear adds some 4 % to the beam's, the clamp takes some off


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("count", [1, 2])
def test_in_any_orientation_plates_rest_where_the_rod_has_them_under_their_weight(rod, count, seed):
    random, own = np.random.default_rng(seed), in_series(rod, count)
    direction, quaternion = random.normal(size=3), random.normal(size=4)
    gravity = 9.81 * direction / np.linalg.norm(direction)
    tensions = random.uniform(0.0, 15.0, 2)
    simulation = simulation_of(own, gravity, relaxation=0.005, quaternion=quaternion)
    simulation.pull(0, tensions)
    simulation.advance(1.5)
    turned = Rotation.from_quat(quaternion[[1, 2, 3, 0]]).as_matrix()
    expected = static_places(own, tensions, turned.T @ gravity)
    assert np.abs(expected - own.place(tensions).centres).max() > 1e-5
    np.testing.assert_allclose(places(simulation), expected, atol=1e-10)


@pytest.mark.parametrize("length", [0.005, 0.02, 0.03, 0.2])
def test_a_finger_of_any_slenderness_has_an_inertia_that_mujoco_takes(rod, length):
    elements, rubber = rod.elements, length - rod.half_lengths[0]
    whole = replace(elements.laws["clamp"], lengths=(rubber, rubber))  # shorter than a clamp and a plate piece
    one = replace(elements, laws={"whole": whole}, outlines={"whole": elements.outlines["clamp"]})
    scene = rod.scene | {"geometry": rod.scene["geometry"] | {"segments": [length]}}
    short = in_series(Rod(elements=one, scene=scene), 2)
    spec = mujoco.MjSpec.from_string(SCENE.format(gravity="0 0 0", joints="", mass=1.0))
    attach(spec, short, "palm", density=DENSITY)
    assert spec.compile().body_subtreemass[1] == pytest.approx(1.0 + 2 * DENSITY * 0.01**2 * length)


@pytest.mark.parametrize("count", [1, 2])
def test_on_a_base_that_accelerates_a_finger_bends_as_under_gravity(rod, count):
    own, gravity = in_series(rod, count), np.array([3.0, -7.0, 5.0])
    axes = ("1 0 0", "0 1 0", "0 0 1")
    slides = "".join(f'<joint type="slide" axis="{axis}"/>' for axis in axes)
    carried = simulation_of(own, joints=slides, mass=1e9, relaxation=0.005)
    body = carried.model.body("palm").id
    carried.data.xfrc_applied[body, :3] = -gravity * carried.model.body_subtreemass[body]
    carried.advance(1.0)
    np.testing.assert_allclose(carried.data.qvel[:3], -gravity, rtol=1e-6)
    expected = static_places(own, np.zeros(2), gravity)
    np.testing.assert_allclose(places(carried), expected, atol=1e-9)


def test_a_finger_that_falls_freely_with_a_light_palm_does_not_bend(rod):
    both = in_series(rod, 2)
    simulation = simulation_of(both, (2.0, 3.0, -9.81), joints="<freejoint/>", mass=1e-4, relaxation=0.005)
    simulation.pull(0, [20.0, 8.0])
    simulation.advance(1.0)
    simulation.data.qvel[:6] = 0.0, 0.0, 0.0, 0.3, -0.2, 0.1
    simulation.data.qvel[6:] = 0.0
    simulation.advance(1.05)
    np.testing.assert_allclose(places(simulation), both.place([20.0, 8.0]).centres, atol=1e-6)


def momentum(simulation):
    """Linear momentum [kg m/s], and angular momentum about the centre of mass [kg m^2/s]."""
    model, data = simulation.model, simulation.data
    mujoco.mj_subtreeVel(model, data)
    return model.body_subtreemass[1] * data.subtree_linvel[1], data.subtree_angmom[1].copy()


def test_a_finger_that_floats_freely_keeps_its_momentum_to_the_order_of_the_step(rod):
    """Rubber and tendons act between bodies alone. Tensions jump, so that sections vibrate."""
    errors = []
    for timestep in 1e-3, 5e-4:
        simulation = simulation_of(in_series(rod, 2), joints="<freejoint/>", mass=1e-3, relaxation=0.005)
        simulation.model.opt.timestep = timestep
        simulation.data.qvel[:6] = 0.1, 0.2, -0.1, 3.0, -2.0, 1.0
        mujoco.mj_forward(simulation.model, simulation.data)
        begun = momentum(simulation)
        simulation.pull(0, [20.0, 8.0])
        reached = []
        for _ in range(round(0.2 / timestep)):
            simulation.step()
            reached.append(momentum(simulation))
        changes = np.abs(np.array(reached) - begun).max(axis=(0, 2))
        errors.append(changes / np.linalg.norm(begun, axis=1))
    assert (errors[1] < [0.005, 0.02]).all()
    np.testing.assert_allclose(errors[1] / errors[0], 0.5, atol=0.02)


def test_a_base_that_goes_round_presses_outwards(rod):
    """On an arm of 10 m, so that the acceleration differs by 0.5 % along the finger."""
    joints = '<joint name="arm" type="hinge" axis="0 0 1" pos="0 -10 0"/>'
    simulation = simulation_of(rod, joints=joints, mass=1e6, relaxation=0.005)
    simulation.data.qvel[0] = np.sqrt(9.81 / 10.0)
    simulation.advance(0.5)
    centre, rest = places(simulation)[0], rod.place(np.zeros(2)).centres[0]
    expected = static_places(rod, np.zeros(2), np.array([0.0, 9.81, 0.0]))[0]
    assert centre[1] - rest[1] == pytest.approx(expected[1] - rest[1], rel=0.01)


def test_a_released_finger_never_gains_energy(rod):
    """Kinetic energy, and what the elements store, by the work that they take, in steps of 1 ms."""
    simulation = simulation_of(rod, relaxation=0.0)
    tip = simulation.data.body("finger plate 0").id
    simulation.data.xfrc_applied[tip, 1:3] = 0.5, 0.2
    simulation.advance(0.5)
    simulation.data.xfrc_applied[:] = 0.0
    swings = [np.abs(places(simulation)[0, 1:]).max()]
    for _ in range(40):
        reached = []
        for _ in range(25):
            simulation.step()
            reached.append(np.abs(places(simulation)[0, 1:]).max())
        swings.append(max(reached))
    assert np.all(np.diff(swings) <= 1e-9) and swings[-1] < 0.5 * swings[0]


def test_a_finger_a_length_beyond_its_domain_stops_the_simulation(silicone):
    simulation = simulation_of(silicone, (0.0, -4000.0, 0.0))
    with pytest.raises(SimulationStopped, match=r"'finger' must stay within 0\.1 m of its trained domain, got") as stop:
        simulation.advance(30.0)
    assert simulation.left.all() and stop.value.finger == "finger"
    assert 0.1 < stop.value.distance < 0.2 and stop.value.time == simulation.time < 30.0
    simulation.reset()
    simulation.model.opt.gravity[:] = 0.0
    simulation.advance(0.1)
    assert not simulation.left.any()
