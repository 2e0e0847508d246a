"""CalculiX's files: the deck it reads, the displacements and forces it writes.

Lengths are in mm and moduli in Pa, so forces are in micronewtons: CalculiX takes a residual below 1e-6 for zero and a
D1 below 1e-10 for that of incompressible rubber, whatever the units are (calcresidual.c, hyperelastics.f). Its text
files have 7 digits; its file for restarts has the displacements as they are.
"""

from __future__ import annotations

import os
import resource
import subprocess
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from studies.peers.calculix.motions import Motion
from studies.peers.question import Finger

PROGRAM = "ccx"
MILLIMETRES, MICRONEWTONS = 1e3, 1e6  # in a metre, in a newton
# Of motions.block's corners, those that C3D8 names one after the other: around z = 0, then around z = 1.
C3D8 = [0, 1, 3, 2, 4, 5, 7, 6]
# Residual and correction over their means, that is until CalculiX's own cut; defaults of what is left out.
TIGHT = "1e-10, 1e-10, , , , 1e-30, , 1e-20"
MATERIAL = "RUBBER"


@dataclass(frozen=True, kw_only=True)
class Deck:
    """What CalculiX is to solve: the bar, step by step through a motion.

    Attributes:
        nodes: shape (nodes, 3) [m].
        cells: in the order of `motions.block`, shape (cells, 8).
        finger: whose rubber it is.
        motion: what its end does.
        steps: of the motion.
        controls: line of *CONTROLS, PARAMETERS=FIELD; CalculiX's defaults if empty.
        prints: whether the last step's answer is written.
    """

    nodes: np.ndarray
    cells: np.ndarray
    finger: Finger
    motion: Motion
    steps: int
    controls: str = ""
    prints: bool = False

    def text(self) -> str:
        """The input file."""
        lines = ["*NODE, NSET=ALL"]
        lines += [f"{k}, {_row(MILLIMETRES * place)}" for k, place in enumerate(self.nodes, 1)]
        lines += ["*ELEMENT, TYPE=C3D8, ELSET=BODY"]
        lines += [f"{k}, " + ", ".join(map(str, cell[C3D8] + 1)) for k, cell in enumerate(self.cells, 1)]
        lines += [f"*MATERIAL, NAME={MATERIAL}", "*HYPERELASTIC, NEO HOOKE", _row([self.finger.C1, self.finger.D1])]
        lines += [f"*SOLID SECTION, ELSET=BODY, MATERIAL={MATERIAL}", "*NSET, NSET=HELD"]
        lines += [f"{k + 1}," for k in np.flatnonzero(self.motion.held.any(axis=1))]
        for step, places in enumerate(self.motion.path(self.steps), 1):
            lines += ["*STEP, NLGEOM", "*STATIC, SOLVER=SPOOLES, DIRECT", "1., 1."]
            lines += ["*CONTROLS, PARAMETERS=FIELD", self.controls] if self.controls else []
            lines += ["*BOUNDARY"]
            for node, axis in zip(*np.nonzero(self.motion.held), strict=True):
                lines.append(f"{node + 1}, {axis + 1}, {axis + 1}, {_row([MILLIMETRES * places[node, axis]])}")
            if self.prints and step == self.steps:
                lines += ["*RESTART, WRITE, FREQUENCY=1", "*NODE PRINT, NSET=ALL", "U", "*NODE PRINT, NSET=HELD", "RF"]
            lines += ["*END STEP"]
        return "\n".join(lines) + "\n"


def _row(values: np.ndarray | list[float]) -> str:
    """Numbers as CalculiX reads them: 20 characters a field, 14 digits."""
    return ", ".join(f"{value:.13e}" for value in values)


@dataclass(frozen=True)
class Solved:
    """What CalculiX made of a deck; files are named `base` with endings of their own.

    Attributes:
        iterations: of Newton's method, each with a factorisation.
        seconds: of the whole process [core-seconds].
    """

    base: Path
    iterations: int
    seconds: float

    def forces(self) -> tuple[np.ndarray, np.ndarray]:
        """Which nodes are held, shape (held,), and the forces that hold them, 7 digits, shape (held, 3) [N]."""
        table = _tables(self.base)["forces"]
        return table[:, 0].astype(int) - 1, table[:, 1:] / MICRONEWTONS

    def displacements(self) -> np.ndarray:
        """Of all nodes, as they are in CalculiX, shape (nodes, 3) [m].

        Of the arrays in the file for restarts it is the one that agrees with the displacements in text.
        """
        printed = _tables(self.base)["displacements"][:, 1:]
        raw = self.base.with_suffix(".rout").read_bytes()
        length = 4 * 8 * len(printed)  # of every node a temperature and three displacements, in double precision
        arrays = [np.frombuffer(record).reshape(-1, 4)[:, 1:] for record in _records(raw) if len(record) == length]
        agreeing = [one for one in arrays if np.allclose(one, printed, rtol=1e-6, atol=1e-12 * np.abs(printed).max())]
        assert len(agreeing) == 1, f"one array must be the displacement, got {len(agreeing)} of {len(arrays)}"
        return agreeing[0] / MILLIMETRES


def _tables(base: Path) -> dict[str, np.ndarray]:
    """The tables of the text file by the first word of their titles; rows begin with the node's number."""
    found: dict[str, list[list[float]]] = {}
    name = ""
    for line in base.with_suffix(".dat").read_text().splitlines():
        if "for set" in line:
            name = line.split()[0]
            found[name] = []
        elif line.strip():
            found[name].append([float(word) for word in line.split()])
    return {name: np.array(rows) for name, rows in found.items()}


def _records(raw: bytes) -> Iterator[bytes]:
    """Records of an unformatted Fortran file: each between its length and its length, in 4 bytes."""
    at = 0
    while at < len(raw):
        length = int.from_bytes(raw[at : at + 4], "little")
        yield raw[at + 4 : at + 4 + length]
        at += length + 8


def solve(deck: Deck, base: Path) -> Solved:
    """Run CalculiX on one core.

    Raises:
        AssertionError: it has not done all steps.
    """
    base.parent.mkdir(parents=True, exist_ok=True)
    for file in base.parent.glob(f"{base.name}.*"):
        file.unlink()
    base.with_suffix(".inp").write_text(deck.text())
    alone = os.environ | {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
    before = _childrens_seconds()
    done = subprocess.run([PROGRAM, "-i", base.name], cwd=base.parent, env=alone, capture_output=True, text=True)
    seconds = _childrens_seconds() - before
    status = base.with_suffix(".sta")
    rows = [line.split() for line in status.read_text().splitlines()[2:]] if status.exists() else []
    if done.returncode or len(rows) != deck.steps:
        raise AssertionError(f"CalculiX must do {deck.steps} steps, did {len(rows)}: {done.stdout[-300:]}")
    return Solved(base, sum(int(row[3]) for row in rows), seconds)


def _childrens_seconds() -> float:
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def version() -> str:
    """Of the program, as it says it itself."""
    said = subprocess.run([PROGRAM, "-v"], capture_output=True, text=True).stdout
    return said.split("Version")[1].split()[0]
