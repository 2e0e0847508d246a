"""Factors of a symmetric matrix: Newton's method solves with them, and their inertia decides stability.

A matrix of one rank is taken for definite first, which all but few are: CHOLMOD's supernodal Cholesky then takes two
thirds of the time and has no negative pivot. If that fails, and over several ranks, MUMPS makes LDL^T and counts them.

Loads that follow the plates add a matrix of low rank, which is not symmetric: A - B C^T, solved by Woodbury's formula,

    (A - B C^T)^-1 b = z + Z (1 - C^T Z)^-1 C^T z,    z = A^-1 b,    Z = A^-1 B.
"""

from functools import cached_property

import numpy as np
from petsc4py import PETSc

from fingerfem.discretisation.loads.plate_loads import LowRank

SINGULAR = 1e14  # condition of the small matrix beyond which it has no inverse [-]


class _Upper:
    """The upper triangle of a symmetric matrix of one rank, as a matrix of its own.

    CHOLMOD takes that as it is. PETSc 3.22 would make it a copy of a whole matrix, and leave that behind in memory
    wherever the matrix is not definite (tests/fingerfem/equilibrium/test_memory.py).
    """

    def __init__(self, whole: PETSc.Mat):
        self._whole = whole
        starts, columns, values = whole.getValuesCSR()
        rows = np.repeat(np.arange(len(starts) - 1), np.diff(starts))
        self._kept = np.flatnonzero(columns >= rows)
        counts = np.bincount(rows[self._kept], minlength=len(starts) - 1)
        self._starts = np.concatenate([[0], np.cumsum(counts)]).astype(starts.dtype)
        self._columns = columns[self._kept]
        pattern = self._starts, self._columns, values[self._kept]
        self.matrix = PETSc.Mat().createSBAIJ(whole.getSize(), 1, csr=pattern, comm=whole.comm)

    def follow(self) -> None:
        """Have the whole matrix' entries of now."""
        values = self._whole.getValuesCSR()[2][self._kept]
        self.matrix.setValuesCSR(self._starts, self._columns, values)
        self.matrix.assemble()


class _Factors:
    """Factors by one package, made again and again.

    Args:
        matrix: symmetric; its pattern stays.
        package: `cholmod`, for definite matrices of one rank, or `mumps`.
    """

    def __init__(self, matrix: PETSc.Mat, package: str):
        self._matrix, self._package = matrix, package
        self.ksp = PETSc.KSP().create(matrix.comm)
        self.ksp.setType("preonly")
        self.ksp.setErrorIfNotConverged(False)
        self._prepare()

    def _prepare(self) -> None:
        preconditioner = self.ksp.getPC()
        preconditioner.reset()
        preconditioner.setType("cholesky")
        preconditioner.setFactorSolverType(self._package)
        self.ksp.setOperators(self._matrix)
        preconditioner.setFactorSetUpSolverType()
        self._factors = preconditioner.getFactorMatrix()
        if self._package == "mumps":
            self._factors.setMumpsIcntl(14, 80)  # room for the fill that pivoting adds [%]
            self._factors.setMumpsIcntl(13, 1)  # no ScaLAPACK at the root, whose negative pivots are not counted

    def make(self) -> str | None:
        """Factorise; returns why that failed, None if it did not (collective)."""
        self.ksp.setOperators(self._matrix)  # or PETSc would put the factorisation off to the next solve
        try:
            self.ksp.setUp()
        except PETSc.Error as error:
            if error.__cause__ is not None:
                raise error.__cause__ from None  # no failure: what a signal's handler raised meanwhile, such as Ctrl-C
            reason = f"PETSc error {error.ierr}"
        else:
            if self.ksp.getPC().getFailedReason() == PETSc.PC.FailedReason.NOERROR:
                return None
            reason = f"MUMPS error {self._factors.getMumpsInfog(1)}"
        self._prepare()  # factors that failed once would refuse every later matrix
        return f"factorisation failed ({reason})"

    @property
    def negative_pivots(self) -> int:
        """Negative eigenvalues of the matrix (Sylvester)."""
        return self._factors.getMumpsInfog(12) if self._package == "mumps" else 0


class Factorisation:
    """The factors of one matrix, made again by `update` whenever its entries have changed.

    Args:
        matrix: symmetric, not necessarily definite; its pattern stays.
    """

    def __init__(self, matrix: PETSc.Mat):
        self.matrix, self.made = matrix, 0  # number of factorisations
        self._low_rank: LowRank | None = None
        self._current: _Factors | None = None

    @cached_property
    def _may_be_definite(self) -> bool:
        return self.matrix.comm.size == 1 and bool(PETSc.Sys.hasExternalPackage("cholmod"))

    @cached_property
    def _upper(self) -> _Upper:
        return _Upper(self.matrix)

    @cached_property
    def _definite(self) -> _Factors:
        options = PETSc.Options()
        options.setValue("mat_cholmod_factor", "supernodal")  # LL^T, which fails where a matrix is not definite
        options.setValue("mat_cholmod_print", 0)  # and says no word of it
        return _Factors(self._upper.matrix, "cholmod")

    def _is_definite(self) -> bool:
        """Tries to factorise it as definite; True if that succeeds."""
        if not self._may_be_definite:
            return False
        self._upper.follow()
        return self._definite.make() is None

    @cached_property
    def _any(self) -> _Factors:
        return _Factors(self.matrix, "mumps")

    def update(self, low_rank: LowRank | None = None) -> str | None:
        """Factorise; returns why that failed, None if it did not (collective).

        Args:
            low_rank: what is taken from the matrix, B C^T.
        """
        self.made += 1
        if self._is_definite():
            self._current = self._definite
        else:
            self._current = self._any
            reason = self._any.make()
            if reason is not None:
                return reason
        self._low_rank = low_rank if low_rank is not None and len(low_rank.left) else None
        return self._correct() if self._low_rank is not None else None

    def _correct(self) -> str | None:
        """Prepare Woodbury's formula; returns why that fails."""
        assert self._low_rank is not None and self._current is not None
        right_hand_side, solution = self.matrix.createVecLeft(), self.matrix.createVecRight()
        solved = []
        for column in self._low_rank.left:
            right_hand_side.array[:] = column
            self._current.ksp.solve(right_hand_side, solution)
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
        assert self._current is not None
        self._current.ksp.solve(right_hand_side, solution)
        if self._low_rank is not None:
            amounts = self._small @ self._projected(solution.array_r)[0]
            solution.array[:] += amounts @ self._solved

    @property
    def negative_pivots(self) -> int:
        """Negative eigenvalues of the last factorised matrix."""
        assert self._current is not None
        return self._current.negative_pivots
