import numpy as np
import pytest
from assembled import in_series
from scipy.spatial.transform import Rotation

mujoco = pytest.importorskip("mujoco")

from control import Flaws, Gripper  # noqa: E402
from control.grasping.grasp_options import GraspOptions  # noqa: E402
from control.motion import Limits  # noqa: E402
from control.mujoco import Simulation, SimulationStopped, attach, attach_gripper, plants  # noqa: E402
from rom import Cylinder, Sphere, TouchedSegment, friction_history  # noqa: E402
from tests.rom.rod.inverse import inverse  # noqa: E402

WALL = 0.010  # [m], the paper's d
SCENE = """
<mujoco>
  <option timestep="{step}" gravity="0 0 {gravity}" cone="elliptic" impratio="10"/>
  <worldbody>
    <body name="palm" pos="0 0 0.1" euler="{euler}">
      <geom name="wall" type="plane" pos="0 {wall} 0" zaxis="0 -1 0" size="1 1 1" condim="4"
            friction="{friction} 0.001 0.0001"/>
    </body>
  </worldbody>
</mujoco>
"""
TABLE = """
<mujoco>
  <option timestep="0.001" cone="elliptic" impratio="10"/>
  <worldbody>
    <geom name="table" type="plane" size="1 1 0.1"/>
    <body name="palm" pos="0 0 0.062">
      <joint name="lift" type="slide" axis="0 0 1"/>
      <geom type="cylinder" size="0.04 0.005" pos="0 0 0.006" mass="0.5"/>
    </body>
    <body name="object" pos="0.002 0.001 0.0201">
      <freejoint/>
      <geom type="box" size="0.012 0.012 0.02" mass="0.05" friction="{friction} 0.001 0.0001" condim="4"/>
    </body>
  </worldbody>
  <actuator><position name="lift" joint="lift" kp="5000" kv="200"/></actuator>
</mujoco>
"""


def before_a_wall(rod, step=0.001, gravity=0.0, euler="0 0 0", wall=0.005 + WALL, friction=0):
    text = SCENE.format(step=step, gravity=gravity, euler=euler, wall=wall, friction=friction)
    spec = mujoco.MjSpec.from_string(text)
    return compiled(spec, rod)


def compiled(spec, rod):
    finger = attach(spec, rod, "palm")
    return Simulation(spec.compile(), [finger])


def rested(simulation, tensions, seconds=0.5):
    simulation.pull(0, tensions)
    simulation.advance(simulation.time + seconds)
    return float(simulation.contact_forces()[0])


@pytest.mark.parametrize("tensions", [(20.0, 0.0), (30.0, 0.0), (40.0, 10.0)])
def test_a_finger_at_rest_presses_as_its_rod_says(rod, tensions):
    model = TouchedSegment.load()
    expected = float(model.evaluate([*tensions, WALL]).contact_force)
    assert expected > 0.1
    simulation = before_a_wall(rod)
    assert rested(simulation, tensions) == pytest.approx(expected, rel=0.004)
    assert not simulation.left.any() and not simulation.lost.any()


def test_without_contact_and_gravity_a_plate_rests_where_the_rod_has_it(rod):
    simulation = before_a_wall(rod, wall=1.0)
    assert rested(simulation, (25.0, 15.0)) == 0.0
    expected = rod.place([25.0, 15.0]).centres[0]
    found = simulation.data.body("finger plate 0").xpos - simulation.data.body("finger clamp").xpos
    np.testing.assert_allclose(found, expected, atol=1e-12)
    assert np.abs(simulation.wrenches()[0]).max() < 1e-8


def test_a_model_s_defaults_for_others_do_not_reach_the_finger(rod):
    hostile = '<default><joint damping="1" armature="0.01"/><geom contype="0" condim="1" gap="0.001"/></default>'
    forces = []
    for defaults in ("", hostile):
        text = SCENE.format(step=0.001, gravity=0.0, euler="0 0 0", wall=0.005 + WALL, friction=0)
        text = text.replace("<worldbody>", f"{defaults}<worldbody>").replace(
            'condim="4"', 'condim="4" contype="1" gap="0"'
        )
        forces.append(rested(compiled(mujoco.MjSpec.from_string(text), rod), (30.0, 0.0)))
    assert forces[0] == pytest.approx(forces[1], rel=1e-9) and forces[0] > 1


