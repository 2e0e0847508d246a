"""Homogeneous states of a block, from scalar equations for the stretches; the contact patch test."""

import dolfinx
import numpy as np
import pytest
import ufl
from dolfinx import fem
from dolfinx.fem.petsc import apply_lifting, assemble_matrix, assemble_vector
from mpi4py import MPI
from petsc4py import PETSc
from scipy.optimize import brentq
from unoptimised import unoptimised

from fingerfem.discretisation.volume_energies import residual_of, rubber_terms
from fingerfem.mechanics import contact, obstacles, strain_energy
from fingerfem.scene.laws import NeoHookean, SaintVenantKirchhoff, neo_hookean_from

LAW = NeoHookean(C1=1.9e6, D1=2.43e-7)
E = LAW.young_modulus
NEARLY_INCOMPRESSIBLE = neo_hookean_from(E, 0.4999)


@pytest.fixture(autouse=True)
def unoptimised_nitsche(request):
    if "nitsche" not in request.node.name:
        yield
        return
    with unoptimised():
        yield


def nominal_stress(stretches, i: int, law: NeoHookean = LAW) -> float:
    """P_i = dW/dl_i [Pa] of W = C1 (J^(-2/3) sum l^2 - 3) + (J - 1)^2 / D1, by hand."""
    l1, J, I1 = stretches[i], float(np.prod(stretches)), float(np.sum(np.square(stretches)))
    return law.C1 * J ** (-2 / 3) * (2 * l1 - 2 / 3 * I1 / l1) + 2 * (J - 1) / law.D1 * J / l1


class Block:
    """The cube [0, 1] x [-1/2, 1/2] x [0, 1], its inner nodes shifted at random, on rollers at x = 0, y = -1/2, z = 0.

    Args:
        order: of the displacements.
        moved: displacement [m] of other faces along their normal, by (axis, coordinate).
        plane: (method, stiffness, d) of an obstacle at y = 1/2 + d.
        law: of the block; with a pressure of its own the inner nodes stay, for its rule is exact on boxes alone.
    """

    def __init__(self, order=1, moved=None, plane=None, law=LAW):
        mesh = dolfinx.mesh.create_unit_cube(MPI.COMM_SELF, 3, 3, 3, dolfinx.mesh.CellType.hexahedron)
        x = mesh.geometry.x
        inner = np.all((x > 1e-9) & (x < 1 - 1e-9), axis=1)
        x[inner] += (not law.is_mixed) * np.random.default_rng(1).uniform(-0.08, 0.08, (inner.sum(), 3))
        x[:, 1] -= 0.5
        self.space = fem.functionspace(mesh, ("Lagrange", order, (3,)))
        self.u = fem.Function(self.space)
        v, w = ufl.TestFunction(self.space), ufl.TrialFunction(self.space)
        terms = rubber_terms([law], float, 2 * order if law.is_mixed else 4 * order)
        measures = [ufl.dx(mesh, metadata={"quadrature_degree": term.degree}) for term in terms]
        energies = [term.energy for term in terms]
        residual = residual_of(list(zip(energies, measures, strict=True)), self.u)
        if plane is not None:
            method, gamma, d = plane
            top = dolfinx.mesh.locate_entities_boundary(mesh, 2, lambda x: x[1] > 0.5 - 1e-9)
            tags = dolfinx.mesh.meshtags(mesh, 2, np.sort(top), np.full(len(top), 1, np.int32))
            ds = ufl.Measure("ds", mesh, subdomain_data=tags, metadata=contact.quadrature(order))(1)
            self.distance = fem.Constant(mesh, d)
            x, facing = ufl.SpatialCoordinate(mesh), obstacles.bodies(None, 0.5)[0]
            gap, normal, _ = contact.gap(facing, self.u, x, self.distance, obstacles.in_ufl(float))
            q = contact.surface_pressure(strain_energy.energy(LAW), self.u, ufl.FacetNormal(mesh), normal)
            q = q if method == "nitsche" else 0
            residual += ufl.derivative(contact.energy(gap, gamma, q) * ds, self.u, v)
            p = contact.pressure(gap, gamma, q)
            self.force, self.squared = fem.form(p * ds), fem.form(p**2 * ds)
        self.forms = fem.form(residual), fem.form(ufl.derivative(residual, self.u, w))
        self.supports = []
        for (axis, at), value in ({(0, 0.0): 0.0, (1, -0.5): 0.0, (2, 0.0): 0.0} | (moved or {})).items():
            side = dolfinx.mesh.locate_entities_boundary(mesh, 2, lambda x, a=axis, c=at: abs(x[a] - c) < 1e-9)
            dofs = fem.locate_dofs_topological(self.space.sub(axis), 2, side)
            self.supports.append(fem.dirichletbc(value, dofs, self.space.sub(axis)))

    def solve(self) -> np.ndarray:
        """Newton's method; returns the displacement at the nodes, shape (nodes, 3) [m]."""
        residual, tangent = self.forms
        ksp = PETSc.KSP().create(MPI.COMM_SELF)
        ksp.setType("preonly")
        ksp.getPC().setType("lu")
        for _ in range(40):
            A = assemble_matrix(tangent, bcs=self.supports)
            A.assemble()
            b = assemble_vector(residual)
            apply_lifting(b, [tangent], [self.supports], [self.u.x.petsc_vec], -1.0)
            for support in self.supports:
                support.set(b.array_w, self.u.x.array, -1.0)
            ksp.setOperators(A)
            change = b.duplicate()
            ksp.solve(b, change)
            self.u.x.array[:] -= change.array
            if np.abs(change.array).max() < 1e-13:
                return self.u.x.array.reshape(-1, 3)
        raise AssertionError("Newton's method did not converge")

    def reaction(self, axis: int, at: float) -> float:
        """Force that holds the face where it is [N]."""
        b = assemble_vector(self.forms[0]).array.reshape(-1, 3)
        return float(b[abs(self.space.tabulate_dof_coordinates()[:, axis] - at) < 1e-9, axis].sum())


