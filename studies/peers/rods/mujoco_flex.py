"""A finger in MuJoCo as a three-dimensional flex: finite elements of 27 nodes, in a simulator of robots.

Every node is a body, so a tendon can run through sites on a row of nodes; nodes of the last layer are pinned to a
rigid plate, and those of the first one to the world. The tension is spread over the column of cells around the tendon's
line, by Simpson's rule over its three by three rows of nodes: on one row alone a tendon cuts into its rubber. A
tendon's own stiffness against being bent is not in MuJoCo's implicit step and is more than that of a node of rubber;
the nodes it runs through are made heavy, or it would swing up.
"""

from __future__ import annotations

import time
from dataclasses import dataclass

import mujoco
import numpy as np

from studies.peers.question import FREE, Answers, Finger, finger
from studies.peers.rods.asking import Rubber, Told, answers, ask, refined
from studies.peers.rods.mujoco_rest import HARD, Pace, Resting, options, plane, pulled

# Cells along, across in the plane of bending, and across it. With five in the plane the tendon's line, 4 mm from the
# axis, is the middle of one; across it their number must be odd for that.
CELLS = ((4, 5, 3), (6, 5, 3), (6, 5, 5), (10, 5, 5))
CHOSEN = 3
QUICK = 0  # the one that is asked
REFINED = ((60.0, None), (60.0, 0.010))  # states that all meshes are asked
DENSITY = 1000.0  # [kg/m^3]; where it comes to rest does not depend on it
PACE = Pace(step=2e-4, ramp=20, moved=2e-6, longest=1000)
SLIDES = "".join(f'<joint type="slide" axis="{axis}"/>' for axis in ("1 0 0", "0 1 0", "0 0 1"))
SIMPSON = {-1: 1 / 6, 0: 4 / 6, 1: 1 / 6}  # weights of a cell's three nodes
STABLE = 1.5  # mass of a node on a tendon, over that at which an explicit step begins to swing up
# Six tetrahedra that fill the block, of its eight vertices: MuJoCo takes the flex's volume from them.
BLOCK = "0 1 3 7 0 1 5 7 0 2 3 7 0 2 6 7 0 4 5 7 0 4 6 7"


@dataclass(frozen=True)
class Grid:
    """Nodes of the rubber, three coordinates [m]."""

    finger: Finger
    cells: tuple[int, int, int]

    def lines(self) -> list[np.ndarray]:
        """Of nodes along x, y, z."""
        half = self.finger.side / 2
        along = np.linspace(0, Rubber(self.finger).length, 2 * self.cells[0] + 1)
        return [along, *(np.linspace(-half, half, 2 * number + 1) for number in self.cells[1:])]

    def rows(self) -> dict[tuple[int, int], float]:
        """The nodes' places across in the cell around the tendon, and their shares of the tension."""
        _, y, z = self.lines()
        j, k = int(np.argmin(np.abs(y - self.finger.offset))), len(z) // 2
        assert j % 2 and k % 2 and abs(y[j] - self.finger.offset) < 1e-9, "the tendon is not in the middle of a cell"
        return {(j + up, k + aside): SIMPSON[up] * SIMPSON[aside] for up in SIMPSON for aside in SIMPSON}


def xml(grid: Grid) -> str:
    """The model."""
    finger, length = grid.finger, Rubber(grid.finger).length
    half = finger.side / 2
    bodies, nodes, places = _nodes(grid)
    layers = range(2 * grid.cells[0] + 1)
    rows = grid.rows()
    tendons, motors = zip(*(pulled([_eyelet(i, *row) for i in layers], rows[row]) for row in rows), strict=True)
    size = f"{finger.plate / 2} {half} {half}"
    plate = (
        f'<body name="plate" pos="{length} 0 0"><freejoint/>'
        f'<geom type="box" pos="{finger.plate / 2} 0 0" size="{size}" density="{DENSITY}"/>'
        f"{_end_eyelets(grid, layers[-1])}"
        f'<site name="tip" pos="{finger.plate / 2} 0 0"/></body>'
    )
    block = [(x, y, z) for x in (0, length) for y in (-half, half) for z in (-half, half)]
    flex = (
        f'<flex name="rubber" dim="3" radius="0" dof="quadratic" cellcount="{_numbers(grid.cells)}" '
        f'node="{" ".join(nodes)}" nodecoord="{_numbers(places)}" body="{" ".join(["world"] * 8)}" '
        f'vertex="{_numbers(block)}" element="{BLOCK}"><elasticity young="{finger.young}" poisson="{finger.poisson}"/>'
        '<contact contype="0" conaffinity="0" selfcollide="none"/></flex>'
    )
    return (
        f'<mujoco>{options(PACE)}<size memory="500M"/><worldbody>{plane(PACE, HARD)}'
        f"{_end_eyelets(grid, 0)}{''.join(bodies)}{plate}</worldbody><deformable>{flex}</deformable>"
        f"<tendon>{''.join(tendons)}</tendon><actuator>{''.join(motors)}</actuator></mujoco>"
    )


