"""The compiled forms of a scene: what `volume_energies` and contact say, one form for all of it.

Total potential P(u; F, d) = rubber + plates + tendons + contact.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import ufl
from dolfinx import fem

from fingerfem.discretisation import form_cache, regions
from fingerfem.discretisation.mesh import FingerMesh
from fingerfem.discretisation.tangent import Moduli, gauss
from fingerfem.discretisation.volume_energies import (
    Overstress,
    Term,
    by_region,
    constants,
    moduli_of,
    residual_of,
    rubber_terms,
    total,
    volume_measure,
)
from fingerfem.mechanics import chambers, contact, obstacles, strain_energy, tendons
from fingerfem.mechanics.obstacles import Body
from fingerfem.scene.laws import plate_law
from fingerfem.scene.scene import Scene


@dataclass(frozen=True, kw_only=True)
class Fields:
    """Fields and constants in the forms: the unknown and the loads."""

    u: fem.Function  # displacement [m]
    previous: fem.Function  # the last iterate u0, from which the tangent's stress is extrapolated ... [m]
    change: fem.Function  # ... to first order in this change of it [m]
    tension_density: fem.Function  # of the tendons in a cell, per area [Pa] or, in a hole, volume [N/m^3]
    probe_density: fem.Function  # the same of tensions that energy, lengths and gradients are asked for
    pressure: fem.Function | None  # of chambers, at the nodes of their walls [Pa]; None without chambers
    probe_pressure: fem.Function | None  # the same, as probe_density
    distance: fem.Constant  # d of the obstacle [m]
    stiffness: fem.Constant  # of contact, gamma = factor E / h with Young's modulus E of the rubber [N/m^3]
    size: fem.Function | None  # of sections over that at the clamp [-]; None without taper
    overstress: Overstress | None  # of viscoelastic branches; None without any
    pad_share: fem.Function | None  # y: share of a node's contact force that rests on the pad [-]


@dataclass(frozen=True, kw_only=True)
class ContactForms:
    """Forms of contact; none is compiled without an obstacle."""

    energy: fem.Form  # [J]
    force: fem.Form  # N = -dP/dd, of a plane the integral of the pressure p [N]
    force_gradient: fem.Form  # dN/du [N/m]
    nodal_force: fem.Form  # forces of the nodes on the obstacle [N]
    stiffness: fem.Form  # -dN/dd at fixed u [N/m]
    gap_work: fem.Form  # integral of p |g|, which the exact solution does not have [J]
    pad_force: fem.Form | None  # the part of N that rests on the pad [N]
    pad_area: fem.Form | None  # [m^2]
    pad_gradient: fem.Form | None  # of pad_force by u [N/m], if the scene stores the pad's pressure


@dataclass(frozen=True, kw_only=True)
class Forms:
    """The compiled forms of a scene."""

    residual: fem.Form
    moduli: list[Moduli]  # of the volume energies but the straight tendons'
    other_tangent: fem.Form | None  # the tangent of what else there is [N/m]
    strain_energy: fem.Form  # of rubber, all relaxed, and plates [J]
    actuator_energy: fem.Form  # of tendons and chambers [J]; at unit tension a length [m], at unit pressure -V [m^3]
    actuator_force: fem.Form  # its gradient [N]; at unit tension that of a tendon's length [-]
    tip: list[fem.Form]  # integral of the displacement over the tip plate, three components [m^4]
    tip_gradient: list[fem.Form]  # [m^3]
    contact: list[ContactForms]  # by body


def quadrature_degree(order: int) -> int:
    """Degree of the Gauss rule in the volume: a higher one changes no result noticeably."""
    return 2 * order


def compile_forms(scene: Scene, mesh: FingerMesh, fields: Fields) -> Forms:
    """Derive and compile what the scene names (collective: FFCx compiles once and caches)."""
    space, u = fields.u.function_space, fields.u
    v, w = ufl.TestFunction(space), ufl.TrialFunction(space)
    number, degree = constants(mesh.mesh), quadrature_degree(scene.mesh.order)
    rubber = rubber_terms(scene.laws, number, degree, fields.overstress)
    channels = regions.channels(len(scene.laws))
    plates = Term(strain_energy.energy(plate_law(scene.law), number), regions.PLATES, degree)
    paths = {tendon.path for tendon in scene.tendons}
    pulled, probed = (
        [Term(tendons.channelled(density, fields.size), channels, degree)] if "channel" in paths else []
        for density in (fields.tension_density, fields.probe_density)
    )

    def integrals(terms: Sequence[Term]) -> list[tuple[strain_energy.Energy, Any]]:
        return [(term.energy, volume_measure(mesh, term.degree)(term.regions)) for term in terms]

    solids = integrals([*by_region(rubber), plates])
    relaxed = integrals([*by_region(rubber_terms(scene.laws, number, degree)), plates])
    residual, actuator_energy = residual_of([*solids, *integrals(pulled)], u), total(integrals(probed), u)
    stiffening = []  # tangents of what is not in the moduli
    for pulling, probing in _other_actuators(scene, mesh, fields):
        force = ufl.derivative(pulling, u, v)
        residual, actuator_energy = residual + force, actuator_energy + probing
        stiffening.append(ufl.derivative(force, u, w))

    on_contact = []
    if scene.obstacle is not None:
        ds, bodies = surface_measure(scene, mesh), obstacles.bodies(scene.obstacle, scene.geometry.shape.top)
        on_contact = [_contact(scene, body, ds, fields) for body in bodies]
        pushing, pushed = _contact_residual_and_tangent(scene, bodies, ds, fields)
        residual = residual + pushing
        stiffening.append(pushed)

    tip = [u[i] * volume_measure(mesh, degree)(regions.TIP) for i in range(3)]
    wanted = {
        "residual": residual,
        "other_tangent": sum(stiffening) if stiffening else None,
        "strain_energy": total(relaxed, u),
        "actuator_energy": actuator_energy,
        "actuator_force": ufl.derivative(actuator_energy, u, v),
        "tip": tip,
        "tip_gradient": [ufl.derivative(form, u, v) for form in tip],
        "contact": on_contact,
    }
    made = form_cache.forms(wanted)
    points = {term.degree: gauss(term.degree)[0] for term in rubber}
    moduli = [
        Moduli(form_cache.expression(moduli, points[term.degree]), term.regions, term.degree)
        for term in [*rubber, plates, *pulled]
        for moduli in [moduli_of(term, u, fields.previous, fields.change)]
    ]
    return Forms(**made | {"moduli": moduli, "contact": [ContactForms(**one) for one in made["contact"]]})


def _other_actuators(scene: Scene, mesh: FingerMesh, fields: Fields) -> list[tuple[Any, Any]]:
    """Potentials of straight tendons and of chambers [J], each at the loads and at the probe."""
    x, u, degree = ufl.SpatialCoordinate(mesh.mesh), fields.u, quadrature_degree(scene.mesh.order)
    potentials: list[tuple[Any, Any]] = []
    if any(tendon.path == "straight" for tendon in scene.tendons):
        holes = volume_measure(mesh, degree)((regions.PLATE_HOLE, regions.TIP_HOLE))
        densities = fields.tension_density, fields.probe_density
        one, other = (tendons.straight(density, x, u, fields.size) * holes for density in densities)
        potentials.append((one, other))
    if fields.pressure is not None and fields.probe_pressure is not None:
        rule = {"quadrature_degree": degree}  # exact on cells with straight edges
        wall = ufl.Measure("ds", mesh.mesh, subdomain_data=mesh.facets, metadata=rule)(regions.WALL)
        volume = chambers.enclosed(x, u, ufl.FacetNormal(mesh.mesh))
        potentials.append((-fields.pressure * volume * wall, -fields.probe_pressure * volume * wall))
    return potentials


def surface_measure(scene: Scene, mesh: FingerMesh) -> ufl.Measure:
    """The surface, integrated at its nodes."""
    rule = contact.quadrature(scene.mesh.order)
    return ufl.Measure("ds", mesh.mesh, subdomain_data=mesh.facets, metadata=rule)


class ContactGroup(NamedTuple):
    """Facets held off the obstacle alike."""

    measure: Any  # of their tags, with the rule's points
    gap: Any  # g [m]
    normal: Any  # of the obstacle, towards the finger [-]
    curvature: Any  # its gradient [1/m]
    stiffness: Any  # gamma [N/m^3]
    own_pressure: Any  # q of the rubber's stress [Pa]

    @property
    def pressure(self) -> Any:
        """Contact pressure [Pa]."""
        return contact.pressure(self.gap, self.stiffness, self.own_pressure)

    @property
    def energy(self) -> Any:
        """Energy density [J/m^2]."""
        return contact.energy(self.gap, self.stiffness, self.own_pressure)


def contact_groups(scene: Scene, body: Body, ds: ufl.Measure, fields: Fields, distance: Any) -> list[ContactGroup]:
    """The groups of facets before a body of a scene's obstacle, which `distance` [m] moves.

    Plates are not among them if contact is between nodes: see `closest_points`. Those of all bodies have the
    same measures, in the same order.
    """
    assert scene.obstacle is not None
    domain = ds.ufl_domain()
    number, x = constants(domain), ufl.SpatialCoordinate(domain)
    g, normal, curvature = contact.gap(body, fields.u, x, distance, obstacles.in_ufl(number))
    q: Any = 0
    if scene.obstacle.method == "nitsche":
        energy = strain_energy.energy(scene.law, number)
        q = contact.surface_pressure(energy, fields.u, ufl.FacetNormal(domain), normal)
    if not contact.touch_at_nodes(scene):
        rubber = ds(regions.RUBBER_FACETS, metadata=contact.springs(contact.POINTS[0]))
        return [ContactGroup(rubber, g, normal, curvature, fields.stiffness, q)]
    if scene.obstacle.method == "penalty":
        return [ContactGroup(ds(regions.SURFACE), g, normal, curvature, fields.stiffness, 0)]
    return [
        ContactGroup(ds(regions.RUBBER_FACETS), g, normal, curvature, fields.stiffness, q),
        ContactGroup(ds(regions.PLATE_FACETS), g, normal, curvature, contact.PLATES * fields.stiffness, 0),
    ]


def _contact_residual_and_tangent(scene: Scene, bodies: list[Body], ds: ufl.Measure, fields: Fields) -> tuple[Any, Any]:
    """Residual and tangent of the contact energy; the penalty's by hand, which compiles in a fifth of the time.

    Bodies share integrals: DOLFINx 0.9 takes one of a region.
    """
    assert scene.obstacle is not None
    u, space = fields.u, fields.u.function_space
    v, w = ufl.TestFunction(space), ufl.TrialFunction(space)
    each = [contact_groups(scene, body, ds, fields, fields.distance) for body in bodies]
    alike = list(zip(*each, strict=True))  # groups of facets, of every body

    def integrated(density: Callable[[ContactGroup], Any]) -> Any:
        return sum(sum(map(density, groups)) * groups[0].measure for groups in alike)

    if scene.obstacle.method == "nitsche":
        residual = ufl.derivative(integrated(lambda one: one.energy), u, v)
        return residual, ufl.derivative(residual, u, w)
    residual = integrated(lambda one: contact.penalty_residual(one.gap, one.normal, one.stiffness, v))
    tangent = integrated(lambda one: contact.penalty_tangent(one.gap, one.normal, one.curvature, one.stiffness, v, w))
    return residual, tangent


def _contact(scene: Scene, body: Body, ds: ufl.Measure, fields: Fields) -> dict[str, Any]:
    """Forms of contact besides residual and tangent, see ContactForms, in UFL."""
    u, v = fields.u, ufl.TestFunction(fields.u.function_space)
    distance = ufl.variable(fields.distance)
    groups = contact_groups(scene, body, ds, fields, distance)
    densities = [(one, one.pressure * ufl.diff(one.gap, distance)) for one in groups]  # of N
    energy = sum(one.energy * one.measure for one in groups)
    force = sum(density * one.measure for one, density in densities)
    wanted: dict[str, Any] = {
        "energy": energy,
        "force": force,
        "force_gradient": ufl.derivative(force, u, v),
        "nodal_force": sum(-one.pressure * ufl.dot(one.normal, v) * one.measure for one in groups),
        "stiffness": sum(-ufl.diff(density, distance) * one.measure for one, density in densities),
        "gap_work": sum(one.pressure * abs(one.gap) * one.measure for one in groups),
        "pad_force": None,
        "pad_area": None,
        "pad_gradient": None,
    }
    if scene.obstacle is None or scene.obstacle.pad is None:
        return wanted
    assert fields.pad_share is not None
    on_pad = sum(one.pressure * fields.pad_share[1] * one.measure for one in groups)
    wanted |= {"pad_force": on_pad, "pad_area": fem.Constant(ds.ufl_domain(), 1.0) * ds(regions.PAD)}
    if "pad_pressure" in scene.sampling.store:
        wanted["pad_gradient"] = ufl.derivative(on_pad, u, v)
    return wanted


def pad_areas(ds: ufl.Measure, space: fem.FunctionSpace) -> tuple[fem.Form, fem.Form]:
    """Areas around the nodes, in y, of the pad and of the whole face it lies on [m^2].

    At the finger's edges a node's force comes from both faces that meet there; all of it rests on the pad.
    """
    v, normal = ufl.TestFunction(space), ufl.FacetNormal(ds.ufl_domain())
    face = ufl.conditional(ufl.gt(normal[1], 0.5), v[1], 0.0) * ds(regions.SURFACE)
    return form_cache.form(v[1] * ds(regions.PAD)), form_cache.form(face)
