"""Frequencies about a loaded state, by CalculiX: a bar that sags under its weight has those of *FREQUENCY."""

import os
import subprocess
from pathlib import Path

import numpy as np
import pytest

from fingerfem.dynamics.modes import ModalAnalysis
from fingerfem.scene.scene import Scene

CALCULIX = Path(__file__).parents[3] / "out" / "peers" / "calculix" / "usr"
pytestmark = pytest.mark.skipif(
    not (CALCULIX / "bin" / "ccx").exists(), reason="CalculiX is not in its folder: make out/peers/calculix/ready"
)
E, NU, RHO, PLATES, SIDE, LENGTH, COUNT = 1e6, 0.3, 1100.0, 7850.0, 0.01, 0.06, 6
# Corners of a cell, then nodes on its edges, as CalculiX numbers those of C3D20; in half cells along x, y and z.
C3D20 = [
    *([0, 0, 0], [2, 0, 0], [2, 2, 0], [0, 2, 0], [0, 0, 2], [2, 0, 2], [2, 2, 2], [0, 2, 2]),
    *([1, 0, 0], [2, 1, 0], [1, 2, 0], [0, 1, 0], [1, 0, 2], [2, 1, 2], [1, 2, 2], [0, 1, 2]),
    *([0, 0, 1], [2, 0, 1], [2, 2, 1], [0, 2, 1]),
]


@pytest.fixture
def hanging():
    """A scene of a bar in weight, at an angle to its axis."""
    return {
        "name": "bar",
        "geometry": {"side": SIDE, "segments": [LENGTH], "plate": 0.001, "channel": SIDE / 3},
        "material": {"law": "saint-venant-kirchhoff", "E": E, "nu": NU},
        "density": {"rubber": RHO, "plates": PLATES},
        "gravity": {"direction": [0.6, -0.8, 0.0], "acceleration": 60.0},
        "tendons": [{"name": "F1", "offset": [SIDE / 3, 0.0], "segment": 1, "tension": [0.0, 1.0]}],
        "mesh": {"cells": [15, 3], "order": 2},
    }


def input_file(scene: Scene, lines: np.ndarray) -> str:
    """CalculiX's input: the bar on cells of 20 nodes between the same lines, its weight, then frequencies."""
    along, across = np.sort([*lines, *((lines[1:] + lines[:-1]) / 2)]), np.linspace(-SIDE / 2, SIDE / 2, 7)
    shape = len(along), 7, 7
    nodes = np.stack(np.meshgrid(along, across, across, indexing="ij"), axis=-1).reshape(-1, 3)
    firsts = 2 * np.argwhere(np.ones((len(lines) - 1, 3, 3)))
    cells = 1 + np.array([np.ravel_multi_index((first + C3D20).T, shape) for first in firsts])
    words = ["*NODE", *(f"{n}, {', '.join(map(repr, nodes[n - 1].tolist()))}" for n in np.unique(cells))]
    is_plate = along[firsts[:, 0]] > LENGTH - 1.5 * scene.geometry.plate
    x, y, z = scene.gravity.direction
    step = ["*STEP, NLGEOM, INC=100", "*STATIC", "0.2, 1.", "*DLOAD"]
    for name, own, young, nu, density in ("RUBBER", ~is_plate, E, NU, RHO), ("PLATE", is_plate, 200e9, 0.3, PLATES):
        words.append(f"*ELEMENT, TYPE=C3D20, ELSET={name}")
        for cell in np.flatnonzero(own):
            numbers = [str(1 + cell), *map(str, cells[cell])]
            words += [", ".join(numbers[:11]) + ",", ", ".join(numbers[11:])]
        words += [f"*MATERIAL, NAME={name}", "*ELASTIC", f"{young}, {nu}", "*DENSITY", f"{density}"]
        words.append(f"*SOLID SECTION, ELSET={name}, MATERIAL={name}")
        step.append(f"{name}, GRAV, {scene.gravity.acceleration}, {x}, {y}, {z}")
    clamp = [str(n) for n in np.unique(cells) if nodes[n - 1, 0] == 0.0]
    words += ["*NSET, NSET=CLAMP", *clamp, "*BOUNDARY", "CLAMP, 1, 3"]
    return "\n".join([*words, *step, "*END STEP", "*STEP, PERTURBATION", "*FREQUENCY", str(COUNT), "*END STEP", ""])


def by_calculix(text: str, folder: Path) -> np.ndarray:
    """Frequencies [Hz] of an input file."""
    (folder / "bar.inp").write_text(text)
    variables = os.environ | {"LD_LIBRARY_PATH": os.pathsep.join(map(str, (CALCULIX / "lib").iterdir()))}
    subprocess.run([CALCULIX / "bin" / "ccx", "-i", "bar"], cwd=folder, env=variables, check=True, capture_output=True)
    table = (folder / "bar.dat").read_text().split("P A R T I C I P A T I O N")[0]
    rows = [line.split() for line in table.splitlines() if line.strip()[:1].isdigit()]
    return np.array([float(row[3]) for row in rows])


def test_a_bar_that_sags_has_the_frequencies_of_calculix(hanging, tmp_path):
    """Cells of 20 and of 27 nodes differ by 0.1 %. Weight raises the first pair by far more."""
    scene = Scene.model_validate(hanging)
    analysis = ModalAnalysis(scene)
    ours = analysis.solve([0.0], count=COUNT).frequencies
    hanging["gravity"]["acceleration"] = 1e-3
    straight = ModalAnalysis(Scene.model_validate(hanging)).solve([0.0], count=COUNT).frequencies
    assert (ours[:2] > 1.05 * straight[:2]).all()
    assert ours == pytest.approx(by_calculix(input_file(scene, analysis.problem.mesh.lines), tmp_path), rel=1.5e-3)
