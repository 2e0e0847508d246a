"""Factors of matrices that are not definite, and Ctrl-C while PETSc finds out."""

import signal

import numpy as np
import pytest
import scipy.sparse as sp
from petsc4py import PETSc

from fingerfem.equilibrium.factorisation import Factorisation


class Stopped(BaseException):
    """Exception that the handler raises."""


@pytest.fixture(scope="module")
def indefinite():
    """The Laplacian of a cube without half its diagonal: one negative eigenvalue at least."""
    side = 30
    one, line = sp.eye(side), sp.diags([-np.ones(side - 1), 2 * np.ones(side), -np.ones(side - 1)], [-1, 0, 1])
    cube = sp.kron(sp.kron(line, one), one) + sp.kron(sp.kron(one, line), one) + sp.kron(sp.kron(one, one), line)
    rows = (cube - 0.5 * sp.eye(side**3)).tocsr()
    rows.sort_indices()
    return PETSc.Mat().createAIJ(rows.shape, csr=(rows.indptr, rows.indices, rows.data))


def test_a_signal_during_a_factorisation_that_fails_is_not_lost(indefinite):
    def stop(*_):
        raise Stopped

    factors = Factorisation(indefinite)
    assert not factors._is_definite()
    before = signal.signal(signal.SIGALRM, stop)
    try:
        with pytest.raises(Stopped):
            for _ in range(20):
                signal.setitimer(signal.ITIMER_REAL, 0.02)  # [s], a part of what PETSc needs
                factors._is_definite()
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, before)
