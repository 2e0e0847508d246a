"""Whether a deformation is one that cells and law allow, and the volume ratio that the law sees."""

from __future__ import annotations

import numpy as np
import ufl
from dolfinx import fem
from mpi4py import MPI

from fingerfem.discretisation import form_cache, regions
from fingerfem.discretisation.mesh import FingerMesh
from fingerfem.discretisation.tangent import gauss
from fingerfem.mechanics import kinematics
from fingerfem.scene.laws import Law

THIRDS = (0, 0.5, 1)
CORNERS = np.array([[i, j, k] for i in THIRDS for j in THIRDS for k in THIRDS], float)  # midpoints and centre, too


class DeformationLimits:
    """Volume ratios and stretches of a finger's cells (all methods are collective).

    Args:
        law: of the rubber.
        mesh: with its regions.
        u: displacement [m].
        degree: of the Gauss rule that integrates the energy.
    """

    def __init__(self, law: Law, mesh: FingerMesh, u: fem.Function, degree: int):
        self._law, self._mesh, self._comm = law, mesh.mesh, mesh.mesh.comm
        owned = mesh.mesh.topology.index_map(mesh.mesh.topology.dim).size_local
        self._cells = np.arange(owned, dtype=np.int32)
        rubber = np.unique(np.concatenate([mesh.cells.find(region) for region in regions.RUBBERS]))
        self._rubber = rubber[rubber < owned].astype(np.int32)
        self._others = np.setdiff1d(self._cells, self._rubber)
        F = kinematics.deformation_gradient(u)
        self._ratio = form_cache.expression(ufl.det(F), CORNERS)
        self._pressed = form_cache.expression(ufl.det(F), gauss(degree - 1)[0]) if law.is_mixed else None
        is_limited = law.limits != (0.0, np.inf) or law.stretches is not None
        self._strain = form_cache.expression(F.T * F, gauss(degree)[0]) if is_limited else None

    def _smallest(self, values: np.ndarray) -> float:
        return float(self._comm.allreduce(values.min() if values.size else np.inf, op=MPI.MIN))

    def smallest_of_cells(self) -> float:
        """Min J = det F over corners, midpoints and centres of all cells [-]."""
        return self._smallest(self._ratio.eval(self._mesh, self._cells))

    def smallest_of_law(self) -> float:
        """The same, but of rubber with a pressure of its own at the points of that pressure [-]."""
        if self._pressed is None:
            return self.smallest_of_cells()
        rubber = self._smallest(self._pressed.eval(self._mesh, self._rubber))
        return min(rubber, self._smallest(self._ratio.eval(self._mesh, self._others)))

    def extreme_stretches(self) -> tuple[float, float] | None:
        """Least and largest principal stretch at the rubber's points of integration [-].

        None of a law without limits that names no stretches of its data.
        """
        if self._strain is None:
            return None
        C = np.linalg.eigvalsh(self._strain.eval(self._mesh, self._rubber).reshape(-1, 3, 3))
        return np.sqrt(max(self._smallest(C), 0.0)), np.sqrt(max(-self._smallest(-C), 0.0))

    def exceeded(self) -> str | None:
        """The limit that the deformation exceeds, as a reason; None if it exceeds none."""
        if not self.smallest_of_cells() > 0:
            return "a cell is turned inside out"
        if self._law.limits == (0.0, np.inf):
            return None
        least, most = self._law.limits
        for kind, stretch in zip(("compressed", "extended"), self.extreme_stretches() or (), strict=False):
            if not least <= stretch <= most:
                bound = f"below {least:.4f}" if stretch < least else f"above {most:.4f}"
                return (
                    f"the rubber is {kind} to a stretch of {stretch:.4f}, {bound}, where its law has no answer; "
                    "use the law neo-hookean or yeoh for such stretches"
                )
        return None
