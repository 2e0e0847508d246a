"""Friction about the forces of the step before: a loaded contact yields by a fixed distance, and then stays."""

import numpy as np
import pytest

mujoco = pytest.importorskip("mujoco")

from control.mujoco.contact.coulomb import solve  # noqa: E402
from control.mujoco.contact.engine import Engine  # noqa: E402
from control.mujoco.contact.sticking import Sticking  # noqa: E402

MASS, GRAVITY, FRICTION, RADIUS = 0.2, 9.81, (0.6, 0.002, 0.001), 0.01
STEP, TIME, IMPEDANCE = 0.001, 0.004, 0.9999  # [s], of the contact [s, -]
DISC = f"""
<mujoco>
  <option timestep="{STEP}" gravity="0 0 -{GRAVITY}" cone="elliptic" impratio="100"/>
  <worldbody>
    <geom type="plane" size="1 1 0.1" friction="0 0 0"/>
    <body pos="0 0 {RADIUS}">
      <freejoint/>
      <geom type="sphere" size="{RADIUS}" mass="{MASS}" condim="6" friction="{{}} {{}} {{}}" priority="1"
            solref="{TIME} 1" solimp="{IMPEDANCE} {IMPEDANCE} 1e-5 0.5 2"/>
    </body>
  </worldbody>
</mujoco>
""".format(*FRICTION)
WEIGHT = MASS * GRAVITY
# Half of what each kind of friction holds: load at the centre, its axis of motion, and its row among the constraints.
LOADS = {
    "force": (0.5 * FRICTION[0] * WEIGHT * np.array([1, 0, 0, 0, -RADIUS, 0]), 0, 2),
    "torsion": (0.5 * FRICTION[1] * WEIGHT * np.array([0, 0, 0, 0, 0, 1]), 5, 3),
    "rolling": (0.5 * FRICTION[2] * WEIGHT * np.array([0, 0, 0, 1, 0, 0]), 3, 5),
}


def loaded(load: np.ndarray, seconds: float, sticks: bool = True):
    """A ball at rest on a plane under a force and a moment, shape (6,) [N, N m], and how far it moved then."""
    model = mujoco.MjModel.from_xml_string(DISC)
    data = mujoco.MjData(model)
    engine, own, moved = Engine(model, data), np.ones(model.ngeom, bool), np.zeros(6)
    sticking = Sticking(engine, own)
    for k in range(round((0.2 + seconds) / STEP)):
        data.qfrc_applied[:] = load * (k * STEP >= 0.2)  # at rest first
        mujoco.mj_step1(model, data)
        engine.set_contacts()
        engine.set_constraints()
        if sticks:
            sticking.recall(data.ncon)
        mujoco.mj_fwdActuation(model, data)
        mujoco.mj_fwdAcceleration(model, data)
        solve(engine, own)
        sticking.note()
        mujoco.mj_Euler(model, data)
        moved += STEP * data.qvel * (k * STEP >= 0.2)
    return engine, moved


@pytest.mark.parametrize("kind", LOADS)
def test_what_sticks_yields_by_a_fixed_distance_instead_of_creeping(kind):
    load, axis, row = LOADS[kind]
    (engine, moved), creeping = loaded(load, 0.5), loaded(load, 0.5, sticks=False)[0].data
    data = engine.data
    slips = abs(data.efc_R[row] * data.efc_force[row]) * IMPEDANCE * TIME / 2  # by MuJoCo's regularisation [m/s, rad/s]
    assert abs(moved[axis]) == pytest.approx(slips * STEP, rel=1e-3)
    assert abs(data.qvel[axis]) < 1e-6 * slips
    assert abs(creeping.qvel[axis]) == pytest.approx(slips, rel=1e-3)


def test_a_contact_is_forgotten_when_it_opens_or_is_reset():
    engine, _ = loaded(LOADS["force"][0], 0.01)
    data, sticking = engine.data, Sticking(engine, np.ones(engine.model.ngeom, bool))
    sticking.recall(data.ncon)
    sticking.note()
    before = data.efc_aref.copy()
    for contacts in (0, data.ncon):  # open for a step
        sticking.recall(contacts)
        sticking.note()
    assert np.array_equal(data.efc_aref, before) and len(before)
    sticking.recall(data.ncon)
    assert not np.array_equal(data.efc_aref, before)
    before = data.efc_aref.copy()
    sticking.reset()
    sticking.recall(data.ncon)
    assert np.array_equal(data.efc_aref, before)
