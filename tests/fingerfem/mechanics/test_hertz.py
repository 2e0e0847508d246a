"""A ball pressed into a block: Hertz's force and largest pressure."""

import dolfinx
import numpy as np
import pytest
import ufl
from dolfinx import fem
from dolfinx.fem.petsc import apply_lifting, assemble_matrix, assemble_vector, set_bc
from mpi4py import MPI
from petsc4py import PETSc

from fingerfem.mechanics import contact, obstacles, strain_energy
from fingerfem.scene.laws import neo_hookean_from
from fingerfem.scene.obstacle import Obstacle

E, NU = 1e6, 0.3  # [Pa], [-]
RADIUS, TOUCH = 0.5, 1e-3  # of the ball, of the contact [m]: strains are so small that the law does not matter
DEEP = 120 * TOUCH  # the block, which is all but a half space [m]
CELLS = 24  # along each edge


def graded(t: np.ndarray) -> np.ndarray:
    """From [0, 1] to [0, 1], with small cells at 0."""
    strength = 6.6  # the smallest cell is a twentieth of the contact
    return (np.exp(strength * t) - 1) / (np.exp(strength) - 1)


@pytest.mark.long
def test_a_ball_on_a_block_presses_as_hertz_says():
    """A quarter of the block [0, D] x [-D, 0] x [0, D]; the ball comes from above, at x = z = 0."""
    mesh = dolfinx.mesh.create_unit_cube(MPI.COMM_SELF, CELLS, CELLS, CELLS, dolfinx.mesh.CellType.hexahedron)
    mesh.geometry.x[:] = DEEP * graded(mesh.geometry.x)
    mesh.geometry.x[:, 1] *= -1
    space = fem.functionspace(mesh, ("Lagrange", 1, (3,)))
    u, v, w = fem.Function(space), ufl.TestFunction(space), ufl.TrialFunction(space)
    law = neo_hookean_from(E, NU)
    C = (ufl.Identity(3) + ufl.grad(u)).T * (ufl.Identity(3) + ufl.grad(u))
    energy = strain_energy.energy(law)(C) * ufl.dx(metadata={"quadrature_degree": 2})
    top = dolfinx.mesh.locate_entities_boundary(mesh, 2, lambda x: x[1] > -1e-12)
    tags = dolfinx.mesh.meshtags(mesh, 2, np.sort(top), np.full(len(top), 1, np.int32))
    ds = ufl.Measure("ds", mesh, subdomain_data=tags, metadata=contact.quadrature(1))(1)
    ball = Obstacle(shape="sphere", centre=[0.0, RADIUS, 0.0], radius=RADIUS, distance=[1e-9, 1.0], method="penalty")
    d = fem.Constant(mesh, 0.0)
    gap, *_ = contact.gap(obstacles.body(ball, 1.0), u, ufl.SpatialCoordinate(mesh), d, obstacles.in_ufl(float))
    smallest = DEEP * graded(np.array([1 / CELLS]))[0]
    gamma = contact.stiffness(2000.0, E, smallest)
    energy += contact.energy(gap, gamma) * ds
    residual = ufl.derivative(energy, u, v)
    forms = fem.form(residual), fem.form(ufl.derivative(residual, u, w))
    p = contact.pressure(gap, gamma)
    force, nodal = fem.form(p * ds), [fem.form(value * v[1] * ds) for value in (p, 1.0)]
    supports = []
    for axis, side in ((0, 0.0), (2, 0.0), (1, -DEEP)):
        facets = dolfinx.mesh.locate_entities_boundary(mesh, 2, lambda x, a=axis, c=side: abs(x[a] - c) < 1e-12)
        dofs = fem.locate_dofs_topological(space.sub(axis), 2, facets)
        supports.append(fem.dirichletbc(0.0, dofs, space.sub(axis)))
    depth = TOUCH**2 / RADIUS
    for d.value in -depth * np.array([0.5, 1.0]):
        for _ in range(30):
            matrix = assemble_matrix(forms[1], bcs=supports)
            matrix.assemble()
            b = assemble_vector(forms[0])
            apply_lifting(b, [forms[1]], [supports], [u.x.petsc_vec], -1.0)
            set_bc(b, supports, u.x.petsc_vec, -1.0)
            norm = b.norm()
            if norm < 3e-9 * E * TOUCH**2:
                break
            ksp = PETSc.KSP().create(MPI.COMM_SELF)
            ksp.setOperators(matrix)
            ksp.setType("preonly")
            ksp.getPC().setType("lu")
            ksp.getPC().setFactorSolverType("mumps")
            step = matrix.createVecRight()
            ksp.solve(-b, step)
            u.x.petsc_vec.axpy(1.0, step)
            u.x.scatter_forward()
        assert norm < 3e-9 * E * TOUCH**2
    modulus = E / (1 - NU**2)
    found = 4 * fem.assemble_scalar(force)
    # The block ends where a half space would have sunk by what Boussinesq says of a point force.
    sunk = (1 + NU) * (3 - 2 * NU) * found / (2 * np.pi * E * DEEP)
    assert found == pytest.approx(4 / 3 * modulus * np.sqrt(RADIUS) * (depth + sunk) ** 1.5, rel=0.01)
    forces, area = (assemble_vector(form).array.reshape(-1, 3)[:, 1] for form in nodal)
    largest = np.max(forces / np.where(area > 0, area, np.inf))
    assert largest == pytest.approx((6 * found * modulus**2 / (np.pi**3 * RADIUS**2)) ** (1 / 3), rel=0.02)
