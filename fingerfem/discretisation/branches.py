"""Viscoelastic branches of the rubber: overstresses Q_k that follow the elastic stress and relax.

With S the second Piola-Kirchhoff stress of the law's distortional part, a modulus g_k over that part's own, and a time
tau_k, a branch obeys

    dQ_k/dt + Q_k / tau_k = g_k dS/dt

(Simo, Comput. Methods Appl. Mech. Eng. 60, 1987, doi:10.1016/0045-7825(87)90107-1; Holzapfel, Nonlinear Solid
Mechanics, 2000, section 6.10). For an S that is linear in a step of size h, x = h / tau_k, this is exact:

    Q_k(h) = exp(-x) Q_k + g_k phi(x) (S(h) - S),    phi(x) = (1 - exp(-x)) / x.

The law is the limit of slow loads. At once the distortional stress is 1 + sum of g_k times as large.
"""

from __future__ import annotations

import basix.ufl
import numpy as np
from dolfinx import fem

from fingerfem.discretisation import form_cache, regions
from fingerfem.discretisation.mesh import FingerMesh
from fingerfem.discretisation.tangent import gauss
from fingerfem.discretisation.volume_energies import Overstress, constants
from fingerfem.mechanics import kinematics, strain_energy
from fingerfem.scene.laws import Law


def overstress_of(law: Law, mesh: FingerMesh, degree: int) -> Overstress | None:
    """The fields through which branches act, zero at first; None of a law without any."""
    if law.prony is None:
        return None
    points = basix.ufl.quadrature_element(mesh.mesh.basix_cell(), (3, 3), "default", degree)
    return Overstress(fem.Constant(mesh.mesh, 0.0), fem.Function(fem.functionspace(mesh.mesh, points)))


class Branches:
    """The branches of a finger's rubber, all relaxed at first.

    Args:
        law: with branches.
        mesh: with its regions.
        u: displacement [m].
        overstress: the fields through which they act.
        degree: of the Gauss rule that integrates the law's energy.

    Attributes:
        stresses: Q_k of this rank's cells, zero in plates, shape (branches, cells, points, 3, 3) [Pa].
    """

    def __init__(self, law: Law, mesh: FingerMesh, u: fem.Function, overstress: Overstress, degree: int):
        assert law.prony is not None
        self._share, self._times = np.array(law.prony).T
        self._mesh, self._fields = mesh.mesh, overstress
        points = gauss(degree)[0]
        distortional, _ = strain_energy.parts(law, constants(mesh.mesh))
        S = strain_energy.stress(distortional, kinematics.right_cauchy_green(u))
        self._expression = form_cache.expression(S, points)
        self._cells = mesh.cells.indices[np.isin(mesh.cells.values, regions.RUBBERS)]
        self._shape = len(mesh.midpoints.T), len(points), 3, 3
        self._before = np.zeros(self._shape)
        self.stresses = np.zeros((len(self._times), *self._shape))

    def elastic_stress(self) -> np.ndarray:
        """S at the displacement of now, shape (cells, points, 3, 3) [Pa]."""
        found = np.zeros(self._shape)
        found[self._cells] = self._expression.eval(self._mesh, self._cells).reshape(-1, *self._shape[1:])
        return found

    def stay(self) -> None:
        """Have the forms take the overstress as it is now, whatever the displacement."""
        self._act(0.0, self.stresses.sum(axis=0))

    def begin(self, step: float) -> None:
        """Have the forms take the overstress at the end of a step [s] that begins at the displacement of now."""
        self._before = self.elastic_stress()
        kept, shares = self._factors(step)
        self._act(shares.sum(), np.tensordot(kept, self.stresses, 1) - shares.sum() * self._before)

    def settle(self, step: float) -> None:
        """Take the displacement of now for the end of that step."""
        kept, shares = self._factors(step)
        change = self.elastic_stress() - self._before
        self.stresses = kept[:, None, None, None, None] * self.stresses + np.multiply.outer(shares, change)
        self.stay()

    def _factors(self, step: float) -> tuple[np.ndarray, np.ndarray]:
        """exp(-x) and g phi(x), shape (branches,) [-]."""
        x = step / self._times
        return np.exp(-x), self._share * (-np.expm1(-x) / x if step else 1.0)

    def _act(self, share: float, stress: np.ndarray) -> None:
        self._fields.share.value = share
        self._fields.stress.x.array[:] = stress.ravel()
