"""Real-time factors of simulations in which two, three or four fingers hold a box, on one core."""

from __future__ import annotations

import time
from dataclasses import replace

import numpy as np

from control import GraspOptions, Gripper, Limits
from control.mujoco import Simulation, plants
from control.mujoco.layouts import FINGERS
from control.mujoco.solids import random_solid
from control.mujoco.table import STEP, table
from rom import TouchedSegment
from studies.grasping.task import MOTOR
from studies.grasping.trials import PERIOD
from studies.parts import Run

SHAPE, MASS, FORCE = "cylinder", 0.05, 1.0  # [kg], [N]
BLOCKS, BLOCK = 20, 25  # of steps that are timed by turns


def holding(model: TouchedSegment, fingers: int) -> Simulation:
    """A simulation in which fingers hold a solid."""
    solid = replace(random_solid(np.random.default_rng(0), SHAPE), mass=MASS, friction=0.6, admissible_force=10.0)
    gripper = Gripper(model, fingers, limits=Limits(rate=MOTOR))
    simulation = table(gripper, model.rod, solid, np.zeros(3), step=STEP)
    grasp = gripper.grasp(FORCE, plants(simulation, PERIOD), GraspOptions(period=PERIOD, tolerance=0.02))
    if not grasp.converged:
        raise RuntimeError(f"{fingers} fingers must hold the {SHAPE} before steps are timed, got {grasp.status}")
    return simulation


def measure(run: Run) -> dict[str, float]:
    """Simulated time over that of the processor, by number of fingers [-]."""
    model = TouchedSegment.load()
    simulations = {str(fingers): holding(model, fingers) for fingers in FINGERS}
    taken = {fingers: list[float]() for fingers in simulations}
    for _ in range(BLOCKS):
        for fingers, simulation in simulations.items():
            begun = time.process_time()
            for _ in range(BLOCK):
                simulation.step()
            taken[fingers].append(time.process_time() - begun)
    return {fingers: BLOCK * STEP / float(np.median(one)) for fingers, one in taken.items()}
