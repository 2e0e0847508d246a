"""Viscoelastic branches of the rubber: overstresses Q_k that follow the elastic stress and relax.

With S the second Piola-Kirchhoff stress of the law's distortional part, a modulus g_k over that part's own, and a time
tau_k, a branch obeys

    dQ_k/dt + Q_k / tau_k = g_k dS/dt

(Simo, Comput. Methods Appl. Mech. Eng. 60, 1987, doi:10.1016/0045-7825(87)90107-1; Holzapfel, Nonlinear Solid
Mechanics, 2000, section 6.10). For an S that is linear in a step of size h, x = h / tau_k, this is exact:

    Q_k(h) = exp(-x) Q_k + g_k phi(x) (S(h) - S),    phi(x) = (1 - exp(-x)) / x.

The law is the limit of slow loads. At once the distortional stress is 1 + sum of g_k times as large.
"""

from collections.abc import Sequence

import basix.ufl
import numpy as np
from dolfinx import fem

from fingerfem.discretisation import form_cache, regions
from fingerfem.discretisation.mesh import FingerMesh
from fingerfem.discretisation.tangent import gauss
from fingerfem.discretisation.volume_energies import Overstress, constants
from fingerfem.mechanics import kinematics, strain_energy
from fingerfem.scene.laws import Law


def overstress_of(laws: Sequence[Law], mesh: FingerMesh, degree: int) -> Overstress | None:
    """The fields through which branches act, zero at first; None of laws without any."""
    if all(law.prony is None for law in laws):
        return None
    points = basix.ufl.quadrature_element(mesh.mesh.basix_cell(), (3, 3), "default", degree)
    shares = [fem.Constant(mesh.mesh, 0.0) for _ in laws]
    return Overstress(shares, fem.Function(fem.functionspace(mesh.mesh, points)))


class Branches:
    """The branches of a finger's materials, all relaxed at first.

    Args:
        laws: of the materials, one with branches at least.
        mesh: with its regions.
        u: displacement [m].
        overstress: the fields through which they act.
        degree: of the Gauss rule that integrates the laws' energies.

    Attributes:
        stresses: Q_k of this rank's cells, zero where a material has no branch k, shape (branches, cells, points, 3, 3)
            [Pa].
    """

    def __init__(self, laws: Sequence[Law], mesh: FingerMesh, u: fem.Function, overstress: Overstress, degree: int):
        points, self._mesh, self._fields = gauss(degree)[0], mesh.mesh, overstress
        self._shape = len(mesh.midpoints.T), len(points), 3, 3
        most = max(len(law.prony or []) for law in laws)
        self._moduli, self._times = np.zeros((most, self._shape[0])), np.ones((most, self._shape[0]))
        self._parts: list[tuple[int, fem.Expression, np.ndarray]] = []  # material, its S, its cells
        for k, law in enumerate(laws):
            cells = mesh.cells.indices[np.isin(mesh.cells.values, regions.of_material(k))]
            if law.prony is None or not cells.size:
                continue
            distortional, _ = strain_energy.parts(law, constants(mesh.mesh))
            S = strain_energy.stress(distortional, kinematics.right_cauchy_green(u))
            self._parts.append((k, form_cache.expression(S, points), cells))
            own = np.array(law.prony)[:, :, None]
            self._moduli[: len(own), cells], self._times[: len(own), cells] = own[:, 0], own[:, 1]
        self._before = np.zeros(self._shape)
        self.stresses = np.zeros((most, *self._shape))

    def elastic_stress(self) -> np.ndarray:
        """S at the displacement of now where there are branches, shape (cells, points, 3, 3) [Pa]."""
        stresses = np.zeros(self._shape)
        for _, expression, cells in self._parts:
            stresses[cells] = expression.eval(self._mesh, cells).reshape(-1, *self._shape[1:])
        return stresses

    def stay(self) -> None:
        """Have the forms take the overstress as it is now, whatever the displacement."""
        self._act(np.zeros(self._shape[0]), self.stresses.sum(axis=0))

    def begin(self, step: float) -> None:
        """Have the forms take the overstress at the end of a step [s] that begins at the displacement of now."""
        self._before = self.elastic_stress()
        kept, shares = self._factors(step)
        relaxed = (kept[..., None, None, None] * self.stresses).sum(axis=0)
        self._act(shares.sum(axis=0), relaxed - shares.sum(axis=0)[:, None, None, None] * self._before)

    def settle(self, step: float) -> None:
        """Take the displacement of now for the end of that step."""
        kept, shares = (factor[..., None, None, None] for factor in self._factors(step))
        self.stresses = kept * self.stresses + shares * (self.elastic_stress() - self._before)
        self.stay()

    def _factors(self, step: float) -> tuple[np.ndarray, np.ndarray]:
        """exp(-x) and g phi(x), shapes (branches, cells) [-]."""
        x = step / self._times
        return np.exp(-x), self._moduli * (-np.expm1(-x) / x if step else 1.0)

    def _act(self, shares: np.ndarray, stress: np.ndarray) -> None:
        for k, _, cells in self._parts:
            self._fields.shares[k].value = shares[cells[0]]
        self._fields.stress.x.array[:] = stress.ravel()
