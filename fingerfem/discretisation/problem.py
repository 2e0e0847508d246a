"""The discrete problem of a scene: unknowns, supports and loads; residual, tangent and scalars assembled from them."""

from functools import cached_property

import numpy as np
from dolfinx import fem
from mpi4py import MPI
from numpy.typing import ArrayLike
from petsc4py import PETSc

from fingerfem.discretisation import regions
from fingerfem.discretisation.assembly import Assembly
from fingerfem.discretisation.branches import overstress_of
from fingerfem.discretisation.contact import contact_points
from fingerfem.discretisation.contact.contact_points import ContactPoints
from fingerfem.discretisation.contact.obstacle_contact import BodyContact, ObstacleContact, StiffFacets
from fingerfem.discretisation.deformation_limits import DeformationLimits
from fingerfem.discretisation.forms import Fields, compile_forms, pad_areas, quadrature_degree, surface_measure
from fingerfem.discretisation.loads.actuators import Actuators
from fingerfem.discretisation.loads.plate_loads import LowRank, PlateLoads
from fingerfem.discretisation.loads.weight import weight_forces
from fingerfem.discretisation.mesh import build_mesh, section_sizes
from fingerfem.discretisation.tangent import Tangent, VolumeTangent
from fingerfem.mechanics import contact, obstacles
from fingerfem.mechanics.obstacles import Body
from fingerfem.scene.scene import Scene

FAR = 1e3  # [m]: where the plane stands while nothing may touch it