def test_plants_go_on_when_the_user_has_let_time_pass_or_begun_anew(rod):
    simulation = before_a_wall(rod)
    (plant,) = plants(simulation, period=0.01, flaws=Flaws(delay=2))
    for _ in range(5):
        plant.pull((10.0, 0.0))
    assert simulation.time == pytest.approx(0.05) and plant.age == pytest.approx(0.02)
    simulation.advance(1.0)
    plant.pull((10.0, 0.0))
    plant.pull((10.0, 0.0))
    assert simulation.time == pytest.approx(1.02)
    simulation.reset()
    plant.pull((10.0, 0.0))
    assert simulation.time == pytest.approx(0.01)


def test_a_step_that_the_solver_leaves_early_counts_as_unsettled(rod):
    """The finger reaches the wall within 0.2 s; one Newton iteration does not suffice there."""
    settled, cut = before_a_wall(rod), before_a_wall(rod)
    cut.model.opt.iterations = 1
    for one in (settled, cut):
        one.pull(0, (30.0, 5.0))
        one.advance(0.2)
        assert one.contact_forces()[0] > 1
    assert settled.unsettled < 5 < cut.unsettled


@pytest.mark.long
def test_half_the_step_changes_a_held_force_little(rod):
    forces = [rested(before_a_wall(rod, step=step, gravity=-9.81), (30.0, 5.0)) for step in (0.001, 0.0005)]
    assert abs(forces[0] / forces[1] - 1) < 0.01
    assert forces[0] != forces[1]


@pytest.mark.parametrize("friction", [0.3, 1.0])
def test_a_finger_that_sticks_and_slides_feels_what_coulomb_s_law_says(rod, friction):
    """Pulled to 34 N, let go to 31 N: it slides up, sticks, so that less tension presses harder, and slides down."""
    pulled = [*np.linspace(24, 34, 21), *np.linspace(34, 31, 13)[1:]]
    model = TouchedSegment.load()
    history = friction_history(model, [[tension, 0.0, WALL + 0.003] for tension in pulled], friction, increments=2)
    expected = np.array([one.contact_force for one in history])
    simulation = before_a_wall(rod, wall=0.005 + WALL + 0.003, friction=friction)
    simulation.rate, found = 20.0, []
    rested(simulation, (24.0, 0.0), seconds=1.5)
    for tension in pulled:
        simulation.pull(0, (tension, 0.0))
        simulation.advance(simulation.time + 0.5 / simulation.rate)
        found.append(float(simulation.contact_forces()[0]))
    assert np.abs(found - expected).max() < 0.05 * expected.max()
    assert simulation.unsettled < 0.02 * simulation.time / simulation.model.opt.timestep
    turned = pulled.index(34.0)
    assert expected[turned + 4] > 1.1 * expected[turned] and found[turned + 4] > 1.1 * found[turned]


def test_nothing_is_ever_nan_whatever_is_done_to_a_plate(rod, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)  # MuJoCo writes its warnings to where it runs
    random = np.random.default_rng(22)
    simulation = before_a_wall(rod, euler="200 30 -80", gravity=-9.81)
    body, ended = simulation.model.body("finger plate 0").id, 0
    for _ in range(20):
        simulation.reset()
        simulation.pull(0, random.uniform(0, 100, 2))
        simulation.data.xfrc_applied[body] = np.append(random.normal(0, 30, 3), random.normal(0, 0.2, 3))
        try:
            simulation.advance(0.05)
        except SimulationStopped as stopped:
            assert stopped.finger == "finger" or "shorter step" in str(stopped)
            ended += stopped.finger is None
            continue
        assert np.isfinite(simulation.data.qpos).all() and np.isfinite(simulation.contact_forces()).all()
        assert np.isfinite(simulation.wrenches()[0]).all()
    assert ended <= 2


