"""Random balls and cylinders in MuJoCo, pressed by a finger at rest: their forces and those of the rod.

A moment is a finger at rest at random tensions. Objects are like those of docs/grasping.md in size and position: before
the plate, cylinders parallel to the finger, or before the rubber, cylinders across it.
"""

from __future__ import annotations

from typing import Any

import mujoco
import numpy as np

from control.mujoco import Simulation, attach
from rom import TouchedSegment
from studies.cores import on_cores
from studies.parts import Run
from studies.rods.full_order import Table, rigid

PLACES, SHAPES, COUNT = ("plate", "rubber"), ("sphere", "cylinder"), 6  # and moments of each place and shape
RADII = {"sphere": (0.012, 0.018), "cylinder": (0.009, 0.016)}  # [m]
FORCES, SIDEWAYS = (0.25, 4.0), (0.0, 8.0)  # of a moment, and tension of the second tendon [N]
OFF = 0.004  # largest distance of an object from its place [m]
ALONG, CLEAR = (0.020, 0.036), (0.003, 0.007)  # of objects before the rubber: position, and distance at rest [m]
MOST, HALVINGS, CLOSE = 90.0, 14, 0.05  # tension [N]; error of the force that is asked for [-]
RATE, SETTLES = 100.0, 0.6  # [N/s], [s]
SCENE = """
<mujoco><option timestep="0.001" gravity="0 0 0"/><worldbody><body name="palm"/>
<geom type="{shape}" size="{size}" pos="{centre}" zaxis="{axis}" friction="0 0 0"/>
</worldbody></mujoco>
"""


def drawn(random: np.random.Generator, place: str, shape: str) -> Table:
    """An obstacle of a scene, at d = 0."""
    radius, off = float(random.uniform(*RADII[shape])), random.standard_normal(3)
    off *= OFF * random.random() ** (1 / 3) / np.linalg.norm(off)
    centre = np.array([0.0455, 0.030, 0.0]) + off
    if place == "rubber":
        centre = np.array([random.uniform(*ALONG), 0.005 + radius + random.uniform(*CLEAR), 0.5 * off[2]])
    axis = {"axis": [1.0, 0.0, 0.0] if place == "plate" else [0.0, 0.0, 1.0]} if shape == "cylinder" else {}
    own = {"shape": shape, "centre": centre.tolist(), "radius": radius, "direction": [0.0, 1.0, 0.0]}
    return own | axis | {"distance": [-0.001, 0.08], "method": "penalty"}


def simulated(finger: TouchedSegment, table: Table, tensions: list[float]) -> float:
    """Force along y on the object at rest [N]."""
    text = SCENE.format(
        shape=table["shape"],
        size=f"{table['radius']} {0.1 if table['shape'] == 'cylinder' else ''}",
        centre=" ".join(map(str, table["centre"])),
        axis=" ".join(map(str, table.get("axis", (0.0, 0.0, 1.0)))),
    )
    spec = mujoco.MjSpec.from_string(text)
    attached = attach(spec, finger.rod, "palm")
    simulation = Simulation(spec.compile(), [attached], rate=RATE)
    simulation.pull(0, tensions)
    simulation.advance(max(tensions) / RATE + SETTLES)
    return float(sum(simulation.data.sensor(name).data[1] for name in attached.sensors))


def moment(place: str, shape: str, seed: int) -> dict[str, Any]:
    """A random object, tensions at which the rod presses on it with a random force, and this force in MuJoCo [N]."""
    finger, random = TouchedSegment.load(), np.random.default_rng([60, seed])
    while True:
        table, asked = drawn(random, place, shape), float(np.exp(random.uniform(*np.log(FORCES))))
        before = TouchedSegment(rod=finger.rod, obstacle=rigid(table))
        ends, sideways = [0.0, MOST], float(random.uniform(*SIDEWAYS))
        for _ in range(HALVINGS):
            middle = sum(ends) / 2
            ends[float(before.evaluate([middle, sideways, 0.0]).contact_force) >= asked] = middle
        tensions = [ends[0], sideways]
        answer = before.evaluate([*tensions, 0.0])
        force, rubber = float(answer.contact_force), any(one.rubber for one in before.contact_forces([*tensions, 0.0]))
        if answer.inside and abs(force / asked - 1) < CLOSE and rubber == (place == "rubber"):
            break
    row = {"place": place, "shape": shape, "obstacle": table, "tensions": tensions, "rod": force}
    return row | {"mujoco": simulated(finger, table, tensions)}


def measure(run: Run) -> list[dict[str, Any]]:
    """All moments."""
    kinds = COUNT * [(place, shape) for place in PLACES for shape in SHAPES]
    return on_cores(moment, [(*kind, number) for number, kind in enumerate(kinds)])
