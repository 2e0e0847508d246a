"""FElupe's process: reads a finger and states of it, solves them by FElupe, and writes the answers.

PYTHONPATH=.:out/peers/felupe python3 -m studies.peers.felupe.finger FILE_IN FILE_OUT

FElupe is under the GPL and no part of this project. This process alone imports it; two files are its only link with the
rest. FILE_IN (comparison.py writes it) holds nodes, cells, which cells are what, and numbers of the scene. FILE_OUT has
the displacements, in the order of the given nodes, and the contact forces.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any

import felupe
import numpy as np
from scipy.sparse.linalg import spsolve

from studies.peers.felupe.contact import NodalSprings, nodal_areas
from studies.peers.felupe.laws import Fibre, materials

# Round-off of steel keeps the residual at some 1e-12 of E a^2. Newton's method converges quadratically: after an
# iteration that moves no node by a billionth of the length, nothing but round-off is left.
NOISE, SETTLED = 1e-8, 1e-9


class Finger:
    """The finger of a file, see `comparison.described`."""

    def __init__(self, arrays: dict[str, np.ndarray], scene: dict[str, Any]):
        self.scene, self._points, self._order = scene, arrays["points"], scene["order"]
        self._cells = in_felupes_order(self._points, arrays["cells"], self._order)
        every, rubber = np.ones(len(self._cells), bool), arrays["rubber"]
        self.field = self._field_on(every)
        self._bodies = []
        for law, own, fewer in ((scene["law"], rubber, scene["mixed"]), (scene["plate_law"], ~rubber, 0)):
            distortion, bulk = materials(law)
            self._bodies.append(felupe.SolidBody(distortion, self._field_on(own)))
            self._bodies.append(felupe.SolidBody(bulk, self._field_on(own, fewer)))
        for own, density in ((rubber, scene["densities"][0]), (~rubber, scene["densities"][1])):
            gravity = {"values": scene["acceleration"], "scale": density}
            self._bodies.append(felupe.SolidBodyForce(self._field_on(own), **gravity))
        self._fibres = [Fibre() for _ in arrays["channels"]]
        for fibre, channel in zip(self._fibres, arrays["channels"], strict=True):
            self._bodies.append(felupe.SolidBody(fibre, self._field_on(channel)))
        self._chambers = [felupe.SolidBodyPressure(self._field_on_wall(wall)) for wall in arrays["walls"]]
        self._springs = NodalSprings(self.field, scene["stiffness"] * self._areas())
        clamp = {"clamp": felupe.Boundary(self.field[0], fx=0.0)}
        self._held, self._free = felupe.dof.partition(self.field, clamp)

    def _field_on(self, chosen: np.ndarray, fewer: int = 0) -> Any:
        """The displacement on some cells, integrated by Gauss's rule, of so many points fewer along each axis."""
        kinds = {1: felupe.RegionHexahedron, 2: felupe.RegionTriQuadraticHexahedron}
        rule = felupe.GaussLegendre(order=self._order - fewer, dim=3)
        return felupe.FieldContainer([felupe.Field(kinds[self._order](self._mesh(chosen), quadrature=rule), dim=3)])

    def _field_on_wall(self, wall: np.ndarray) -> Any:
        """The displacement on the faces between a chamber's nodes, shape (nodes,), of cells of order 1."""
        mesh = self._mesh(np.ones(len(self._cells), bool))
        return felupe.FieldContainer([felupe.Field(felupe.RegionHexahedronBoundary(mesh, mask=wall), dim=3)])

    def _mesh(self, chosen: np.ndarray) -> Any:
        return felupe.Mesh(self._points, self._cells[chosen], {1: "hexahedron", 2: "hexahedron27"}[self._order])

    def _areas(self) -> np.ndarray:
        """Area that each node stands for, of every face but the clamp, shape (nodes,) [m^2]."""
        half = self.scene["side"] / 2
        faces = [(axis, side * half) for axis in (1, 2) for side in (-1, 1)] + [(0, self.scene["length"])]
        return np.sum([nodal_areas(self._points, self._cells, self._order, *face) for face in faces], axis=0)

    def solve(self, start: np.ndarray, loads: np.ndarray, distance: float | None) -> tuple[np.ndarray, float]:
        """Equilibrium by FElupe's Newton method from a start: displacement, shape (nodes, 3) [m], contact force [N].

        Loads are tensions [N], then pressures [Pa].
        """
        tensions, pressures = np.split(loads, [len(self._fibres)])
        for fibre, tension in zip(self._fibres, tensions, strict=True):
            fibre.density = tension / self.scene["channel_area"]
        for chamber, pressure in zip(self._chambers, pressures, strict=True):
            chamber.update(pressure)
        self._springs.height = self.scene["side"] / 2 + (np.inf if distance is None else distance)
        self.field[0].values[:] = start
        found = felupe.newtonraphson(
            x0=self.field,
            items=[*self._bodies, *self._chambers, self._springs],
            dof0=self._held,
            dof1=self._free,
            ext0=np.zeros(len(self._held)),
            solver=spsolve,
            check=self._check,
            verbose=0,
        )
        return found.x[0].values.copy(), self._springs.force()

    def _check(self, dx: Any, x: Any, f: np.ndarray, **given: Any) -> tuple[float, float, bool]:
        """Change over the length, residual over the force scale, and convergence of FElupe's Newton method."""
        moved = float(np.abs(dx).max()) / self.scene["length"]
        left = float(np.linalg.norm(f[given["dof1"]])) / self.scene["force_scale"]
        return moved, left, left <= NOISE and moved <= SETTLED


def in_felupes_order(points: np.ndarray, cells: np.ndarray, order: int) -> np.ndarray:
    """Cells whose nodes are in FElupe's order, found by where they are in their cell, a box."""
    corners = points[cells]
    low, high = corners.min(axis=1, keepdims=True), corners.max(axis=1, keepdims=True)
    local = np.rint(2 * (corners - low) / (high - low)).astype(int) @ [9, 3, 1]
    element = felupe.Hexahedron() if order == 1 else felupe.TriQuadraticHexahedron()
    wanted = np.rint(element.points + 1).astype(int) @ [9, 3, 1]
    found = np.argsort(local, axis=1)[:, np.argsort(np.argsort(wanted))]
    return np.take_along_axis(cells, found, axis=1)


def answer(given: Path, wanted: Path) -> None:
    """Read states, solve them, write what came out."""
    with np.load(given) as file:
        arrays = {name: file[name] for name in file.files}
    scene, starts = json.loads(str(arrays.pop("scene"))), arrays.pop("starts")
    finger = Finger(arrays, scene)
    pairs = zip(starts, scene["states"], strict=True)
    found = [finger.solve(start, np.array(loads, float), distance) for start, (loads, distance) in pairs]
    np.savez(wanted, displacements=[one for one, _ in found], contact_forces=[force for _, force in found])


if __name__ == "__main__":
    answer(Path(sys.argv[1]), Path(sys.argv[2]))
