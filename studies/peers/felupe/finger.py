"""The finger in FElupe: its mesh, bodies, supports and contact; imported in FElupe's own process alone.

Everything that is integrated is integrated by FElupe: of the file that the finger comes from it takes nodes, cells,
which cells are what, and numbers of the scene.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import felupe
import numpy as np
from scipy.sparse.linalg import spsolve

from studies.peers.felupe.contact import Facets, Nitsche, NodalSprings
from studies.peers.felupe.laws import Fibre, parts, whole

ITERATIONS = 50  # most in one attempt; FElupe's own 16 are too few where a slender finger bends
TOUCHING = 1e-9  # [m]: coordinates that differ by less are the same


@dataclass(frozen=True, kw_only=True)
class Tolerance:
    """When Newton's method is done.

    Attributes:
        residual: of the residual's 2-norm over the force scale E a^2 [-]; or, where round-off keeps that up, ...
        noise: ... residual below which ...
        settled: ... an iteration that moves no node by more than this share of the length is the last [-].
    """

    residual: float
    noise: float
    settled: float


class Finger:
    """The finger of a file.

    Args:
        arrays: `points` (nodes, 3) [m], `cells` (cells, 8 or 27) in any order of their nodes, `rubber` (cells,) and
            `channels` (tendons, cells), which cells are rubber and which carry a tendon.
        scene: numbers, as `comparison.described` writes them.
        tolerance: of Newton's method.

    Attributes:
        factorisations: how many linear systems it has solved.
    """

    def __init__(
        self,
        arrays: dict[str, np.ndarray],
        scene: dict[str, Any],
        tolerance: Tolerance,
    ):
        self.scene, self._tolerance = scene, tolerance
        self.factorisations = 0
        self._points, self._order = arrays["points"], scene["order"]
        self._cells = in_felupes_order(self._points, arrays["cells"], self._order)
        self._all = np.ones(len(self._cells), bool)
        self.field = self._field_on(self._all, self._order + 1)
        self._bodies = self._solids(arrays["rubber"])
        self._fibres = []
        for channel in arrays["channels"]:
            self._fibres.append(Fibre())
            self._bodies.append(felupe.SolidBody(self._fibres[-1], self._field_on(channel, self._order + 1)))
        self._contacts = self._plane_contacts() if scene["obstacle"] else []
        supports = {"clamp": felupe.Boundary(self.field[0], fx=0.0)}
        if scene["half"]:
            supports["cut"] = felupe.Boundary(self.field[0], fz=0.0, skip=(True, True, False))
        self._held, self._free = felupe.dof.partition(self.field, supports)
        self.rest = np.zeros_like(self._points)

    def _field_on(self, chosen: np.ndarray, along: int) -> Any:
        """The displacement on some cells, integrated by Gauss's rule with so many points along an edge."""
        kinds = {1: felupe.RegionHexahedron, 2: felupe.RegionTriQuadraticHexahedron}
        rule = felupe.GaussLegendre(order=along - 1, dim=3)
        region = kinds[self._order](self._mesh(chosen), quadrature=rule)
        return felupe.FieldContainer([felupe.Field(region, dim=3)])

    def _mesh(self, chosen: np.ndarray) -> Any:
        return felupe.Mesh(self._points, self._cells[chosen], {1: "hexahedron", 2: "hexahedron27"}[self._order])

    def _solids(self, rubber: np.ndarray) -> list[Any]:
        """Rubber and plates; the volumetric part of nearly incompressible rubber by the reduced rule."""
        scene, along = self.scene, self._order + 1
        found = [felupe.SolidBody(whole(scene["plate_law"]), self._field_on(~rubber, along))]
        if not scene["mixed"]:
            return [*found, felupe.SolidBody(whole(scene["law"]), self._field_on(rubber, along))]
        for material, points in zip(parts(scene["law"]), (along, along - 1), strict=True):
            found.append(felupe.SolidBody(material, self._field_on(rubber, points)))
        return found

    def _plane_contacts(self) -> list[Any]:
        """Contact of every face but clamp and cut."""
        scene, x = self.scene, self._points[:, 0]
        method, gamma = scene["obstacle"]["method"], scene["obstacle"]["stiffness"]
        mesh, ends = self._mesh(self._all), np.ravel(scene["plates"])
        faces = [(axis, side) for axis in (1, 2) for side in (-1, 1)]
        half = scene["side"] / 2
        sides = {(axis, side): abs(self._points[:, axis] - side * half) < TOUCHING for axis, side in faces}

        def on_sides(spans: np.ndarray) -> list[Facets]:
            within = [(x > start - TOUCHING) & (x < end + TOUCHING) for start, end in spans]
            chosen = [(face, span & nodes) for span in within for face, nodes in sides.items() if nodes.any()]
            return [Facets(mesh, self._order, face, nodes) for face, nodes in chosen]

        of_rubber = on_sides(np.append(0.0, ends[:-1]).reshape(-1, 2))
        tip = Facets(mesh, self._order, (0, 1), abs(x - ends[-1]) < TOUCHING)
        of_plates = [*on_sides(ends.reshape(-1, 2)), tip]
        if method == "penalty":
            areas = sum(facets.nodal_areas() for facets in of_plates + of_rubber)
            return [NodalSprings(self.field, gamma * areas)]
        areas = sum(facets.nodal_areas() for facets in of_plates)
        own = [Nitsche(facets, gamma, whole(scene["law"])) for facets in of_rubber]
        return [NodalSprings(self.field, scene["obstacle"]["plates"] * gamma * areas), *own]

    def reach(self, displacement: np.ndarray) -> float:
        """How far a displaced finger reaches towards the plane: the d at which its first node touches [m]."""
        moved = self._points + displacement
        return float(moved[self._points[:, 0] > TOUCHING, 1].max() - self.scene["side"] / 2)

    def solve(self, start: np.ndarray, tensions: np.ndarray, distance: float | None) -> np.ndarray:
        """Equilibrium by FElupe's Newton method, full steps, shape (nodes, 3) [m].

        Args:
            start: displacement that the iterations begin at, shape (nodes, 3) [m].
            tensions: shape (tendons,) [N].
            distance: of the plane [m]; None: it is away.

        Raises:
            felupe.tools.NewtonConvergenceError or ArithmeticError: it did not converge.
        """
        for fibre, tension in zip(self._fibres, tensions, strict=True):
            fibre.density = tension / self.scene["channel_area"]
        for contact in self._contacts:
            contact.height = self.scene["side"] / 2 + (np.inf if distance is None else distance)
        self.field[0].values[:] = start
        found = felupe.newtonraphson(
            x0=self.field,
            items=[*self._bodies, *self._contacts],  # Nitsche's terms are there without a plane, too
            dof0=self._held,
            dof1=self._free,
            ext0=np.zeros(len(self._held)),
            solver=self._counted,
            check=self._check,
            verbose=0,
            maxiter=ITERATIONS,
        )
        values = found.x[0].values.copy()
        for body in self._bodies:
            if np.linalg.det(body.field.extract()[0].transpose(2, 3, 0, 1)).min() <= 0:
                raise ArithmeticError("a cell is turned inside out")
        return values

    def contact_force(self, displacement: np.ndarray, distance: float) -> float:
        """What the plane feels of a displaced finger [N]."""
        self.field[0].values[:] = displacement
        total = 0.0
        for contact in self._contacts:
            contact.height = self.scene["side"] / 2 + distance
            contact.field.link(self.field)
            total += contact.force()
        return (2 if self.scene["half"] else 1) * total

    def _counted(self, matrix: Any, right: np.ndarray) -> np.ndarray:
        if not (np.isfinite(right).all() and np.isfinite(matrix.data).all()):
            raise FloatingPointError("residual or tangent is not finite")
        self.factorisations += 1
        return spsolve(matrix, right)

    def _check(self, dx: Any, x: Any, f: np.ndarray, **given: Any) -> tuple[float, float, bool]:
        """Of FElupe's Newton method: change over the length, residual over the force scale, whether that is enough."""
        moved = float(np.abs(dx).max()) / self.scene["length"]
        left = float(np.linalg.norm(f[given["dof1"]])) / self.scene["force_scale"]
        wanted = self._tolerance
        return moved, left, left <= wanted.residual or (left <= wanted.noise and moved <= wanted.settled)


def in_felupes_order(points: np.ndarray, cells: np.ndarray, order: int) -> np.ndarray:
    """Cells whose nodes are in FElupe's order, found by where they are in their cell, a box."""
    corners = points[cells]
    low, high = corners.min(axis=1, keepdims=True), corners.max(axis=1, keepdims=True)
    local = np.rint(2 * (corners - low) / (high - low)).astype(int) @ [9, 3, 1]
    element = felupe.Hexahedron() if order == 1 else felupe.TriQuadraticHexahedron()
    wanted = np.rint(element.points + 1).astype(int) @ [9, 3, 1]
    found = np.argsort(local, axis=1)[:, np.argsort(np.argsort(wanted))]
    return np.take_along_axis(cells, found, axis=1)
