"""The tangent at one displacement, factorised: what predicts the next state, differentiates this one, and judges it."""

from functools import cached_property

import numpy as np
from petsc4py import PETSc

from fingerfem.equilibrium.factorisation import Factorisation
from fingerfem.equilibrium.stability import AntisymmetricMotion


class Linearisation:
    """Factorised tangent at an equilibrium; valid until the next one is factorised.

    Attributes:
        negative_pivots: number of negative eigenvalues of the tangent (Sylvester's law of inertia).
    """

    def __init__(self, factorisation: Factorisation, antisymmetric: AntisymmetricMotion):
        self._factorisation, self._antisymmetric = factorisation, antisymmetric
        self._made = factorisation.made
        self.negative_pivots = factorisation.negative_pivots

    def solve(self, right_hand_side: PETSc.Vec) -> np.ndarray:
        """Solve with the tangent; returns owned values, shape (3 owned nodes,), and destroys the right-hand side.

        Raises:
            RuntimeError: another tangent has been factorised since.
        """
        if self._made != self._factorisation.made:
            raise RuntimeError("a linearisation must be used before the next tangent is factorised")
        solution = right_hand_side.duplicate()
        self._factorisation.solve(right_hand_side, solution)
        values = solution.array_r.copy()
        solution.destroy()
        right_hand_side.destroy()
        return values

    @cached_property
    def stable(self) -> bool:
        """True if the potential has a minimum here, against motions of the whole finger (collective)."""
        return self.negative_pivots == 0 and not self._antisymmetric.gives_way()
