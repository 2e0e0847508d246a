"""Vectors and numbers assembled over the ranks that share one finger."""

import numpy as np
from dolfinx import fem
from dolfinx.fem.petsc import assemble_vector
from mpi4py import MPI
from petsc4py import PETSc


class Assembly:
    """Assembly of forms of one space of displacements (all methods are collective).

    Args:
        space: of the displacement.
        copies: of what is modelled, in the whole finger.
        held: owned indices of the unknowns that supports hold.
    """

    def __init__(self, space: fem.FunctionSpace, copies: int, held: np.ndarray):
        self.space, self.copies, self.held = space, copies, held
        self.comm: MPI.Comm = space.mesh.comm

    def vector(self, form: fem.Form, besides: np.ndarray | None = None) -> PETSc.Vec:
        """A linear form and what else there is at this rank's nodes. The caller destroys the vector.

        Args:
            form: linear.
            besides: to be summed over ranks with it, shape (nodes, 3), ghosts included.
        """
        b = assemble_vector(form)
        if besides is not None:
            with b.localForm() as local:
                local.array[:] += besides.ravel()
        b.ghostUpdate(addv=PETSc.InsertMode.ADD, mode=PETSc.ScatterMode.REVERSE)
        return b

    def gradient(self, form: fem.Form, besides: np.ndarray | None = None) -> PETSc.Vec:
        """The same, zero where held."""
        b = self.vector(form, besides)
        b.array[self.held] = 0.0
        return b

    def nodal(self, form: fem.Form, besides: np.ndarray | None = None) -> np.ndarray:
        """The same at this rank's nodes, ghosts included, shape (nodes, 3)."""
        holder = fem.Function(self.space)
        b = self.vector(form, besides)
        holder.x.array[: b.local_size] = b.array_r
        b.destroy()
        holder.x.scatter_forward()
        return holder.x.array.reshape(-1, 3)

    def scalar(self, form: fem.Form) -> float:
        """A scalar form over all ranks, of the whole finger."""
        return self.summed(fem.assemble_scalar(form))

    def summed(self, own: float) -> float:
        """A rank's own part of a number over all ranks, of the whole finger."""
        return self.copies * float(self.comm.allreduce(own))
