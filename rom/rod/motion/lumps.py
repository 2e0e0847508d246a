"""Mass of a finger, lumped at its plates and sections.

The rubber within half an element of a section moves with it as a rigid body. A correction between neighbouring sections
yields the consistent mass of a Timoshenko beam (Przemieniecki, Theory of Matrix Structural Analysis, 1968, 11.6). The
first frequencies of a few long elements are then as accurate as those of many.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from rom.brief import brief
from rom.dataset.sections.section import area, mean_squares
from rom.elements.pieces import Piece
from rom.rod.rod import Rod
from rom.rod.scene.materials_of_rod import line_mass

SHEAR = 0.85  # shear coefficient of a square, and about that of a circle [-] (Cowper, J. Appl. Mech. 33, 1966)


@brief
class Lumps(NamedTuple):
    """Mass of a finger at its bodies: plates from clamp to tip, then sections in the order of loads.

    Attributes:
        masses: shape (n,) [kg].
        moments: first moments about the bodies' centres, in their frames, shape (n, 3) [kg m].
        inertias: likewise moments of inertia, shape (n, 3, 3) [kg m^2].
        elements: corrections of the mass matrix for the element between each body and the next one towards the clamp,
            by translations and rotations of both in the frame between them, shape (n, 12, 12) [kg, kg m, kg m^2].
    """

    masses: np.ndarray
    moments: np.ndarray
    inertias: np.ndarray
    elements: np.ndarray


def lumps_of(rod: Rod, density: float, plate_density: float, stretches: Sequence[float] | None = None) -> Lumps:
    """Return the mass of a finger for densities of its rubber and plates [kg/m^3].

    Args:
        rod: the finger.
        density: of its rubber.
        plate_density: of its plates.
        stretches: of all elements from clamp to tip [-], by which sections become narrower with Poisson's ratio; at
            rest by default.

    Raises:
        ModelError: the centre of mass of a section is not on the axis.
    """
    whole, steel = area(rod.scene), mean_squares(rod.scene)
    along = iter(stretches or [1.0] * sum(map(len, rod.pieces)))
    lines = {one.material: line_mass(rod.scene, density, one.material) for own in rod.pieces for one in own}

    def bar(piece: Piece, wide: float, length: float, size: float, begin: float) -> np.ndarray:
        """A prism of a piece's rubber, its section `wide`^1/2 times as wide as at a size [-], see `prism`."""
        line = lines[piece.material]
        return prism(line.density * length * whole * size**2, length, line.squares * wide * size**2, begin)

    plates, sections = list[np.ndarray](), list[np.ndarray]()
    first, others = list[np.ndarray](), list[np.ndarray]()  # mass matrices of elements at plates, of the others
    for segment, own in zip(rod.segments, rod.pieces, strict=True):
        half, begins = segment.half_lengths[0], [segment.half_lengths[0], *[0.0] * (len(own) - 1)]
        widths = [next(along) ** (-2 * segment.poisson) for _ in own][::-1]
        area_of_plate = whole * own[0].ends[0] ** 2
        bodies = [prism(2 * half * plate_density * area_of_plate, 2 * half, steel * own[0].ends[0] ** 2, -half)]
        for piece, wide, behind in zip(own, widths, begins, strict=True):
            length = (piece.length - behind) / 2  # an element of the plate begins at its centre, the rubber at its back
            distal, proximal = piece.ends
            bodies[-1] = bodies[-1] + bar(piece, wide, length, distal, -behind - length)
            bodies.append(bar(piece, wide, length, proximal, 0.0))
        shear = 2.0 * (1 + segment.poisson) / SHEAR  # E over the shear modulus and its coefficient [-]
        ahead = rod.segments[len(plates) - 1].half_lengths[0] if plates else 0.0  # from the clamp to the body before
        masses = []
        for k, (piece, wide, behind) in enumerate(zip(own, widths, begins, strict=True)):
            length, size = piece.length - behind, sum(piece.ends) / 2
            line = lines[piece.material]
            mass = line.density * length * whole * sum(one**2 for one in piece.ends) / 2
            arms = behind, ahead if k == len(own) - 1 else 0.0
            masses.append(_element_mass(mass, length, line.squares * wide * size**2, shear, arms))
        first.append(masses[0])
        others += masses[1:]
        if plates:  # rubber at the segment's clamp moves with the plate before, of which it lies in front
            front = rod.segments[len(plates) - 1].half_lengths[0]
            plates[-1] = plates[-1] + bar(own[-1], widths[-1], own[-1].length / 2, own[-1].ends[1], front)
        plates.append(bodies[0])
        sections += bodies[1:-1]
    found = np.array(plates + sections)
    return Lumps(found[:, 0], found[:, 1:4], found[:, 4:].reshape(-1, 3, 3), np.array(first + others))


