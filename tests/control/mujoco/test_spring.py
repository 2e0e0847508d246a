"""The rubber of a segment as a spring in MuJoCo: its places there, its force, and what it does beyond its map."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

mujoco = pytest.importorskip("mujoco")

from control.mujoco import Simulation, attach  # noqa: E402
from control.mujoco.spring import LOWER  # noqa: E402
from rom import TouchedSegment  # noqa: E402

EMPTY = '<mujoco><option timestep="0.001" gravity="0 0 0"/><worldbody><body name="palm"/></worldbody></mujoco>'
TENSIONS = np.array([25.0, 10.0])


@pytest.fixture(scope="module")
def rod():
    return TouchedSegment.load().rod


@pytest.fixture
def simulation(rod):
    spec = mujoco.MjSpec.from_string(EMPTY)
    finger = attach(spec, rod, "palm")
    return Simulation(spec.compile(), [finger])


def put(simulation, moved, rotation: Rotation):
    """The plate somewhere from where it rests."""
    (spring,) = simulation.springs
    simulation.data.qpos[spring.position : spring.position + 3] = moved
    simulation.data.qpos[spring.position + 3 : spring.position + 7] = rotation.as_quat(scalar_first=True)
    return spring


def test_where_the_rod_has_the_free_plate_the_spring_is_at_rest(simulation, rod):
    placed = rod.place(TENSIONS)
    free = placed.centres[0] - rod.rest, Rotation.from_matrix(placed.rotations[0])
    force, stiffness = put(simulation, *free).pull(simulation.data, TENSIONS)
    for h, axis in ((1e-6, 0), (1e-6, 1), (1e-6, 2)):
        spring = put(simulation, free[0] + h * np.eye(3)[axis], free[1])
        moved, _ = spring.pull(simulation.data, TENSIONS)
        assert moved - force == pytest.approx(h * stiffness[:, axis], abs=2e-2 * h * np.abs(stiffness[:, axis]).max())
    assert np.abs(force).max() < 1e-5 and np.linalg.eigvalsh(stiffness).min() > 0


def test_beyond_its_map_the_force_goes_on_linearly_from_the_last_pose(simulation):
    spring = put(simulation, np.zeros(3), Rotation.identity())
    force, stiffness = (one.copy() for one in spring.pull(simulation.data, TENSIONS))
    away, turn = np.array([0.4, -0.3, 0.2]), np.array([0.2, 2.0, -1.1])
    put(simulation, away, Rotation.from_rotvec(turn))
    far, same = spring.pull(simulation.data, TENSIONS)
    assert not spring.inverse.converged and np.array_equal(same, stiffness)
    assert far == pytest.approx(force + stiffness @ np.concatenate([away, turn]), rel=1e-6)
    assert spring.away(simulation.data) == pytest.approx(np.linalg.norm(away), rel=1e-9)
    back, _ = put(simulation, np.zeros(3), Rotation.identity()).pull(simulation.data, TENSIONS)
    assert spring.inverse.converged and back == pytest.approx(force, abs=1e-6)


def test_its_places_in_the_inertia_are_those_of_the_plate_s_block(simulation):
    model, data = simulation.model, simulation.data
    (spring,) = simulation.springs
    data.M[spring.inertia] += np.arange(1.0, 22.0)
    full, own = np.zeros((model.nv, model.nv)), np.zeros((6, 6))
    before = np.zeros_like(full)
    mujoco.mju_sym2dense(full, data.M, model.M_rownnz, model.M_rowadr, model.M_colind)
    data.M[spring.inertia] -= np.arange(1.0, 22.0)
    mujoco.mju_sym2dense(before, data.M, model.M_rownnz, model.M_rowadr, model.M_colind)
    own[LOWER] = np.arange(1.0, 22.0)
    rows = slice(spring.velocity, spring.velocity + 6)
    assert (full - before)[rows, rows] == pytest.approx(own + np.tril(own, -1).T)


def test_contacts_feel_the_plate_with_the_rubber_of_a_step(simulation):
    """What a plate weighs at rest: M + h (relaxation + h) K, far more than itself."""
    model, data, (spring,) = simulation.model, simulation.data, simulation.springs
    weighed = model.body_invweight0[spring.body].copy()
    mujoco.mj_resetData(model, data)
    mujoco.mj_forward(model, data)
    full, h = np.zeros((model.nv, model.nv)), model.opt.timestep
    mujoco.mju_sym2dense(full, data.M, model.M_rownnz, model.M_rowadr, model.M_colind)
    plate = full[spring.velocity :, spring.velocity :]
    spring.reset(data)
    _, stiffness = spring.pull(data, np.zeros(2))
    inverse = np.linalg.inv(plate + h * (spring.relaxation + h) * stiffness)
    expected = np.trace(inverse[:3, :3]) / 3, np.trace(inverse[3:, 3:]) / 3
    assert weighed == pytest.approx(expected, rel=1e-6)
    assert weighed[0] < np.trace(np.linalg.inv(plate)[:3, :3]) / 3


def test_a_reset_begins_without_a_wrench_at_the_current_position(simulation):
    spring = put(simulation, [1e-4, 2e-4, 0.0], Rotation.from_rotvec([0.0, 0.0, 0.01]))
    spring.pull(simulation.data, TENSIONS)
    assert spring.inverse.wrench.any() and spring.held.wrench.any()
    put(simulation, [3e-4, 0.0, 0.0], Rotation.identity())
    spring.reset(simulation.data)
    assert not spring.inverse.wrench.any() and not spring.held.wrench.any() and spring.away(simulation.data) == 0.0
    assert spring.held.position == pytest.approx([3e-4, 0, 0, 1, 0, 0, 0])