def rest(block: Block) -> np.ndarray:
    return block.space.tabulate_dof_coordinates() + np.array([0.0, 0.5, 0.0])


@pytest.mark.parametrize("order", [1, pytest.param(2, marks=pytest.mark.long)])
@pytest.mark.parametrize("stretch", [0.7, 1.4])
def test_uniaxial_stretch(order, stretch):
    across = brentq(lambda t: nominal_stress([stretch, t, t], 1), 0.5, 1.5, xtol=1e-15)
    block = Block(order, {(0, 1.0): stretch - 1})
    expected = rest(block) * (np.array([stretch, across, across]) - 1)
    assert np.abs(block.solve() - expected).max() < 1e-10
    assert block.reaction(0, 1.0) == pytest.approx(nominal_stress([stretch, across, across], 0), rel=1e-10)


@pytest.mark.long
@pytest.mark.parametrize("order", [1, 2])
@pytest.mark.parametrize("stretch", [0.7, 1.4])
def test_uniaxial_stretch_of_nearly_incompressible_rubber(order, stretch):
    """With a pressure of its own, from one hundredth before the answer: the iteration here is Newton's plain one."""
    law = NEARLY_INCOMPRESSIBLE
    across = brentq(lambda t: nominal_stress([stretch, t, t], 1, law), 0.5, 1.5, xtol=1e-15)
    block = Block(order, {(0, 1.0): stretch - 1}, law=law)
    expected = rest(block) * (np.array([stretch, across, across]) - 1)
    block.u.x.array[:] = expected.ravel() * 0.99
    assert np.abs(block.solve() - expected).max() < 1e-10
    assert block.reaction(0, 1.0) == pytest.approx(nominal_stress([stretch, across, across], 0, law), rel=1e-8)


