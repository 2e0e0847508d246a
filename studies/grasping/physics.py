"""What the simulation must get right: Coulomb's law, the friction angle, work in closed loops, steps; and its time."""

from __future__ import annotations

import time
from typing import Any

import mujoco
import numpy as np
from scipy.spatial.transform import Rotation

from control.mujoco import Simulation, attach
from rom import Rod, TouchedSegment, friction_history
from rom.rod.inverse_map import InverseMap
from studies.grasping.task import LIFT, PERIOD, STEP, attempt, prepare, trial
from studies.runner import Run

DISTANCE = 0.013  # d of the wall [m]
PULLED = np.concatenate(
    [np.linspace(24, 34, 41), np.linspace(34, 30, 17)[1:], np.linspace(30, 36, 25)[1:], np.linspace(36, 33, 13)[1:]]
)  # lead tension of a history that turns round three times [N]
SLOWLY = 20.0  # [N/s]
FRICTION = (0.3, 0.6, 1.0)
LOADED = 0.1  # [N], with which contacts are looked at
DRAWN, DRAG = 0.004, 0.002  # how far the wall is drawn along [m], and how fast [m/s]
GRASPS = {"sphere": 16, "cylinder": 12, "cone": 13}  # trials that are repeated with half the step
WALL = """
<mujoco>
  <option timestep="{step}" gravity="0 0 0"/>
  <worldbody>
    <body name="palm"/>
    <body name="wall" pos="0.05 {at} 0">
      <joint name="y" type="slide" axis="0 1 0" stiffness="{stiffness}" damping="{damping}"/>
      <joint name="z" type="slide" axis="0 0 1" stiffness="{along}" damping="{damping}"/>
      <geom type="box" size="0.05 0.005 0.05" mass="{mass}" friction="{friction} 0.001 0.0001" condim="4"/>
    </body>
  </worldbody>
  <actuator><position name="drag" joint="z" kp="{drag}"/></actuator>
</mujoco>
"""
STIFF, SOFT = 1e6, 500.0  # springs that hold the wall [N/m]
RINGS = 100.0  # rad/s, at which the wall would ring: slow for a step
DAMPED = {STIFF: 1.0, SOFT: 0.02}  # of critical damping [-]: what it takes is lost to a loop's work


def before_a_wall(
    rod: Rod, friction: float, stiffness: float = STIFF, dragged: bool = False, coulomb: bool = True
) -> Simulation:
    """A finger before a wall on springs along y and z [N/m], or drawn along z instead."""
    mass = stiffness / RINGS**2
    text = WALL.format(
        step=STEP,
        at=0.005 + DISTANCE + 0.005,
        friction=friction,
        stiffness=stiffness,
        along=0.0 if dragged else stiffness,
        drag=stiffness if dragged else 0.0,
        damping=2 * DAMPED[stiffness] * RINGS * mass,
        mass=mass,
    )
    spec = mujoco.MjSpec.from_string(text)
    finger = attach(spec, rod, "palm")
    return Simulation(spec.compile(), [finger], coulomb=coulomb)


def coulomb(model: TouchedSegment, friction: float) -> dict[str, Any]:
    """Contact force along a history of tensions: MuJoCo's law and the corrected one beside the quasi-static one."""
    points = [[tension, 0.0, DISTANCE] for tension in PULLED]
    expected = np.array([one.contact_force for one in friction_history(model, points, friction, increments=2)])
    row: dict[str, Any] = {"friction": friction, "tension": PULLED.tolist(), "history": expected.tolist()}
    for name, follows in (("corrected", True), ("mujoco", False)):
        simulation, found = before_a_wall(model.rod, friction, coulomb=follows), []
        simulation.pull(0, (PULLED[0], 0.0))
        simulation.advance(1.0)
        simulation.rate = SLOWLY
        for tension in PULLED:
            simulation.pull(0, (tension, 0.0))
            simulation.advance(simulation.time + 0.25 / SLOWLY)
            found.append(float(simulation.contact_forces()[0]))
        off = np.abs(np.array(found) - expected) / expected.max()
        row |= {name: found, f"{name}_mean": float(off.mean()), f"{name}_max": float(off.max())}
    return row


def sliding(rod: Rod, friction: float) -> dict[str, Any]:
    """A wall drawn along under a finger: the angle at which it slides, and how fast it creeps below that.

    Creeping is what sticks moving at all, sliding what moves faster than a tenth of the wall.
    """
    simulation = before_a_wall(rod, friction, dragged=True)
    for tension in (36.0, 35.0):  # let go a little it sticks, with friction to spare
        simulation.pull(0, (tension, 0.0))
        simulation.advance(simulation.time + 1.0)
    data = simulation.data
    angles, slips = [], []
    for k in range(round(DRAWN / DRAG / STEP)):
        data.ctrl[0] = DRAG * STEP * (k + 1)
        simulation.step()
        for row in data.contact.efc_address:
            force, slip = data.efc_force[row : row + 3], data.efc_vel[row + 1 : row + 3]
            if force[0] > LOADED:
                angles.append(float(np.degrees(np.arctan2(np.linalg.norm(force[1:]), force[0]))))
                slips.append(float(np.linalg.norm(slip)))
    known, fast = np.array(angles), np.array(slips)
    slides = fast > 0.1 * DRAG
    limit = float(np.degrees(np.arctan(friction)))
    return {
        "friction": friction,
        "angle": limit,
        "sliding_least": float(known[slides].min()),
        "sliding_p5": float(np.percentile(known[slides], 5)),
        "sliding_median": float(np.median(known[slides])),
        "largest": float(known.max()),
        "creep": float(np.median(fast[known < 0.95 * limit])),
        "creep_most": float(fast[known < 0.95 * limit].max()),
    }