class Problem(Assembly):
    """The discrete finger: it holds a displacement and loads, and assembles what depends on them (collective).

    Args:
        scene: what is modelled.
        comm: the ranks that share one finger.
    """

    def __init__(self, scene: Scene, comm: MPI.Comm):
        self.scene, self.law = scene, scene.law
        self.mesh = build_mesh(scene, comm)
        self.space = fem.functionspace(self.mesh.mesh, ("Lagrange", scene.mesh.order, (3,)))
        self.supports, self._clamped, held = self._boundary_conditions()
        super().__init__(self.space, 2 if scene.is_half else 1, held)
        self.actuators, degree = Actuators(scene, self.mesh), quadrature_degree(scene.mesh.order)
        self.fields = Fields(
            **self.actuators.fields,
            u=fem.Function(self.space, name="displacement"),
            previous=fem.Function(self.space),
            change=fem.Function(self.space),
            distance=fem.Constant(self.mesh.mesh, FAR),
            stiffness=fem.Constant(self.mesh.mesh, self._contact_stiffness()),
            size=section_sizes(self.mesh, scene.geometry),
            overstress=overstress_of(scene.laws, self.mesh, degree),
            pad_share=self._pad_share(),
        )
        self.forms = compile_forms(scene, self.mesh, self.fields)
        self.limits = DeformationLimits(scene, self.mesh, self.fields.u, degree)
        self.contact: ObstacleContact | None = None
        if scene.obstacle is not None:
            each = zip(self.forms.contact, self.bodies, strict=True)
            stiff = self._stiff_facets()
            contacts = [BodyContact(self, forms, self.fields, one, stiff) for forms, one in each]
            self.contact = ObstacleContact(self, contacts, self.fields)
        self._volume_tangent = VolumeTangent(self.forms.moduli, self.mesh, self.space)
        self._tangent = self.tangent_with(self.supports)
        self.tensions = np.zeros(len(scene.actuators))  # then pressures of chambers [Pa]
        self.distance: float | None = None  # None: the plane is away
        self.weight = 1.0  # share of the weight that acts [-]
        self._weight = weight_forces(self, self.mesh, scene, degree)
        self.plates = PlateLoads(scene, self.mesh, self.space) if scene.load is not None else None
        self.wrenches = np.zeros((len(scene.geometry.segments), 6))
        self._tip_volume = self.mesh.section.area * scene.geometry.plate * float(scene.geometry.sizes[-1]) ** 3
        self.rest_lengths = np.array([self.tendon_length(k) for k in range(len(scene.tendons))])  # [m]
        self.rest_volumes = self.chamber_volumes()  # [m^3]

    def _contact_stiffness(self) -> float:
        obstacle = self.scene.obstacle
        if obstacle is None:
            return 0.0
        modulus = self.law.p_wave_modulus if obstacle.method == "nitsche" else self.law.young_modulus
        return contact.stiffness(obstacle.stiffness_factor, modulus, self.mesh.smallest)

    def _stiff_facets(self) -> StiffFacets | None:
        """Facets of plates, if contact is between nodes."""
        if self.scene.obstacle is None or contact.touch_at_nodes(self.scene):
            return None
        facets = np.concatenate([self.mesh.facets.find(kind) for kind in regions.PLATE_FACETS])
        stiffer = contact.PLATES if self.scene.obstacle.method == "nitsche" else 1.0
        return StiffFacets(np.sort(facets), stiffer * self._contact_stiffness())

    def _pad_share(self) -> fem.Function | None:
        if self.scene.obstacle is None or self.scene.obstacle.pad is None:
            return None
        share = fem.Function(self.space)
        pad, face = (self.nodal(form).ravel() for form in pad_areas(surface_measure(self.scene, self.mesh), self.space))
        np.divide(pad, face, out=share.x.array, where=face > 0)
        return share

    def _boundary_conditions(self) -> tuple[list[fem.DirichletBC], np.ndarray, np.ndarray]:
        """The supports; owned indices of the clamp's unknowns, and of all that are held."""
        dim, owned = self.mesh.mesh.topology.dim - 1, self.space.dofmap.index_map.size_local
        nodes = fem.locate_dofs_topological(self.space, dim, self.mesh.facets.find(regions.CLAMP))
        supports = [fem.dirichletbc(np.zeros(3), nodes, self.space)]
        clamped = (3 * nodes[nodes < owned][:, None] + np.arange(3)).ravel()
        if not self.scene.is_half:
            return supports, clamped, clamped
        across = fem.locate_dofs_topological(self.space.sub(2), dim, self.mesh.facets.find(regions.CUT))
        supports.append(fem.dirichletbc(0.0, across, self.space.sub(2)))
        return supports, clamped, np.union1d(clamped, across[across < 3 * owned])

    @property
    def displacement(self) -> np.ndarray:
        """Nodal displacements of this rank, ghosts included, shape (3 nodes,) [m]; a view."""
        return self.fields.u.x.array

    def set_loads(
        self, tensions: ArrayLike, distance: float | None, wrenches: ArrayLike | None = None, weight: float = 1.0
    ) -> None:
        """Set tensions, the obstacle's distance [m] (None: it is away), wrenches and weight.

        Tensions are of tendons [N], then pressures of chambers [Pa], shape (actuators,). A wrench is about a plate's
        centre, in its frame, shape (plates, 6) [N, N m]; weight a share of the scene's [-].
        """
        self.tensions, self.distance, self.weight = np.array(tensions, float), distance, weight
        self.wrenches[:] = 0.0 if wrenches is None else wrenches
        self.actuators.load(self.tensions)
        self.fields.distance.value = FAR if distance is None else distance

    @property
    def unknowns(self) -> int:
        """Number of displacement unknowns on all ranks."""
        return int(self.space.dofmap.index_map.size_global * 3)

    @property
    def force_scale(self) -> float:
        """E A [N]: what a force is small or large against."""
        return self.law.young_modulus * self.scene.geometry.shape.area

    def residual(self) -> tuple[PETSc.Vec, np.ndarray]:
        """Residual R(u) [N], zero where held, and the clamp's force on the finger, shape (3,) [N].

        The caller destroys the vector.
        """
        b = self.vector(self.forms.residual, None if self.contact is None else self.contact.spring_forces())
        if self.plates is not None and self.wrenches.any():
            b.array[:] -= self.plates.forces(self.plates.poses(self.displacement), self.wrenches)
        if self._weight is not None:
            b.array[:] -= self.weight * self._weight
        reaction = self.copies * self.comm.allreduce(b.array_r[self._clamped].reshape(-1, 3).sum(axis=0))
        if self.scene.is_half:
            reaction[2] = 0.0
        b.array[self.held] = 0.0
        return b, reaction

    def extrapolate_stress(self, change: np.ndarray | None = None) -> None:
        """Extrapolate the tangent's stress from the present displacement, to first order in a change of it.

        Args:
            change: this rank's owned values, shape (owned values,) [m]; None adds nothing.
        """
        self.fields.previous.x.array[:] = self.displacement
        self.fields.change.x.array[:] = 0.0
        if change is not None:
            self.fields.change.x.array[: len(change)] = change
            self.fields.change.x.scatter_forward()

    def tangent(self) -> PETSc.Mat:
        """Tangent at u with the stress that was extrapolated last; the same matrix object every time."""
        return self._tangent.assemble()

    def tangent_with(self, supports: list[fem.DirichletBC]) -> Tangent:
        """The same with other supports."""
        springs = None if self.contact is None else self.contact.springs
        return Tangent(self._volume_tangent, self.forms.other_tangent, self.space, supports, springs)

    @property
    def matrix(self) -> PETSc.Mat:
        """The tangent as it was assembled last."""
        return self._tangent.matrix

    def energy(self) -> float:
        """Total potential [J]."""
        self.actuators.probe(self.tensions)
        forms = [self.forms.strain_energy, self.forms.actuator_energy]
        fallen = 0.0 if self._weight is None else self._weight @ self.displacement[: len(self._weight)]
        touched = 0.0 if self.contact is None else self.contact.energy()
        at_rest = float(self.tensions[len(self.rest_lengths) :] @ self.rest_volumes)
        return sum(map(self.scalar, forms)) + at_rest + touched - self.weight * self.summed(fallen)

    def tip(self) -> np.ndarray:
        """Displacement of the tip plate's centre, its mean over the plate [m], shape (3,)."""
        moved = np.array([self.scalar(form) for form in self.forms.tip]) / self._tip_volume
        return moved * [1, 1, 0] if self.scene.is_half else moved

    def tip_gradient(self, i: int) -> PETSc.Vec:
        """Gradient of the tip's i-th component [-]. The caller destroys the vector."""
        b = self.gradient(self.forms.tip_gradient[i])
        b.scale(0.0 if i == 2 and self.scene.is_half else 1 / self._tip_volume)
        return b

    def tendon_length(self, k: int) -> float:
        """Length of tendon k between its ends [m]: the actuators' energy at unit tension."""
        return self._energy_at_unit_load(k)

    def chamber_volumes(self) -> np.ndarray:
        """Volumes of the chambers, shape (chambers,) [m^3]: each is minus the energy at unit pressure."""
        return -np.array([self._energy_at_unit_load(k) for k in range(len(self.scene.tendons), len(self.tensions))])

    def _energy_at_unit_load(self, k: int) -> float:
        self.actuators.probe(np.eye(len(self.tensions))[k])
        return self.scalar(self.forms.actuator_energy)

    def unsymmetric(self) -> LowRank | None:
        """Matrix by follower loads and friction, which the tangent has subtracted; None without any (collective)."""
        parts = []
        if self.plates is not None and self.wrenches.any():
            parts.append(self.plates.following(self.plates.poses(self.displacement), self.wrenches))
        if self.contact is not None and self.contact.friction is not None:
            parts.append(self.contact.friction.unsymmetric())
        if not parts:
            return None
        taken = LowRank(*map(np.concatenate, zip(*parts, strict=True)))
        taken.left[:, self.held] = 0.0
        return taken

    def load_gradient(
        self,
        tensions: ArrayLike,
        distance: float = 0.0,
        wrenches: np.ndarray | None = None,
        carried: np.ndarray | None = None,
        weight: float = 0.0,
    ) -> PETSc.Vec:
        """Change of the residual with the loads, dR/dF . tensions + dR/dd distance + dR/dw . wrenches [N].

        The caller destroys the vector. For a unit tension it is the gradient of a tendon's length [-], for a unit
        pressure minus that of a volume [m^2], for a unit distance minus that of the contact force [N/m], for a wrench
        minus its forces [N]. Friction adds what changes where the obstacle moves by `carried`, shape (3,) [m].
        """
        self.actuators.probe(tensions)
        friction = None if self.contact is None else self.contact.friction
        dragged = None if friction is None or carried is None else friction.load_gradient(carried)
        b = self.gradient(self.forms.actuator_force, dragged)
        if distance and self.contact is not None:
            pull = self.contact.force_gradient()
            b.axpy(-distance, pull)
            pull.destroy()
        if self.plates is not None and wrenches is not None and wrenches.any():
            b.array[:] -= self.plates.forces(self.plates.poses(self.displacement), wrenches)
        if self._weight is not None and weight:
            b.array[:] -= weight * self._weight
        b.array[self.held] = 0.0
        return b

    @cached_property
    def bodies(self) -> list[Body]:
        """Bodies that the finger may touch; in a scene without an obstacle, the plane y = side/2 + d."""
        return obstacles.bodies(self.scene.obstacle, self.scene.geometry.shape.top)

    @cached_property
    def contact_points(self) -> ContactPoints:
        """Possible contact points of this rank's surface: the nodes, or points between them, too."""
        if contact.touch_at_nodes(self.scene):
            facets = np.sort(np.concatenate([self.mesh.facets.find(kind) for kind in regions.SURFACE]))
            nodes = fem.locate_dofs_topological(self.space, self.mesh.mesh.topology.dim - 1, facets)
            return contact_points.at_nodes(self.space, nodes)
        kinds = (regions.RUBBER_FACETS, regions.PLATE_FACETS)
        parts = [np.concatenate([self.mesh.facets.find(kind) for kind in those]) for those in kinds]
        return contact_points.on_facets(self.space, zip(parts, contact.POINTS, strict=True))

    def surface_places(self) -> np.ndarray:
        """Positions of the possible contact points in space, shape (points, 3) [m]."""
        return self.contact_points.rest + self.contact_points.field(self.displacement)

    def reach(self) -> float:
        """Reach of the surface towards the obstacle: the largest d at which one of its points touches it [m].

        In free space this is the distance at which the obstacle is touched; -inf if it passes by.
        """
        places = self.surface_places()
        farthest = max(float(one.touch_distance(places).max(initial=-np.inf)) for one in self.bodies)
        return float(self.comm.allreduce(farthest, op=MPI.MAX))

    def penetration(self) -> float:
        """Largest penetration of the surface into the obstacle [m]; 0 if it is away."""
        if self.distance is None:
            return 0.0
        places = self.surface_places().T
        gaps = [one.signed_distance(places, self.distance, obstacles.NUMPY) for one in self.bodies]
        deepest = -float(self.comm.allreduce(float(np.min(gaps, initial=np.inf)), op=MPI.MIN))
        return max(deepest, 0.0 if self.contact is None else self.contact.penetration(), 0.0)

    def smallest_volume_ratio(self) -> float:
        """Min J that the law sees [-]: where rubber has a pressure of its own, at the points of that pressure."""
        return self.limits.smallest_of_laws()