def test_a_push_beyond_what_was_trained_is_marked(rod):
    simulation = before_a_wall(rod, wall=1.0)
    simulation.data.xfrc_applied[simulation.model.body("finger plate 0").id, 0] = -20.0
    simulation.advance(0.05)
    assert (simulation.left | simulation.lost).all()
    simulation.reset()
    assert not simulation.left.any() and not simulation.lost.any()


def lead(rod, tension):
    return [tension] + [0.0] * (len(rod.names) - 1)


def before_an_object(rod, geom, centre, tension, options=""):
    body = f'<body name="palm"/><body pos="{" ".join(map(str, centre))}"><geom {geom} friction="0 0 0"/></body>'
    scene = f'<mujoco><option gravity="0 0 0" {options}/><worldbody>{body}</worldbody></mujoco>'
    simulation = compiled(mujoco.MjSpec.from_string(scene), rod)
    rested(simulation, lead(rod, tension), seconds=1.0)
    forces = np.array([simulation.data.sensor(one).data for one in simulation.fingers[0].sensors])
    return forces.sum(axis=0)


@pytest.mark.parametrize(
    ("name", "centre", "radius", "axis", "tension"),
    [
        ("finger", (0.025, 0.020, 0.0), 0.010, None, 30.0),
        ("finger", (0.030, 0.018, 0.001), 0.008, None, 30.0),
        ("finger", (0.022, 0.017, 0.0), 0.012, None, 50.0),
        ("finger", (0.027, 0.022, 0.0), 0.012, (0.0, 0.0, 1.0), 40.0),
        ("finger", (0.028, 0.020, 0.002), 0.011, (1.0, 0.0, 0.0), 40.0),
        ("round", (0.040, 0.033, 0.002), 0.020, None, 5.0),
    ],
)
def test_rubber_presses_as_the_rod_says(name, centre, radius, axis, tension):
    """On balls, and on cylinders across and along the finger."""
    rod = TouchedSegment.load(name).rod
    if "gravity" in rod.scene:
        rod = rod.with_gravity((1.0, 0.0, 0.0), 1e-9)
    given = {"centre": centre, "radius": radius, "direction": (0, 1, 0)}
    geom = f'type="sphere" size="{radius}"'
    object_ = Sphere(**given, distances=(-0.01, 0.02)) if axis is None else Cylinder(**given, axis=axis)
    if axis is not None:
        geom = f'type="cylinder" size="{radius} 0.1" zaxis="{" ".join(map(str, axis))}"'
    expected = float(TouchedSegment(rod=rod, obstacle=object_).evaluate([*lead(rod, tension), 0.0]).contact_force)
    assert before_an_object(rod, geom, centre, tension)[1] == pytest.approx(expected, rel=0.002) and expected > 0.3


def test_two_segments_rest_where_their_elements_have_them(rod):
    both = in_series(rod, 2)
    spec = mujoco.MjSpec.from_string(SCENE.format(step=0.001, gravity=0.0, euler="0 0 0", wall=1.0, friction=0))
    finger = attach(spec, both, "palm")
    simulation = Simulation(spec.compile(), [finger])
    simulation.pull(0, [20.0, 8.0])
    simulation.advance(1.0)
    placed = both.place([20.0, 8.0])
    palm = simulation.data.body("palm").xpos
    for name, centre in zip(finger.plates, placed.centres, strict=True):
        np.testing.assert_allclose(simulation.data.body(name).xpos - palm, centre, atol=1e-6)