def tension_loop(rod: Rod, rounds: int = 2, seconds: float = 20.0) -> dict[str, float]:
    """Tensions led around a closed loop before a wall on springs without friction: net work done on the wall."""
    simulation = before_a_wall(rod, 0.0, SOFT)
    data, wall = simulation.data, simulation.data.body("wall")
    simulation.pull(0, (48.0, 10.0))
    simulation.advance(1.0)
    work = exchanged = 0.0
    before, force = wall.xpos.copy(), np.zeros(6)
    steps = round(seconds / STEP)
    for k in range(rounds * steps):
        angle = 2 * np.pi * k / steps
        simulation.pull(0, (40.0 + 8.0 * np.cos(angle), 10.0 + 8.0 * np.sin(angle)))
        simulation.step()
        pushed = np.zeros(3)
        for i in range(data.ncon):
            mujoco.mj_contactForce(simulation.model, data, i, force)
            sign = 1.0 if simulation.model.geom_bodyid[data.contact.geom[i][1]] == wall.id else -1.0
            pushed += sign * force[0] * data.contact.frame[i][:3]
        done, before = float(pushed @ (wall.xpos - before)), wall.xpos.copy()
        if k >= (rounds - 1) * steps:
            work, exchanged = work + done, exchanged + abs(done)
    return {"work": work, "exchanged": exchanged, "share": abs(work) / exchanged}


def pose_loop(rod: Rod, points: int = 2000) -> dict[str, float]:
    """A plate led around a closed loop of poses at tensions that stay: net work done by rubber and tendons."""
    segment = rod.segments[0]
    inverse, work, exchanged, before = InverseMap(segment), 0.0, 0.0, None
    for angle in np.linspace(0, 2 * np.pi, points + 1):
        pressed = [0.3 * np.sin(angle), -1 - np.cos(angle), 0.7 * np.sin(2 * angle), 0.0, 0.002, 0.0]
        centre, turned, _, _ = segment.place([30.0, 10.0, *pressed])
        rotation = Rotation.from_matrix(turned)
        inverse.find([30.0, 10.0], centre, rotation.as_quat()[[3, 0, 1, 2]])
        if before is not None:
            turn = (before[1].inv() * rotation).as_rotvec()
            moved = np.concatenate([before[1].inv().apply(centre - before[0]), turn])
            done = float((before[2] + inverse.wrench) / 2 @ moved)
            work, exchanged = work + done, exchanged + abs(done)
        before = centre, rotation, inverse.wrench.copy()
    return {"work": work, "exchanged": exchanged, "share": abs(work) / exchanged}


def half_step(model: TouchedSegment, shape: str) -> dict[str, Any]:
    """A grasp, and its tensions and the mount's way again with the same step and with half of it.

    Returns:
        contact forces while it is in the air [N], their largest change by half the step [-], and how much faster than
        real time the task was with its controllers, and the simulation alone [-].
    """
    wanted: list[np.ndarray] = []
    mount: list[np.ndarray] = []

    def keep(simulation: Simulation) -> None:
        wanted.append(simulation.wanted.copy())
        mount.append(simulation.data.ctrl.copy())

    one = trial(GRASPS[shape], shape)
    begun = time.perf_counter()
    row = attempt(model, one, [keep])
    taken = time.perf_counter() - begun
    forces, alone = [], []
    for step in (STEP, STEP / 2):
        simulation, begun, felt = prepare(model, one, step).simulation, time.perf_counter(), []
        for tensions, controls in zip(wanted, mount, strict=True):
            simulation.wanted[:], simulation.data.ctrl[:] = tensions, controls
            simulation.advance(simulation.time + PERIOD)
            felt.append(simulation.contact_forces())
        alone.append(len(felt) * PERIOD / (time.perf_counter() - begun))
        up = np.array(mount)[:, 2] > 0.9 * LIFT
        forces.append(np.mean(np.array(felt)[up], axis=0))
    return {
        "shape": shape,
        "trial": one.number,
        "fate": row["fate"],
        "forces": forces[0].tolist(),
        "change": float(np.abs(forces[1] / forces[0] - 1).max()),
        "real_time": len(wanted) * PERIOD / taken,
        "real_time_alone": alone[0],
    }


def measure(run: Run) -> dict:
    """All of them."""
    model = TouchedSegment.load()
    frictions = FRICTION[:1] if run.quick else FRICTION
    return {
        "coulomb": [run.once(f"coulomb {friction}", coulomb, model, friction) for friction in frictions],
        "sliding": [run.once(f"sliding {friction}", sliding, model.rod, friction) for friction in frictions],
        "loops": {"poses": pose_loop(model.rod), "tensions": tension_loop(model.rod)},
        "grasps": [half_step(model, shape) for shape in (list(GRASPS)[:1] if run.quick else GRASPS)],
    }
