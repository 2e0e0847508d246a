"""LDL^T of a symmetric matrix by MUMPS: what Newton's method solves with, and what tells whether a state is stable."""

from __future__ import annotations

from petsc4py import PETSc


class Factorisation:
    """The factors of one matrix, made again by `update` whenever its entries have changed.

    Args:
        matrix: symmetric, not necessarily definite; its pattern stays.
    """

    def __init__(self, matrix: PETSc.Mat):
        self.matrix, self.made = matrix, 0  # how often the factors were made
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

    def update(self) -> str | None:
        """Factorise; returns why that failed, None if it did not (collective)."""
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

    def solve(self, right_hand_side: PETSc.Vec, solution: PETSc.Vec) -> None:
        """Solve with the last factors."""
        self._ksp.solve(right_hand_side, solution)

    @property
    def negative_pivots(self) -> int:
        """Negative eigenvalues of the last factorised matrix (Sylvester)."""
        return self._factors.getMumpsInfog(12)