def _eyelet(i: int, j: int, k: int) -> str:
    return f"eyelet{i}_{j}_{k}"


def _end_eyelets(grid: Grid, layer: int) -> str:
    """Where the tendons begin and end, in the axes of the world and of the plate."""
    _, y, z = grid.lines()
    return "".join(f'<site name="{_eyelet(layer, j, k)}" pos="0 {y[j]} {z[k]}"/>' for j, k in grid.rows())


def _nodes(grid: Grid) -> tuple[list[str], list[str], list[tuple[float, ...]]]:
    """Bodies of the nodes between the two ends; the body of every node, and its place there [m]."""
    x, y, z = grid.lines()
    rows = grid.rows()
    light = DENSITY * x[-1] * grid.finger.side**2 / (len(x) * len(y) * len(z))
    heavy = STABLE * max(FREE) / x[1] * PACE.step**2  # a string's nodes have the stiffness 4 tension/interval
    bodies: list[str] = []
    nodes: list[str] = []
    places: list[tuple[float, ...]] = []
    for i, j, k in np.ndindex(len(x), len(y), len(z)):
        if i in (0, len(x) - 1):
            nodes.append("plate" if i else "world")
            places.append((0.0, float(y[j]), float(z[k])))
            continue
        mass = light + heavy * rows.get((j, k), 0.0)
        eyelet = f'<site name="{_eyelet(i, j, k)}"/>' if (j, k) in rows else ""
        nodes.append(f"node{i}_{j}_{k}")
        places.append((0.0, 0.0, 0.0))
        bodies.append(
            f'<body name="{nodes[-1]}" pos="{x[i]} {y[j]} {z[k]}"><inertial pos="0 0 0" mass="{mass}" '
            f'diaginertia="{_numbers([1e-6 * mass] * 3)}"/>{SLIDES}{eyelet}</body>'
        )
    return bodies, nodes, places


def _numbers(values) -> str:
    return " ".join(repr(value) for value in np.ravel(values).tolist())


def _two(resting: Resting) -> Told:
    """The states that all meshes are asked."""
    begun = time.process_time()
    (free, _), (touching, force) = (resting.solve(*state) for state in REFINED)
    seconds = (time.process_time() - begun) / len(REFINED)
    return Told(free=[free], touching=[touching], forces=[force], seconds=seconds)


def measure(quick: bool = False) -> list[Answers]:
    """Its answers on one mesh, and two states on all."""
    meshes, chosen = (CELLS[: QUICK + 1], QUICK) if quick else (CELLS, CHOSEN)
    restings = [Resting(xml(Grid(finger(), cells)), finger(), PACE) for cells in meshes]
    rows = [
        {"cells": list(cells), "unknowns": int(resting.model.nv)}
        for cells, resting in zip(meshes, restings, strict=True)
    ]
    resting = restings[chosen]
    words = {
        "name": "flex, MuJoCo",
        "kind": "simulator",
        "settings": (
            f"MuJoCo {mujoco.__version__}, {' x '.join(map(str, meshes[chosen]))} cells of 27 nodes "
            f"({resting.model.nv} unknowns), E and Poisson's ratio of small strains, nine spatial tendons through "
            f"nodes around the channel, rigid plate; integrator discrete, steps of {1e3 * PACE.step:g} ms, kinetic "
            f"damping until the tip moves less than {1e6 * PACE.moved:g} µm; contact impedance {HARD}, solref twice "
            "the step"
        ),
        "limits": (
            "stresses are linear in strain, made for small ones; the tendon has no tangent in the implicit step, so it "
            "comes to rest by a hundred and more small steps; each is a linear solve, which MuJoCo stops early where "
            "nodes are pinned to a plate, and warns of: that costs steps and leaves equilibrium as it is"
        ),
    }
    return [answers(words, ask(resting.solve), refined(rows, [_two(one) for one in restings]))]
