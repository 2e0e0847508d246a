"""Elements as springs in MuJoCo: forces and stiffness, poses beyond their laws, and what contacts feel of them."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

mujoco = pytest.importorskip("mujoco")

from control.mujoco import Simulation, attach  # noqa: E402

EMPTY = '<mujoco><option timestep="0.001" gravity="0 0 0"/><worldbody><body name="palm"/></worldbody></mujoco>'
TENSIONS = np.array([25.0, 10.0])
STEP = 1e-3  # [s]


@pytest.fixture
def simulation(rod):
    """A finger at rest under TENSIONS."""
    spec = mujoco.MjSpec.from_string(EMPTY)
    finger = attach(spec, rod, "palm", relaxation=0.0)
    simulation = Simulation(spec.compile(), [finger])
    simulation.pull(0, TENSIONS)
    simulation.advance(1.0)
    return simulation


def pulled(simulation):
    """Forces along all joints, shape (nv,), and stiffness, shape (nv, nv), at the current coordinates."""
    model, data, (rubber,) = simulation.model, simulation.data, simulation.rubber
    data.qvel[:] = 0.0
    mujoco.mj_step1(model, data)
    before, after = np.zeros((2, model.nv, model.nv))
    mujoco.mju_sym2dense(before, data.M, model.M_rownnz, model.M_rowadr, model.M_colind)
    rubber.pull(TENSIONS, STEP)
    mujoco.mju_sym2dense(after, data.M, model.M_rownnz, model.M_rowadr, model.M_colind)
    return -data.qfrc_applied.copy(), (after - before) / STEP**2


def test_forces_change_as_the_stiffness_says_section_by_section(simulation):
    rest, stiffness = pulled(simulation)
    begun, model = simulation.data.qpos.copy(), simulation.model
    assert np.abs(rest).max() < 1e-6 and np.linalg.eigvalsh(stiffness).min() > 0
    for k in range(model.nv):
        size = 1e-7 if k % 6 < 3 else 1e-5
        moved = _moved(simulation, begun, k, size)
        expected = size * stiffness[:, k]
        assert moved - rest == pytest.approx(expected, abs=5e-2 * np.abs(expected).max())
        own = slice(6 * (k // 6), 6 * (k // 6) + 6)
        assert not np.delete(stiffness[:, k], np.arange(own.start, own.stop)).any()


def _moved(simulation, begun, k, size):
    """Forces where one velocity has moved the sections."""
    moving = np.zeros(simulation.model.nv)
    moving[k] = size
    simulation.data.qpos[:] = begun
    mujoco.mj_integratePos(simulation.model, simulation.data.qpos, moving, 1.0)
    return pulled(simulation)[0]


def test_beyond_its_law_the_force_of_an_element_goes_on_linearly_from_the_last_pose(simulation):
    force, stiffness = pulled(simulation)
    data, begun = simulation.data, simulation.data.qpos.copy()
    away, turn = np.array([0.4, -0.3, 0.2]), np.array([0.2, 2.0, -1.1])
    data.qpos[:3] += away
    there = Rotation.from_quat(begun[3:7], scalar_first=True) * Rotation.from_rotvec(turn)
    data.qpos[3:7] = there.as_quat(scalar_first=True)
    far, same = pulled(simulation)
    (rubber,) = simulation.rubber
    assert not rubber.inside[0, 1] and rubber.inside[1:].all() and same == pytest.approx(stiffness, rel=1e-9)
    assert far[:6] == pytest.approx((force + stiffness[:, :6] @ np.concatenate([away, turn]))[:6], rel=1e-6)
    assert rubber.away == pytest.approx(np.linalg.norm(away), rel=1e-9)
    data.qpos[:] = begun
    back, _ = pulled(simulation)
    assert rubber.inside.all() and back == pytest.approx(force, abs=1e-6)


def test_contacts_feel_sections_with_the_rubber_of_a_step(simulation):
    """Inverse inertia at rest with M + h (relaxation + h) K, far less than with the masses alone."""
    model, data = simulation.model, simulation.data
    mujoco.mj_resetData(model, data)
    simulation.rubber[0].reset()
    mujoco.mj_step1(model, data)
    mass, both = np.zeros((2, model.nv, model.nv))
    mujoco.mju_sym2dense(mass, data.M, model.M_rownnz, model.M_rowadr, model.M_colind)
    simulation.rubber[0].pull(np.zeros(2), STEP)
    mujoco.mju_sym2dense(both, data.M, model.M_rownnz, model.M_rowadr, model.M_colind)
    for name in simulation.fingers[0].sections:
        body, jacobian = model.body(name).id, np.zeros((6, model.nv))
        mujoco.mj_jacBodyCom(model, data, jacobian[:3], jacobian[3:], body)
        expected = np.diag(jacobian @ np.linalg.inv(both) @ jacobian.T)
        assert model.body_invweight0[body] == pytest.approx([expected[:3].mean(), expected[3:].mean()], rel=1e-6)
        alone = np.diag(jacobian @ np.linalg.inv(mass) @ jacobian.T)
        assert model.body_invweight0[body, 0] < alone[:3].mean() / 3


def test_a_reset_begins_without_wrenches_at_the_current_position(simulation):
    (rubber,) = simulation.rubber
    simulation.data.qpos[0] += 1e-5
    pulled(simulation)
    assert rubber.wrenches.any()
    simulation.data.qpos[0] += 3e-4
    rubber.reset()
    assert not rubber.wrenches.any() and rubber.away == 0.0
