"""Scenes that users compose: several grippers, hands with a prefix, options of the compiler."""

import numpy as np
import pytest
from assembled import in_series

mujoco = pytest.importorskip("mujoco")

from control.mujoco import Simulation, attach, attach_gripper  # noqa: E402
from rom import TouchedSegment  # noqa: E402

HAND = """
<mujoco>
  <compiler {compiler}/>
  <option gravity="0 0 0"/>
  <worldbody>
    <body name="palm"><geom name="back" size="0.01"/></body>
    <body name="other palm" pos="1 0 0"/>
  </worldbody>
</mujoco>
"""
ARM = """
<mujoco>
  <option gravity="0 0 0"/>
  <worldbody>
    <body name="link"><joint type="hinge"/><geom size="0.01"/><site name="flange" pos="0 0 0.2"/></body>
    <body name="other link" pos="1 0 0"><site name="other flange"/></body>
  </worldbody>
</mujoco>
"""


def hand(compiler=""):
    return mujoco.MjSpec.from_string(HAND.format(compiler=compiler))


def rests(simulation, finger, rod, tensions):
    """True if a finger's plates rest where its elements have them."""
    clamp = simulation.data.body(finger.clamp)
    centres = [simulation.data.body(plate).xpos - clamp.xpos for plate in finger.plates]
    found = np.array(centres) @ clamp.xmat.reshape(3, 3)
    return np.abs(found - rod.place(tensions).centres).max() < 1e-6


def test_two_grippers_stand_in_one_model_by_their_names(rod):
    spec = hand()
    fingers = [*attach_gripper(spec, rod, "palm", name="left")]
    fingers += attach_gripper(spec, rod, "other palm", name="right")
    assert [one.name for one in fingers] == [f"{side} {k}" for side in ("left", "right") for k in range(3)]
    simulation = Simulation(spec.compile(), fingers)
    tensions = np.random.default_rng(0).uniform(0.0, 20.0, (6, 2))
    for k, one in enumerate(tensions):
        simulation.pull(k, one)
    simulation.advance(0.5)
    assert all(rests(simulation, *each) for each in zip(fingers, [rod] * 6, tensions, strict=True))


@pytest.mark.parametrize(
    ("name", "taken"), [("finger", "finger clamp"), ("back", "back plate 0"), ("back", "back plate 0 turn")]
)
def test_a_name_that_the_model_has_already_is_refused(rod, name, taken):
    spec = hand()
    if name == "finger":
        attach(spec, rod, "palm")
    elif taken.endswith("turn"):
        spec.body("palm").add_joint(name=taken)
    else:
        spec.body("palm").add_body(name=taken)
    bodies = len(spec.bodies)
    with pytest.raises(ValueError, match=f"must be free in the model, got '{name}' where '{taken}' exists"):
        attach(spec, rod, "other palm", name=name)
    assert len(spec.bodies) == bodies


def test_hands_with_prefix_and_suffix_stand_on_an_arm(rod):
    both, arm, fingers = in_series(rod, 2), mujoco.MjSpec.from_string(ARM), []
    for affix, site in (({"prefix": "left/"}, "flange"), ({"prefix": "right/", "suffix": " too"}, "other flange")):
        own = hand()
        fingers += [one.renamed(**affix) for one in attach_gripper(own, both, "palm", fingers=2)]
        arm.attach(own, site=arm.site(site), **affix)
    simulation = Simulation(arm.compile(), fingers)
    tensions = np.random.default_rng(1).uniform(0.0, 15.0, (4, 2))
    for k, one in enumerate(tensions):
        simulation.pull(k, one)
    simulation.advance(1.0)
    assert all(rests(simulation, finger, both, one) for finger, one in zip(fingers, tensions, strict=True))
    assert [one.name for one in fingers][::2] == ["left/finger 0", "right/finger 0 too"]


def test_a_hand_whose_names_have_changed_is_refused_with_the_call_that_renames_it(rod):
    own, arm = hand(), mujoco.MjSpec.from_string(ARM)
    fingers = attach_gripper(own, rod, "palm")
    arm.attach(own, prefix="left/", site=arm.site("flange"))
    model = arm.compile()
    with pytest.raises(ValueError, match=r"'finger 0 clamp'.*use Attached\.renamed\(prefix='left/', suffix=''\)"):
        Simulation(model, fingers)
    fingers = [one.renamed(prefix="left/") for one in fingers]
    with pytest.raises(ValueError, match="must differ in their names, got left/finger 0, left/finger 0"):
        Simulation(model, [fingers[0], fingers[0]])
    Simulation(model, fingers)


@pytest.mark.filterwarnings("ignore:compiler attribute")
@pytest.mark.parametrize(
    ("compiler", "wrong"),
    [
        ('settotalmass="2"', "mass of 'finger clamp' must be"),
        ('boundmass="0.01"', "mass of 'finger clamp' must be"),
    ],
)
def test_a_compiler_that_changes_the_finger_is_refused(rod, compiler, wrong):
    spec = hand(compiler)
    finger = attach(spec, rod, "palm")
    with pytest.raises(ValueError, match=f"{wrong}.*compile it without settotalmass"):
        Simulation(spec.compile(), [finger])


def test_a_tapered_finger_rests_where_its_elements_have_it(rod):
    geometry = rod.scene["geometry"] | {"taper": [0.8]}
    tendons = [tendon | {"tension": [0.0, 60.0]} for tendon in rod.scene["tendons"]]
    tapered = rod.assembled(rod.scene | {"geometry": geometry, "tendons": tendons})
    spec = hand()
    finger = attach(spec, tapered, "palm")
    simulation = Simulation(spec.compile(), [finger])
    simulation.pull(0, [20.0, 5.0])
    simulation.advance(0.5)
    assert rests(simulation, finger, tapered, [20.0, 5.0])


def test_a_round_finger_has_geoms_with_its_own_outline():
    rod = TouchedSegment.load("round").rod
    spec = hand()
    finger = attach(spec, rod, "palm")
    model = spec.compile()
    (geom,) = np.flatnonzero(model.geom_bodyid == model.body(finger.sections[0]).id)
    first = model.mesh_vertadr[model.geom_dataid[geom]]
    vertices = model.mesh_vert[first : first + model.mesh_vertnum[model.geom_dataid[geom]]]
    rotation = np.zeros(9)
    mujoco.mju_quat2Mat(rotation, model.geom_quat[geom])
    across = (vertices @ rotation.reshape(3, 3).T)[:, 1:]
    assert np.linalg.norm(across, axis=1) == pytest.approx(rod.half_lengths[1], rel=1e-3)
