"""Rotation of the tip of a slender finger of rubber alone by loads: a measure of steps."""

from typing import NamedTuple

import numpy as np

from fingerfem.discretisation.problem import Problem


class Turns(NamedTuple):
    """Rotations of the tip by unit loads.

    Attributes:
        actuators: by tensions, F e L / EI [rad/N], then pressures, p A e L / EI [rad/Pa], shape (actuators,).
        wrench: by the components of a wrench [rad/N, rad/(N m)], shape (6,).
        weight: by the whole weight [rad].
    """

    actuators: np.ndarray
    wrench: np.ndarray
    weight: float


def turns(problem: Problem) -> Turns:
    """Rotations of a problem's finger. The axial strain counts as a rotation: a tendon on the axis only shortens."""
    scene, geometry = problem.scene, problem.scene.geometry
    compliance = np.mean(geometry.size_at(np.linspace(0.0, geometry.length, 100)) ** -4.0)  # of all sections [-]
    bending = float(problem.law.young_modulus * geometry.shape.second_moment / compliance)  # [N m^2]
    ends, length = np.cumsum(geometry.segments), geometry.length
    levers = [float(np.linalg.norm(tendon.offset)) * ends[tendon.segment - 1] for tendon in scene.tendons]
    weight = 0.0
    if scene.gravity is not None and scene.densities is not None:
        materials, plates = scene.densities
        weight = max(*materials, plates) * scene.gravity.acceleration * geometry.shape.area * length**3 / 6 / bending
    return Turns(
        actuators=np.append(np.array(levers) / bending + 1 / problem.force_scale, _by_pressure(problem, bending)),
        wrench=np.repeat([length**2 / 2, length], 3) / bending,
        weight=float(weight),
    )


def _by_pressure(problem: Problem, bending: float) -> np.ndarray:
    """Rotations by every chamber's pressure on its end, shape (chambers,) [rad/Pa]."""
    section, rotations = problem.mesh.section, []
    for chamber, cavity in zip(problem.scene.chambers, problem.scene.outline.cavities, strict=True):
        area, offset = section.column_area(cavity.tag), section.column_centroid(cavity.tag)
        if problem.scene.is_half:
            offset[1] = 0.0
        lever = float(np.linalg.norm(offset)) * (chamber.x[1] - chamber.x[0])
        rotations.append(area * (lever / bending + 1 / problem.force_scale))
    return np.array(rotations)
