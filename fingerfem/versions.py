"""Versions of software that a number depends on, besides the scene."""

import dolfinx
from petsc4py import PETSc

import fingerfem


def versions() -> dict[str, str]:
    """Versions by name of software."""
    petsc = ".".join(map(str, PETSc.Sys.getVersion()))
    return {"fingerfem": fingerfem.__version__, "dolfinx": dolfinx.__version__, "petsc": petsc}
