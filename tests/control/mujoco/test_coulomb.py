"""Coulomb's law for contacts: a body that only translates on a floor, against its closed form."""

import numpy as np
import pytest

mujoco = pytest.importorskip("mujoco")

from control.mujoco.contact.coulomb import CLOSE  # noqa: E402
from control.mujoco.contact.coulomb import solve as solve_own  # noqa: E402
from control.mujoco.contact.engine import Engine  # noqa: E402

MASS, GRAVITY = 0.2, 9.81
SLED = """
<mujoco>
  <option timestep="0.001" gravity="0 0 -{gravity}" cone="elliptic" impratio="100"/>
  <worldbody>
    <geom type="plane" size="1 1 0.1" friction="0 0 0"/>
    <body pos="0 0 0.01">
      <joint type="slide" axis="1 0 0"/><joint type="slide" axis="0 1 0"/><joint type="slide" axis="0 0 1"/>
      <geom type="sphere" size="0.01" mass="{mass}" condim="{condim}" friction="{friction} 0 0" priority="1"
            solref="0.004 1" solimp="0.999 0.9999 1e-5 0.5 2"/>
    </body>
  </worldbody>
</mujoco>
"""


def solve(model, data, own: bool = True) -> bool:
    """`coulomb.solve` with contacts of all geoms, or none."""
    engine = Engine(model, data)
    engine.set_contacts()
    engine.set_constraints()
    return solve_own(engine, np.full(model.ngeom, own))


def begun(friction: float, speed=(0.0, 0.0), pull: float = 0.0, condim: int = 3):
    """A sled that rests on a floor, pushed 1 um into it, at a speed and pulled along x; before its step ends."""
    text = SLED.format(gravity=GRAVITY, mass=MASS, friction=friction, condim=condim)
    model = mujoco.MjModel.from_xml_string(text)
    data = mujoco.MjData(model)
    data.qpos[2], data.qvel[:2], data.qfrc_applied[0] = -1e-6, speed, pull
    mujoco.mj_step1(model, data)
    mujoco.mj_fwdActuation(model, data)
    mujoco.mj_fwdAcceleration(model, data)
    return model, data


def solved(friction: float, speed=(0.0, 0.0), pull: float = 0.0, corrected: bool = True, condim: int = 3):
    """Normal and tangential forces, the body's acceleration, and whether it settled."""
    model, data = begun(friction, speed, pull, condim)
    settled = solve(model, data) if corrected else mujoco.mj_fwdConstraint(model, data)
    force = np.zeros(6)
    mujoco.mj_contactForce(model, data, 0, force)
    assert data.ncon == 1
    return float(force[0]), data.qfrc_constraint[:2].copy(), data.qacc.copy(), settled


@pytest.mark.parametrize("friction", [0.2, 0.7, 1.2])
@pytest.mark.parametrize("speed", [(0.1, 0.0), (-0.06, 0.08)])
def test_what_slides_is_pressed_as_without_friction_and_braked_by_the_friction_s_share(friction, speed):
    alone = solved(0.0, speed, condim=1)[0]
    normal, along, _, settled = solved(friction, speed)
    relaxed = solved(friction, speed, corrected=False)[0]
    assert settled and normal == pytest.approx(alone, rel=2 * CLOSE)  # more at larger speeds
    assert along == pytest.approx(-friction * normal * np.array(speed) / np.linalg.norm(speed), rel=1e-3, abs=1e-6)
    assert relaxed > 1.4 * alone  # MuJoCo's own relaxation lifts it off


def test_what_sticks_is_left_as_it_is():
    friction, pull = 0.8, 0.5 * 0.8 * MASS * GRAVITY
    normal, along, acceleration, settled = solved(friction, pull=pull)
    own = solved(friction, pull=pull, corrected=False)
    assert settled and normal == pytest.approx(own[0], rel=1e-3) and along == pytest.approx(own[1], rel=1e-3)
    assert abs(acceleration[0]) < 0.02 * pull / MASS


@pytest.mark.parametrize("friction", [0.3, 0.6])
def test_a_pull_beyond_the_cone_accelerates_by_what_the_friction_leaves(friction):
    normal, along, acceleration, _ = solved(friction, pull=1.5)
    assert along[0] == pytest.approx(-friction * normal, rel=1e-3)
    assert MASS * acceleration[0] == pytest.approx(1.5 - friction * normal, rel=1e-3) and acceleration[0] > 0


def test_contacts_that_are_not_named_or_have_no_friction_are_not_changed():
    for condim, own in ((3, False), (1, True)):
        model, data = begun(0.7, (0.3, 0.0), condim=condim)
        before = data.efc_aref.copy()
        assert solve(model, data, own)
        assert np.array_equal(data.efc_aref, before) and len(before) == condim
    model, data = begun(0.7, (0.3, 0.0))
    before = data.efc_aref.copy()
    assert solve(model, data) and data.efc_aref[0] < before[0]
    assert np.array_equal(data.efc_aref[1:], before[1:])


def test_relaxation_needs_few_solves_of_a_step(monkeypatch):
    own, solves = mujoco.mj_fwdConstraint, []
    monkeypatch.setattr(mujoco, "mj_fwdConstraint", lambda *given: solves.append(given) or own(*given))
    for friction in (0.2, 0.7, 1.2):
        solves.clear()
        model, data = begun(friction, (0.1, 0.0))
        assert solve(model, data) and len(solves) <= 3
    solves.clear()
    model, data = begun(0.8, pull=0.5 * 0.8 * MASS * GRAVITY)  # sticks
    assert solve(model, data) and len(solves) == 1
