"""Limits of cells and laws on a deformation, and the volume ratio that enters the laws."""

from typing import NamedTuple

import numpy as np
import ufl
from dolfinx import fem
from mpi4py import MPI

from fingerfem.discretisation import form_cache, regions
from fingerfem.discretisation.mesh import FingerMesh
from fingerfem.discretisation.tangent import gauss
from fingerfem.mechanics import kinematics
from fingerfem.scene.laws import Law
from fingerfem.scene.scene import Scene

THIRDS = (0, 0.5, 1)
CORNERS = np.array([[i, j, k] for i in THIRDS for j in THIRDS for k in THIRDS], float)  # midpoints and centre, too


class _Material(NamedTuple):
    """A material's name, law and cells of this rank, and C at its points of integration if stretches are limited."""

    name: str
    law: Law
    cells: np.ndarray
    strain: fem.Expression | None


class DeformationLimits:
    """Volume ratios and stretches of a finger's cells (all methods are collective).

    A value that is not a number on one rank exceeds every limit, on all of them.

    Args:
        scene: with the laws of its materials.
        mesh: with its regions.
        u: displacement [m].
        degree: of the Gauss rule that integrates the energy.
    """

    def __init__(self, scene: Scene, mesh: FingerMesh, u: fem.Function, degree: int):
        self._mesh, self._comm = mesh.mesh, mesh.mesh.comm
        owned = mesh.mesh.topology.index_map(mesh.mesh.topology.dim).size_local
        self._cells = np.arange(owned, dtype=np.int32)
        F = kinematics.deformation_gradient(u)
        self._ratio = form_cache.expression(ufl.det(F), CORNERS)
        self._materials = []
        names = ["rubber", *(one.name for one in scene.materials)]
        for k, (name, law) in enumerate(zip(names, scene.laws, strict=True)):
            cells = np.unique(np.concatenate([mesh.cells.find(region) for region in regions.of_material(k)]))
            is_limited = law.limits != (0.0, np.inf) or law.stretches is not None
            strain = form_cache.expression(F.T * F, gauss(degree)[0]) if is_limited else None
            self._materials.append(_Material(name, law, cells[cells < owned].astype(np.int32), strain))
        mixed = [one.cells for one in self._materials if one.law.is_mixed]
        self._mixed = np.sort(np.concatenate([np.zeros(0, np.int32), *mixed]))
        self._others = np.setdiff1d(self._cells, self._mixed)
        self._pressed = form_cache.expression(ufl.det(F), gauss(degree - 1)[0]) if mixed else None

    def _smallest(self, values: np.ndarray) -> float:
        """Over all ranks; -inf where one is not a number, which MPI would drop."""
        own = float(values.min()) if values.size else np.inf
        return float(self._comm.allreduce(-np.inf if np.isnan(own) else own, op=MPI.MIN))

    def smallest_of_cells(self) -> float:
        """Min J = det F over corners, midpoints and centres of all cells [-]."""
        return self._smallest(self._ratio.eval(self._mesh, self._cells))

    def smallest_of_laws(self) -> float:
        """The same, but of material with a pressure of its own at the points of that pressure [-]."""
        if self._pressed is None:
            return self.smallest_of_cells()
        mixed = self._smallest(self._pressed.eval(self._mesh, self._mixed))
        return min(mixed, self._smallest(self._ratio.eval(self._mesh, self._others)))

    def extreme_stretches(self) -> dict[str, tuple[float, float]]:
        """Least and largest principal stretch at the points of integration, by material [-].

        Only materials with limits or stretches of data in their law are listed.
        """
        return {one.name: self._extremes(one.strain, one.cells) for one in self._materials if one.strain is not None}

    def _extremes(self, strain: fem.Expression, cells: np.ndarray) -> tuple[float, float]:
        C = strain.eval(self._mesh, cells).reshape(-1, 3, 3)
        squares = np.full((len(C), 3), np.nan)
        finite = np.isfinite(C).all(axis=(1, 2))
        squares[finite] = np.linalg.eigvalsh(C[finite])
        return float(np.sqrt(max(self._smallest(squares), 0.0))), float(np.sqrt(max(-self._smallest(-squares), 0.0)))

    def exceeded(self) -> str | None:
        """The limit that the deformation exceeds, as a reason; None if it exceeds none."""
        if not self.smallest_of_cells() > 0:
            return "a cell is turned inside out"
        limited = [one for one in self._materials if one.law.limits != (0.0, np.inf)]
        for name, law, cells, strain in limited:
            assert strain is not None
            least, most = law.limits
            for kind, stretch in zip(("compressed", "extended"), self._extremes(strain, cells), strict=True):
                if not least <= stretch <= most:
                    bound = f"below {least:.4f}" if stretch < least else f"above {most:.4f}"
                    what = "the rubber" if name == "rubber" else f"the material {name}"
                    return (
                        f"{what} is {kind} to a stretch of {stretch:.4f}, {bound}, where its law has no answer; "
                        "use the law neo-hookean or yeoh for such stretches"
                    )
        return None

    def beyond_data(self) -> dict[str, tuple[tuple[float, float], bool]]:
        """Extreme stretches by material whose law names those of its data, and whether they exceed these."""
        extremes = {}
        for name, law, cells, strain in self._materials:
            if law.stretches is not None and strain is not None:
                low, high = self._extremes(strain, cells)
                extremes[name] = (low, high), not (law.stretches[0] <= low and high <= law.stretches[1])
        return extremes
