"""LDL^T of a symmetric matrix by MUMPS: what Newton's method solves with, and what tells whether a state is stable.

Loads that follow the plates add a matrix of low rank, which is not symmetric: A - B C^T, solved by Woodbury's formula,

    (A - B C^T)^-1 b = z + Z (1 - C^T Z)^-1 C^T z,    z = A^-1 b,    Z = A^-1 B.
"""

from __future__ import annotations

import numpy as np
from petsc4py import PETSc

from fingerfem.discretisation.plate_loads import LowRank

SINGULAR = 1e14  # condition of the small matrix beyond which it has no inverse [-]


class Factorisation:
    """The factors of one matrix, made again by `update` whenever its entries have changed.

    Args:
        matrix: symmetric, not necessarily definite; its pattern stays.
    """

    def __init__(self, matrix: PETSc.Mat):
        self.matrix, self.made = matrix, 0  # how often the factors were made
        self._low_rank: LowRank | None = None
        self._ksp = PETSc.KSP().create(matrix.comm)
        self._ksp.setType("preonly")
        self._ksp.setErrorIfNotConverged(False)
        self._prepare()

    def _prepare(self) -> None:
        preconditioner = self._ksp.getPC()
        preconditioner.reset()
        preconditioner.setType("cholesky")
        preconditioner.setFactorSolverType("mumps")
        self._ksp.setOperators(self.matrix)
        preconditioner.setFactorSetUpSolverType()
        self._factors = preconditioner.getFactorMatrix()
        self._factors.setMumpsIcntl(14, 80)  # room for the fill that pivoting adds [%]
        self._factors.setMumpsIcntl(13, 1)  # no ScaLAPACK at the root, whose negative pivots are not counted

    def update(self, low_rank: LowRank | None = None) -> str | None:
        """Factorise; returns why that failed, None if it did not (collective).

        Args:
            low_rank: what is taken from the matrix, B C^T.
        """
        self._ksp.setOperators(self.matrix)  # or PETSc would put the factorisation off to the next solve
        self.made += 1
        reason = None
        try:
            self._ksp.setUp()
        except PETSc.Error as error:
            reason = f"factorisation failed (PETSc error {error.ierr})"
        else:
            if self._ksp.getPC().getFailedReason() != PETSc.PC.FailedReason.NOERROR:
                reason = f"factorisation failed (MUMPS error {self._factors.getMumpsInfog(1)})"
        if reason is not None:
            self._prepare()  # factors that failed once would refuse every later matrix
            return reason
        self._low_rank = low_rank if low_rank is not None and len(low_rank.left) else None
        return self._correct() if self._low_rank is not None else None

    def _correct(self) -> str | None:
        """Prepare Woodbury's formula; returns why that fails."""
        assert self._low_rank is not None
        right_hand_side, solution = self.matrix.createVecLeft(), self.matrix.createVecRight()
        solved = []
        for column in self._low_rank.left:
            right_hand_side.array[:] = column
            self._ksp.solve(right_hand_side, solution)
            solved.append(solution.array_r.copy())
        right_hand_side.destroy()
        solution.destroy()
        self._solved = np.array(solved)
        small = np.eye(len(solved)) - self._projected(self._solved).T
        if not np.isfinite(small).all() or np.linalg.cond(small) > SINGULAR:
            return "the tangent with its following loads is singular"
        self._small = np.linalg.inv(small)
        return None

    def _projected(self, values: np.ndarray) -> np.ndarray:
        """C^T of vectors, this rank's values in rows; shape (vectors, rank)."""
        assert self._low_rank is not None
        comm = self.matrix.comm.tompi4py()
        return np.asarray(comm.allreduce(np.atleast_2d(values) @ self._low_rank.right.T))

    def solve(self, right_hand_side: PETSc.Vec, solution: PETSc.Vec) -> None:
        """Solve with the last factors."""
        self._ksp.solve(right_hand_side, solution)
        if self._low_rank is not None:
            amounts = self._small @ self._projected(solution.array_r)[0]
            solution.array[:] += amounts @ self._solved

    @property
    def negative_pivots(self) -> int:
        """Negative eigenvalues of the last factorised matrix (Sylvester)."""
        return self._factors.getMumpsInfog(12)
