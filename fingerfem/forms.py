"""The compiled forms of a scene: one density per energy, one place that derives residual and tangent from them.

Total potential P(u; F, d) = rubber + plates + tendons + contact. Every volume energy is a density W(C):

    residual   R(u; v)    = sum of  S : dE(v)                        S = 2 dW/dC
    tangent    K(u; v, w) = sum of  dS(w) : dE(v) + S* : d2E(v, w)

With S* = S(u) this is Newton's tangent. The mixed-integration-point form (Magisano, Leonetti, Garcea, Int. J. Numer.
Meth. Eng. 109, 2017, doi:10.1002/nme.5228) takes the stress for an unknown of its own at every quadrature point and
eliminates it there, which leaves S* = S(u0) + dS(u0)(u - u0), the stress that the last iterate u0 predicted. Both are
one form here: with u0 = u and a zero step it is Newton's.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import ufl
from dolfinx import fem

from fingerfem import contact, geometry, kinematics, materials, tendons
from fingerfem.scene import Scene


@dataclass(frozen=True, kw_only=True)
class Fields:
    """What the forms depend on: the unknown and the loads."""

    u: fem.Function  # displacement [m]
    previous: fem.Function  # the last iterate u0 [m]
    step: fem.Function  # u - u0 [m]
    tension_density: fem.Function  # sum of F_k / A_k over the channels through a cell [Pa]
    distance: fem.Constant  # of the plane [m]
    penalty: fem.Constant  # of contact [N/m^3]


@dataclass(frozen=True, kw_only=True)
class ContactForms:
    """What the plane adds; none of it is compiled without an obstacle."""

    energy: fem.Form  # [J]
    force: fem.Form  # N = integral of the pressure = -dP/dd [N]
    force_gradient: fem.Form  # dN/du [N/m]
    stiffness: fem.Form  # -dN/dd at fixed u [N/m]
    pad_force: fem.Form  # the part of N that rests on the pad [N]


@dataclass(frozen=True, kw_only=True)
class Forms:
    """The compiled forms of a scene."""

    residual: fem.Form
    tangent: fem.Form
    strain_energy: fem.Form  # of rubber and plates [J]
    tendon_energy: fem.Form  # [J]; at unit tension a channel's length [m]
    tendon_force: fem.Form  # its gradient [N]; at unit tension that of a channel's length [-]
    tip: list[fem.Form]  # integral of the displacement over the tip plate, three components [m^4]
    tip_gradient: list[fem.Form]  # [m^3]
    contact: ContactForms | None


def compile_forms(scene: Scene, mesh: geometry.FingerMesh, fields: Fields, rubber: materials.NeoHookean) -> Forms:
    """Derive and compile what the scene names (collective: FFCx compiles once and caches)."""
    space, u = fields.u.function_space, fields.u
    v, w = ufl.TestFunction(space), ufl.TrialFunction(space)
    metadata = {"quadrature_degree": 2 * scene.mesh.order}
    dx = ufl.Measure("dx", mesh.mesh, subdomain_data=mesh.cells, metadata=metadata)
    in_rubber = dx((geometry.RUBBER, geometry.RUBBER_CHANNEL))
    through_plates = len(scene.geometry.segments) > 1
    in_plate = dx(
        (geometry.PLATE, geometry.PLATE_CHANNEL, geometry.TIP_PLATE) if through_plates else geometry.TIP_PLATE
    )
    in_channel = dx((geometry.RUBBER_CHANNEL, geometry.PLATE_CHANNEL) if through_plates else geometry.RUBBER_CHANNEL)
    fibre = tendons.energy(fields.tension_density)

    C, C0 = kinematics.right_cauchy_green(u), kinematics.right_cauchy_green(fields.previous)
    dE, d2E = kinematics.strain_variation(u, v), kinematics.strain_second_variation(v, w)
    residual, tangent = 0, 0
    for energy, where in ((rubber, in_rubber), (materials.STEEL, in_plate), (fibre, in_channel)):
        S, S0 = materials.stress(energy, C), materials.stress(energy, C0)
        predicted = S0 + ufl.derivative(S0, fields.previous, fields.step)
        residual += ufl.inner(S, dE) * where
        tangent += (ufl.inner(ufl.derivative(S, u, w), dE) + ufl.inner(predicted, d2E)) * where

    contact_forms = None
    if scene.obstacle is not None:
        rule = contact.quadrature(scene.mesh.order)
        ds = ufl.Measure("ds", mesh.mesh, subdomain_data=mesh.facets, metadata=rule)
        surface = ds((geometry.SURFACE, geometry.PAD))
        g = contact.gap(u, ufl.SpatialCoordinate(mesh.mesh), scene.geometry.side, fields.distance)
        p = contact.pressure(g, fields.penalty)
        contact_energy = contact.energy(g, fields.penalty) * surface
        push = ufl.derivative(contact_energy, u, v)
        residual += push
        tangent += ufl.derivative(push, u, w)
        contact_forms = ContactForms(
            energy=fem.form(contact_energy),
            force=fem.form(p * surface),
            force_gradient=fem.form(ufl.derivative(p * surface, u, v)),
            stiffness=fem.form(fields.penalty * ufl.conditional(ufl.lt(g, 0), 1.0, 0.0) * surface),
            pad_force=fem.form(p * ds(geometry.PAD)),
        )

    tip = [u[i] * dx(geometry.TIP_PLATE) for i in range(3)]
    return Forms(
        residual=fem.form(residual),
        tangent=fem.form(tangent),
        strain_energy=fem.form(rubber(C) * in_rubber + materials.STEEL(C) * in_plate),
        tendon_energy=fem.form(fibre(C) * in_channel),
        tendon_force=fem.form(ufl.derivative(fibre(C) * in_channel, u, v)),
        tip=[fem.form(form) for form in tip],
        tip_gradient=[fem.form(ufl.derivative(form, u, v)) for form in tip],
        contact=contact_forms,
    )


def volume_ratio(u: fem.Function) -> fem.Expression:
    """J = det F [-] at the corners, midpoints and centre of every cell."""
    points = np.array([[i, j, k] for i in (0, 0.5, 1) for j in (0, 0.5, 1) for k in (0, 0.5, 1)], float)
    return fem.Expression(ufl.det(kinematics.deformation_gradient(u)), points)


def axial_stress(u: fem.Function, rubber: materials.NeoHookean, space: fem.FunctionSpace) -> fem.Expression:
    """Axial second Piola-Kirchhoff stress S11 of the rubber [Pa] at the points of a cell-wise space."""
    points = space.element.interpolation_points
    S = materials.stress(rubber, kinematics.right_cauchy_green(u))
    return fem.Expression(S[0, 0], points() if callable(points) else points)
