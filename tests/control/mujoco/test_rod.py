"""Weight and inertia of the rubber in MuJoCo: a beam's sag, the rod's own static answer, bases that accelerate."""

from dataclasses import replace

import numpy as np
import pytest
from assembled import in_series, scaled
from scipy.spatial.transform import Rotation

mujoco = pytest.importorskip("mujoco")

from control.mujoco import Simulation, SimulationStopped, attach  # noqa: E402
from control.mujoco.rod import Beam, united  # noqa: E402
from rom import Rod, TouchedSegment  # noqa: E402

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
def rod():
    return TouchedSegment.load().rod


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
    """Of the plates, seen from the clamp, shape (plates, 3) [m]."""
    clamp = simulation.data.body("finger clamp")
    away = [simulation.data.body(plate).xpos - clamp.xpos for plate in simulation.fingers[0].plates]
    return np.array(away) @ clamp.xmat.reshape(3, 3)


def static_places(rod, tensions, gravity):
    """The elements' own answer: at each end half the rubber's weight, and m g L / 12 about the end."""
    half, count = rod.half_lengths, len(rod.segments)
    lengths = [length - 2 * half[0] for length in rod.scene["geometry"]["segments"]]
    area = 4 * half[1] * half[2]
    wrenches = np.zeros((count, 6))
    for _ in range(100):
        placed = rod.place(tensions, wrenches)
        for k, rotation in enumerate(placed.rotations):
            loads = [(DENSITY * area * 2 * half[0], 0.0)]  # mass [kg], and its lever on the plate's axis [m]
            loads += [(DENSITY * area * lengths[k] / 2, -half[0] - lengths[k] / 6)]
            loads += [(DENSITY * area * length / 2, half[0] + length / 6) for length in lengths[k + 1 : k + 2]]
            own = rotation.T @ gravity
            force, lever = sum(mass for mass, _ in loads), sum(mass * lever for mass, lever in loads)
            wrenches[k] = 0.5 * wrenches[k] + 0.5 * np.array([*(force * own), *np.cross([lever, 0.0, 0.0], own)])
    return placed.centres


def test_both_ends_of_a_straight_rod_are_a_rigid_body():
    beam = Beam(3.0, 0.7)
    whole = united([beam.clamp(0.0), beam.end(0.7)])
    assert whole.mass == pytest.approx(3.0) and whole.x == pytest.approx(0.35)
    assert whole.moment == pytest.approx(3.0 * 0.7**2 / 12)


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


def test_weight_off_is_off(rod):
    simulation = simulation_of(rod, (0.0, -9.81, 0.0), relaxation=0.005)
    simulation.model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_GRAVITY
    simulation.advance(0.5)
    np.testing.assert_allclose(places(simulation)[0], rod.place(np.zeros(2)).centres[0], atol=1e-10)


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


def test_a_base_that_goes_round_presses_outwards(rod):
    """On an arm of 10 m, so that the acceleration differs by 0.5 % along the finger."""
    joints = '<joint name="arm" type="hinge" axis="0 0 1" pos="0 -10 0"/>'
    simulation = simulation_of(rod, joints=joints, mass=1e6, relaxation=0.005)
    simulation.data.qvel[0] = np.sqrt(9.81 / 10.0)
    simulation.advance(0.5)
    centre, rest = places(simulation)[0], rod.place(np.zeros(2)).centres[0]
    expected = static_places(rod, np.zeros(2), np.array([0.0, 9.81, 0.0]))[0]
    assert centre[1] - rest[1] == pytest.approx(expected[1] - rest[1], rel=0.01)


def test_the_inertia_of_both_ends_is_the_consistent_mass_matrix(rod):
    """Of motions across the finger: those of the palm, which is a point, and those of the plate."""
    joints = '<joint type="slide" axis="0 1 0"/><joint type="hinge" axis="0 0 1"/>'
    simulation = simulation_of(rod, joints=joints, mass=1e-9)
    model, data = simulation.model, simulation.data
    mujoco.mj_step1(model, data)
    simulation.springs[0].coupling.add()
    full = np.zeros((model.nv, model.nv))
    mujoco.mju_sym2dense(full, data.M, model.M_rownnz, model.M_rowadr, model.M_colind)
    across = [0, 1, 3, 7]  # velocity and turn of the palm, then of the plate's centre, which adds to these
    half, side = rod.half_lengths[0], rod.half_lengths[1]
    mass, length = simulation.fingers[0].beams[0]
    consistent = np.array(
        [
            [156, 22 * length, 54, -13 * length],
            [22 * length, 4 * length**2, 13 * length, -3 * length**2],
            [54, 13 * length, 156, -22 * length],
            [-13 * length, -3 * length**2, -22 * length, 4 * length**2],
        ]
    )
    consistent *= mass / 420
    reach = length + half
    ends = np.array([[1, 0, 0, 0], [0, 1, 0, 0], [1, reach - half, 1, -half], [0, 1, 0, 1]], float)
    expected = ends.T @ consistent @ ends
    plate = mass * 2 * half / length
    centre, turn = np.array([1, reach, 1, 0]), np.array([0, 1, 0, 1])
    expected += plate * (np.outer(centre, centre) + (half**2 + side**2) / 3 * np.outer(turn, turn))
    expected[1, 1] += 2 / 3 * mass * side**2 / 3  # of the rubber's sections
    expected += 1 / 3 * mass * side**2 / 3 * np.outer(turn, turn)
    np.testing.assert_allclose(full[np.ix_(across, across)], expected, rtol=1e-6)


def test_a_finger_a_length_beyond_its_domain_stops_the_simulation(silicone):
    simulation = simulation_of(silicone, (0.0, -400.0, 0.0))
    with pytest.raises(SimulationStopped, match=r"'finger' must stay within 0\.1 m of its trained domain, got") as stop:
        simulation.advance(30.0)
    assert simulation.left.all() and stop.value.finger == "finger"
    assert 0.1 < stop.value.distance < 0.2 and stop.value.time == simulation.time < 30.0
    simulation.reset()
    simulation.model.opt.gravity[:] = 0.0
    simulation.advance(0.1)
    assert not simulation.left.any()
