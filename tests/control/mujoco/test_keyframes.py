"""A user's keyframes keep their meaning when fingers are attached."""

import numpy as np
import pytest
from assembled import in_series

mujoco = pytest.importorskip("mujoco")

from control.mujoco import Simulation, attach, attach_gripper  # noqa: E402

SCENE = """
<mujoco>
  <worldbody>
    <body name="link">
      <joint name="first" type="hinge"/><geom size="0.01"/>
      <frame pos="0 0 1"><body name="wrist"><joint name="ball" type="ball"/><geom size="0.01"/></body></frame>
      <body name="tool"><joint name="slide" type="slide"/><geom size="0.01"/></body>
    </body>
    <body name="cup" pos="1 0 0"><freejoint name="cup"/><geom size="0.01"/></body>
  </worldbody>
  <actuator><position joint="first"/></actuator>
  <keyframe>
    <key name="home" qpos="0.1 0.6 0.8 0 0 0.2 1 2 3 1 0 0 0" qvel="1 2 3 4 5 6 7 8 9 10 11" ctrl="0.4"/>
    <key name="still" ctrl="0.5"/>
  </keyframe>
</mujoco>
"""
EXPECTED = {"first": [0.1], "ball": [0.6, 0.8, 0, 0], "slide": [0.2], "cup": [1, 2, 3, 1, 0, 0, 0]}
VELOCITIES = {"first": [1], "ball": [2, 3, 4], "slide": [5], "cup": [6, 7, 8, 9, 10, 11]}


def assert_home(simulation):
    simulation.reset("home")
    for name, expected in EXPECTED.items():
        np.testing.assert_array_equal(simulation.data.joint(name).qpos, expected)
        np.testing.assert_array_equal(simulation.data.joint(name).qvel, VELOCITIES[name])
    assert simulation.data.ctrl[0] == 0.4
    for joint in [one for finger in simulation.fingers for names in finger.joints for one in names]:
        own = simulation.data.joint(joint).qpos
        np.testing.assert_array_equal(own, [1, 0, 0, 0] if len(own) > 1 else [0])


@pytest.mark.parametrize("body", ["world", "link", "wrist", "tool", "cup"])
def test_coordinates_of_a_keyframe_stay_with_their_joints(rod, body):
    spec = mujoco.MjSpec.from_string(SCENE)
    fingers = [attach(spec, in_series(rod, 2), body), *attach_gripper(spec, rod, "link", name="more")]
    simulation = Simulation(spec.compile(), fingers)
    assert_home(simulation)
    simulation.reset("still")
    assert simulation.data.ctrl[0] == 0.5 and simulation.data.joint("first").qpos == 0.0


def test_keyframes_of_an_arm_stay_when_a_hand_is_attached_to_it(rod):
    spec = mujoco.MjSpec.from_string(SCENE)
    hand = mujoco.MjSpec.from_string('<mujoco><worldbody><body name="tool"/></worldbody></mujoco>')
    fingers = [one.renamed(prefix="hand/") for one in attach_gripper(hand, rod, "tool")]
    spec.attach(hand, prefix="hand/", frame=spec.body("wrist").add_frame())
    fingers.append(attach(spec, rod, "cup"))
    assert_home(Simulation(spec.compile(), fingers))


def test_a_keyframe_of_another_size_is_refused_by_name(rod):
    for name, numbers in (("qpos", 13), ("qvel", 11)):
        spec = mujoco.MjSpec.from_string(SCENE)
        setattr(spec.keys[0], name, np.zeros(numbers - 1))
        with pytest.raises(
            ValueError, match=f"{name} of keyframe 'home' must have {numbers} numbers, got {numbers - 1}"
        ):
            attach(spec, rod, "link")


def test_a_keyframe_that_is_none_is_refused_by_name(rod):
    spec = mujoco.MjSpec.from_string(SCENE)
    finger = attach(spec, rod, "link")
    simulation = Simulation(spec.compile(), [finger])
    with pytest.raises(ValueError, match=r"keyframe must be one of \['home', 'still'\], got 'start'"):
        simulation.reset("start")