@pytest.mark.parametrize("stretch", [0.6, 0.8, 1.3])
def test_uniaxial_stretch_of_saint_venant_kirchhoff_rubber(stretch):
    """P = E (l^3 - l) / 2, with sides of t^2 = 1 - nu (l^2 - 1)."""
    law = SaintVenantKirchhoff(E=E, nu=0.3)
    across = np.sqrt(1 - law.nu * (stretch**2 - 1))
    block = Block(1, {(0, 1.0): stretch - 1}, law=law)
    assert np.abs(block.solve() - rest(block) * (np.array([stretch, across, across]) - 1)).max() < 1e-10
    assert block.reaction(0, 1.0) == pytest.approx(E * (stretch**3 - stretch) / 2, rel=1e-10)


@pytest.mark.parametrize("stretch", [0.7, 1.4])
def test_confined_stretch(stretch):
    block = Block(1, {(0, 1.0): stretch - 1, (1, 0.5): 0.0, (2, 1.0): 0.0})
    assert np.abs(block.solve() - rest(block) * [stretch - 1, 0, 0]).max() < 1e-10
    assert block.reaction(0, 1.0) == pytest.approx(nominal_stress([stretch, 1.0, 1.0], 0), rel=1e-10)
    assert block.reaction(1, 0.5) == pytest.approx(nominal_stress([stretch, 1.0, 1.0], 1), rel=1e-10)


@pytest.mark.parametrize("stretch", [0.8, 1.3])
def test_biaxial_stretch(stretch):
    across = brentq(lambda t: nominal_stress([stretch, stretch, t], 2), 0.3, 2.0, xtol=1e-15)
    block = Block(1, {(0, 1.0): stretch - 1, (1, 0.5): stretch - 1})
    assert np.abs(block.solve() - rest(block) * (np.array([stretch, stretch, across]) - 1)).max() < 1e-10
    assert block.reaction(0, 1.0) == pytest.approx(nominal_stress([stretch, stretch, across], 0), rel=1e-10)


@pytest.mark.parametrize(
    ("method", "order"),
    [
        ("penalty", 1),
        *(pytest.param(*one, marks=pytest.mark.long) for one in (("nitsche", 1), ("penalty", 2), ("nitsche", 2))),
    ],
)
def test_contact_patch(method, order):
    """Pressed by a tenth of its height the block is in uniaxial compression under a uniform pressure.

    Nitsche's method is consistent: the block ends at the plane whatever gamma is. By the penalty it ends where
    gamma times what it passes the plane is the stress there.
    """
    gamma, d = 400 * E, -0.1

    def across(stretch):
        return brentq(lambda t: nominal_stress([t, stretch, t], 0), 0.5, 1.5, xtol=1e-15)

    def pressure(stretch):
        return -nominal_stress([across(stretch), stretch, across(stretch)], 1)

    stretch = 1 + d
    if method == "penalty":
        stretch = brentq(lambda s: pressure(s) - gamma * (s - 1 - d), 0.9, 1.0, xtol=1e-15)
    block = Block(order, plane=(method, gamma, d))
    expected = rest(block) * (np.array([across(stretch), stretch, across(stretch)]) - 1)
    for block.distance.value in np.linspace(0, d, 6)[1:]:
        displacement = block.solve()
    assert np.abs(displacement - expected).max() < 1e-8
    assert fem.assemble_scalar(block.force) == pytest.approx(pressure(stretch), rel=1e-8)
    assert block.reaction(1, -0.5) == pytest.approx(pressure(stretch), rel=1e-8)
    assert fem.assemble_scalar(block.squared) == pytest.approx(pressure(stretch) ** 2, rel=1e-8)  # uniform


@pytest.mark.parametrize("method", ["penalty", pytest.param("nitsche", marks=pytest.mark.long)])
def test_an_open_gap_transmits_nothing(method):
    block = Block(plane=(method, 100 * E, 0.05))
    assert np.abs(block.solve()).max() == 0.0
    assert fem.assemble_scalar(block.force) == 0.0
