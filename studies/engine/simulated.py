"""The moments of the full-order model in MuJoCo: forces of fingers that are pulled against fixed objects."""

from __future__ import annotations

import json
from typing import Any

import mujoco

from control.mujoco import Simulation, attach
from rom import Rod, TouchedSegment
from studies.parts import Run, Unmeasured

RATE, SETTLES, LATER = 100.0, 0.6, 0.1  # [N/s]; after the last change of tension, and until the force is read again [s]
STILL = 1e-3  # largest change of the force within LATER [-]
SCENE = """
<mujoco><option timestep="0.001" gravity="0 0 0"/><worldbody><body name="palm"/>
<geom type="{shape}" size="{size}" pos="{centre}" zaxis="{axis}" friction="0 0 0"/>
</worldbody></mujoco>
"""


def words(numbers: list[float]) -> str:
    """Numbers of an attribute."""
    return " ".join(map(str, numbers))


def simulated(finger: Rod, table: dict[str, Any], tensions: list[float]) -> float:
    """Force along y of a finger at rest on an object [N].

    Raises:
        RuntimeError: the finger is not at rest, or outside its domain.
    """
    size = [1.0, 1.0, 1.0] if table["shape"] == "plane" else [table["radius"], 0.1]
    axis = table.get("axis") or table.get("normal") or [0.0, 0.0, 1.0]
    text = SCENE.format(shape=table["shape"], size=words(size), centre=words(table["centre"]), axis=words(axis))
    spec = mujoco.MjSpec.from_string(text)
    attached = attach(spec, finger, "palm")
    simulation, forces = Simulation(spec.compile(), [attached], rate=RATE), []
    simulation.pull(0, tensions)
    for wait in (SETTLES, SETTLES + LATER):
        simulation.advance(max(tensions) / RATE + wait)
        forces.append(float(sum(simulation.data.sensor(name).data[1] for name in attached.sensors)))
    if abs(forces[1] / forces[0] - 1) > STILL or simulation.lost.any():
        raise RuntimeError(f"the finger must be at rest within its domain, got forces {forces} N")
    return forces[1]


def measure(run: Run) -> list[float]:
    """Forces of all moments; `full_order` must have been measured."""
    file = run.folder / "full_order.json"
    if not file.exists():
        raise Unmeasured(f"{run.name} needs engine/full_order")
    finger, rows = TouchedSegment.load().rod, json.loads(file.read_text())["result"]
    return [run.once(f"moment {k}", simulated, finger, row["obstacle"], row["tensions"]) for k, row in enumerate(rows)]