def test_a_plate_led_around_a_closed_loop_gets_no_work_from_its_rubber(rod):
    """At tensions that stay: rubber and tendons have a potential, which no element was trained with."""
    wrench, angles = np.zeros(6), np.linspace(0, 2 * np.pi, 2001)
    work = exchanged = 0.0
    before = None
    for angle in angles:
        pressed = np.array([0.3 * np.sin(angle), -1 - np.cos(angle), 0.7 * np.sin(2 * angle), 0.0, 0.002, 0.0])
        placed = rod.place([30.0, 10.0], [pressed])
        centre, rotation = placed.centres[0], placed.rotations[0]
        quaternion = Rotation.from_matrix(rotation).as_quat()[[3, 0, 1, 2]]
        wrench = inverse(rod.segments[0].struct, [30.0, 10.0], centre, quaternion, wrench).wrench
        if before is not None:
            turn = before[1].T @ rotation
            moved = np.concatenate([before[1].T @ (centre - before[0]), Rotation.from_matrix(turn).as_rotvec()])
            done = (before[2] + wrench) / 2 @ moved
            work, exchanged = work + done, exchanged + abs(done)
        before = centre, rotation, wrench
    assert exchanged > 1e-3  # [J]
    assert abs(work) < 1e-3 * exchanged


@pytest.mark.long
def test_a_gripper_picks_up_a_box_with_its_controllers_unchanged(rod):
    spec = mujoco.MjSpec.from_string(TABLE.format(friction=0.6))
    fingers = attach_gripper(spec, rod, "palm")
    simulation = Simulation(spec.compile(), fingers)
    gripper = Gripper(TouchedSegment.load(), limits=Limits(rate=100.0))
    options = GraspOptions(period=0.01, tolerance=0.02, approach_step=1.0, squeeze_steps=10, pulls=1000)
    grasp = gripper.grasp(1.0, plants(simulation), options)
    assert grasp.converged
    before = simulation.data.body("object").xpos[2]
    for k in range(100):
        simulation.data.ctrl[0] = 0.05 * (k + 1) / 100
        simulation.advance(simulation.time + 0.01)
    simulation.advance(simulation.time + 0.5)
    assert simulation.data.body("object").xpos[2] > before + 0.045
    np.testing.assert_allclose(simulation.contact_forces(), 1.0, rtol=0.1)
    assert not simulation.left.any() and not simulation.lost.any()


@pytest.mark.long
def test_what_is_too_slippery_for_a_force_is_left_behind(rod):
    spec = mujoco.MjSpec.from_string(TABLE.format(friction=0.05))
    fingers = attach_gripper(spec, rod, "palm")
    simulation = Simulation(spec.compile(), fingers)
    options = GraspOptions(period=0.01, tolerance=0.02, approach_step=1.0, squeeze_steps=10, pulls=1000)
    Gripper(TouchedSegment.load(), limits=Limits(rate=100.0)).grasp(1.0, plants(simulation), options)
    for k in range(100):
        simulation.data.ctrl[0] = 0.05 * (k + 1) / 100
        simulation.advance(simulation.time + 0.01)
    assert simulation.data.body("object").xpos[2] < 0.03


def test_what_cannot_be_is_refused(rod):
    spec = mujoco.MjSpec.from_string(SCENE.format(step=0.001, gravity=0.0, euler="0 0 0", wall=1.0, friction=0))
    for given, said in [
        ({"palm": "nobody"}, "palm must be a body"),
        ({"palm": "palm", "position": [0, np.nan, 0]}, "position must be"),
        ({"palm": "palm", "quaternion": [0, 0, 0, 0]}, "quaternion must be"),
        ({"palm": "palm", "density": 0.0}, "density must be"),
        ({"palm": "palm", "relaxation": -1.0}, "relaxation must be"),
    ]:
        with pytest.raises(ValueError, match=said):
            attach(spec, rod, **given)
    simulation = compiled(spec, rod)
    for tensions in ([1.0], [np.nan, 0.0], [101.0, 0.0]):
        with pytest.raises(ValueError, match="tensions must be"):
            simulation.pull(0, tensions)
    with pytest.raises(ValueError, match="period must be"):
        plants(simulation, period=1e-5)
    spec.option.integrator = mujoco.mjtIntegrator.mjINT_RK4
    with pytest.raises(ValueError, match="integrator must be"):
        Simulation(spec.compile(), simulation.fingers)
