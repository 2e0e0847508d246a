"""Random objects before the bundled finger at rest: the force on them in the rod and in the full-order model.

A moment is a finger at rest at random tensions, without friction. Objects have sizes and positions of docs/grasping.md;
planes are tilted. The mesh of the full-order model bends like the finest, that of the bundled elements: its tip is off
by 0.014 % (docs/appendix.md).
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from rom import Rod, TouchedSegment
from rom.dataset.mesh_transfer import interpolation
from studies.parts import Run
from studies.rods.full_order import Table, rigid

KINDS = ("plate", "sphere"), ("plate", "cylinder"), ("plate", "plane"), ("rubber", "sphere"), ("rubber", "cylinder")
COUNT = 12  # moments of each kind
RADII = {"sphere": (0.012, 0.018), "cylinder": (0.009, 0.016)}  # [m]
FORCES, SIDEWAYS = (0.25, 4.0), (0.0, 8.0)  # of a moment, and tension of the second tendon [N]
AT, OFF = (0.0455, 0.030, 0.0), 0.004  # where objects are before the plate, and largest distance from there [m]
PLANE, TILT = 0.020, 0.3  # distance of planes from the axis [m]; largest components of the normal across y [-]
ALONG, CLEAR = (0.020, 0.036), (0.003, 0.007)  # of objects before the rubber: position, and distance at rest [m]
HALVINGS, CLOSE = 14, 0.05  # of tension; error of the force that is asked for [-]
# Cells along and across, order, stiffness of contact [-]. Each begins at the state of the one before. The default
# stiffness, 2000, changes the force of a ball on rubber by 0.1 %, and often fails: few points of the mesh press.
Stage = tuple[int, int, int, float]
STAGES: Sequence[Stage] = ((20, 5, 1, 20.0), (20, 5, 2, 20.0), (20, 5, 2, 100.0))
WASTED = 100  # iterations of failed steps, after which a stage that begins at another is given up


def drawn(random: np.random.Generator, place: str, shape: str) -> Table:
    """An obstacle of a scene, at d = 0."""
    off = random.standard_normal(3)
    off *= OFF * random.random() ** (1 / 3) / np.linalg.norm(off)
    table: Table = {"shape": shape, "direction": [0.0, 1.0, 0.0], "distance": [-0.001, 0.08], "method": "penalty"}
    if shape == "plane":
        normal = [random.uniform(-TILT, TILT), -1.0, random.uniform(-TILT, TILT)]
        return table | {"centre": [AT[0], PLANE + off[1], 0.0], "normal": normal}
    radius, centre = float(random.uniform(*RADII[shape])), AT + off
    if place == "rubber":
        centre = np.array([random.uniform(*ALONG), 0.005 + radius + random.uniform(*CLEAR), 0.5 * off[2]])
    axis = {"axis": [1.0, 0.0, 0.0] if place == "plate" else [0.0, 0.0, 1.0]} if shape == "cylinder" else {}
    return table | {"centre": centre.tolist(), "radius": radius} | axis


def asked(finger: Rod, random: np.random.Generator, place: str, shape: str) -> dict[str, Any]:
    """An object, and tensions at which the rod presses on it with a random force, by the plate or the rubber alone."""
    while True:
        table, force = drawn(random, place, shape), float(np.exp(random.uniform(*np.log(FORCES))))
        before, sideways = TouchedSegment(rod=finger, obstacle=rigid(table)), float(random.uniform(*SIDEWAYS))
        ends = [0.0, finger.parameters[0].upper]
        for _ in range(HALVINGS):
            middle = sum(ends) / 2
            ends[float(before.evaluate([middle, sideways, 0.0]).contact_force) >= force] = middle
        point = [ends[0], sideways, 0.0]
        answer, touched = before.evaluate(point), {one.rubber for one in before.contact_forces(point)}
        found, estimate = float(answer.contact_force), float(answer.error["contact_force"])
        if answer.inside and abs(found / force - 1) < CLOSE and touched == {place == "rubber"}:
            return {"place": place, "obstacle": table, "tensions": point[:2], "rod": found, "estimate": estimate}


def solved(obstacle: Table, tensions: list[float], stages: Sequence[Stage] = STAGES) -> float | None:
    """Force of the full-order finger that is pulled against an obstacle [N]; None if it did not converge."""
    from fingerfem import FingerModel
    from fingerfem.discretisation.node_order import NodeOrder
    from fingerfem.equilibrium.continuation import StepOptions
    from fingerfem.equilibrium.failures import LoadNotReached
    from fingerfem.scene.scene import Scene

    scene = TouchedSegment.load().rod.scene
    finger = {key: scene[key] for key in ("name", "geometry", "material", "tendons")}
    force, nodes, field = None, np.zeros(0), np.zeros(0)
    for along, across, order, stiffness in stages:
        mesh = {"cells": [along, across], "order": order}
        model = FingerModel(
            Scene.model_validate(finger | {"mesh": mesh, "obstacle": obstacle | {"stiffness": stiffness}})
        )
        numbering, continuation = NodeOrder(model.problem), model.continuation
        if force is None:
            continuation.start([0.0] * len(tensions), 0.0, np.zeros_like(model.problem.displacement))
        else:
            brought = interpolation(nodes, numbering.nodes)(field.reshape(-1, 1)).reshape(-1, 3)
            continuation.start(tensions, 0.0, numbering.scatter(brought))
            continuation.options = StepOptions(wasted=WASTED)
        try:
            continuation.advance(tensions, 0.0)
        except LoadNotReached:
            return None
        assert model.problem.contact is not None
        force = float(model.problem.contact.forces()[0])
        nodes, field = numbering.nodes, numbering.gather(model.problem.displacement)
    return force


def moment(number: int) -> dict[str, Any]:
    """A moment and its forces along y [N]."""
    row = asked(TouchedSegment.load().rod, np.random.default_rng([60, number]), *KINDS[number % len(KINDS)])
    return row | {"full_order": solved(row["obstacle"], row["tensions"])}


def measure(run: Run) -> list[dict[str, Any]]:
    """All moments."""
    return [run.once(f"moment {k}", moment, k) for k in range(COUNT * len(KINDS))]