def prism(mass: float, length: float, squares: np.ndarray, begin: float) -> np.ndarray:
    """Mass, first moment and moments of inertia, shape (13,), of a prism along x that begins at x [m].

    `squares` are the means of y^2 and z^2 over its section, shape (2,) [m^2].
    """
    middle, (y, z) = begin + length / 2, squares
    along = length**2 / 12 + middle**2
    return np.concatenate([[mass], [mass * middle, 0, 0], mass * np.diag([y + z, along + z, along + y]).ravel()])


def _element_mass(
    mass: float, length: float, squares: np.ndarray, shear: float, arms: tuple[float, float]
) -> np.ndarray:
    """Consistent mass matrix of an element minus that of its halves, by distal, then proximal body, shape (12, 12).

    Args:
        mass: of its rubber [kg].
        length: of its rubber [m].
        squares: means of y^2 and z^2 over its section [m^2].
        shear: Young's modulus over the shear modulus and its coefficient [-].
        arms: distances of the rubber's ends from the centres of the distal and the proximal body [m].
    """
    found = np.zeros((12, 12))
    nodes, weights = np.polynomial.legendre.leggauss(5)
    for share, weight in zip((1 + nodes) / 2, mass * weights / 2, strict=True):  # of the way from the proximal section
        straight = np.array([1 - share, share])
        for axis, factor in ((0, 1.0), (3, squares.sum())):  # stretch and twist are linear
            columns = [6 + axis, axis]
            found[np.ix_(columns, columns)] += weight * factor * np.outer(straight, straight)
        for axis, turn, sign, square in ((1, 5, 1.0, squares[0]), (2, 4, -1.0, squares[1])):
            shapes, slopes = _bent(share, length, 12 * shear * square / length**2)
            columns, signs = [6 + axis, 6 + turn, axis, turn], np.array([1.0, sign, 1.0, sign])
            whole = np.outer(shapes, shapes) + square * np.outer(slopes, slopes)
            found[np.ix_(columns, columns)] += weight * signs[:, None] * signs * whole
    for half, begin in ((0, -length / 2), (6, 0.0)):
        found[half : half + 6, half : half + 6] -= _rigid(prism(mass / 2, length / 2, squares, begin))
    carried = np.eye(12)  # from the bodies' centres to the rubber's ends
    for k, arm in ((0, -arms[0]), (6, arms[1])):
        carried[k + 1, k + 5], carried[k + 2, k + 4] = arm, -arm
    return np.asarray(carried.T @ found @ carried)


def _rigid(numbers: np.ndarray) -> np.ndarray:
    """The mass matrix of `prism`, shape (6, 6)."""
    crossed = np.cross(np.eye(3), numbers[1:4])  # crossed @ v = s x v
    return np.block([[numbers[0] * np.eye(3), crossed.T], [crossed, numbers[4:].reshape(3, 3)]])


def _bent(share: float, length: float, shear: float) -> tuple[np.ndarray, np.ndarray]:
    """Deflection [-, m] and rotation [1/m, -] of a beam's section at a share of its length, by those of both ends.

    `shear` is 12 E I / (k G A l^2).
    """
    x, b = share, 1 / (1 + shear)
    deflections = [
        b * (1 - 3 * x**2 + 2 * x**3 + shear * (1 - x)),
        length * b * (x - 2 * x**2 + x**3 + shear / 2 * (x - x**2)),
        b * (3 * x**2 - 2 * x**3 + shear * x),
        length * b * (x**3 - x**2 - shear / 2 * (x - x**2)),
    ]
    turns = [
        6 * b / length * (x**2 - x),
        b * (1 - 4 * x + 3 * x**2 + shear * (1 - x)),
        6 * b / length * (x - x**2),
        b * (3 * x**2 - 2 * x + shear * x),
    ]
    return np.array(deflections), np.array(turns)
