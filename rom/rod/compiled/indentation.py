"""Indentation of rubber by contact forces, in addition to bending and stretch of the finger.

The rubber is cut into slices of thickness p along the finger. Its half side is h, Young's modulus E. Springs along the
finger press where an object reaches them (native/shapes/indentation.c). Their compliance, of a whole slice, is

    on an edge, or at a point of a face      (1 - FREE nu^2) / (EDGE E p),  (1 - nu^2) / (FACE E p)           [m/N]

as the one-dimensional springs that press on a ball as its contact of Hertz does (Popov, Contact Mechanics and Friction,
2010, chapter 19): FACE is 1 / sqrt(2) there. The depth counts from the finger's axis. A half-space sinks at the axis'
depth, too, so that points of one face at the distance x sink less, by

    f / (E h) POINT exp(-(x / (NEAR h))^2).

An outline without faces has in place of FACE what Hertz's contact has with a ball of its own radius,
1 / sqrt(2) / 2^(1/4). Before a ball of another radius, a circle is as stiff as Hertz's (slice_around.c). POINT is less
there: linear in the share of the box's area, ROUND for a circle, of linear elasticity for balls of 0.4 to 4 radii that
squeeze a cylinder of nu = 0.3 and 0.499 by up to 0.05 radii: forces within 7 %.

A force f on a line across a face lowers the face at the distance x along the finger by

    f / (E h) ROW (1 - nu^2 / 2) / 2 ln(1 + (DEPTH h / x)^2),

which is a line load on a half-space beside its opposite as deep below as the finger is thick. It has 1 / pi in place of
ROW; 1 - nu^2 / 2 is the mean of plane strain, far from the free sides, and plane stress, at them. Over its own slice,
the line lowers the face by f / (E h) ROW (1 - nu^2 / 2) (ln(DEPTH h / p) + 3/2). The opposite face comes to meet it by

    f / (E h) OPPOSITE exp(-x / (REACH h)).

DEPTH, OPPOSITE and REACH are those of linear elasticity on 40 x 10 cells; EDGE, FACE, POINT and NEAR agree with balls
that squeeze a finger from two sides, on meshes that are refined (studies/rubber/indentation.py), at nu = 0.3.
From there to nu = 0 or 0.49, forces of cylinders across a face and of balls on an edge change by -7 to 16 %. Those of
these springs change alike, within 4 % (linear elasticity, tests/rom/rod/test_indentation.py).
"""

from typing import Any

import numpy as np

FACE, EDGE, FREE = 0.6916, 0.3484, 0.65  # [-]
POINT, NEAR, ROUND = 0.7, 0.6, 0.3
CIRCLE = np.pi / 4  # share of a box's area that a circle fills [-]
CURVED = 2**-0.75  # of E / (1 - nu^2): stiffness of an outline before a ball of its own radius [-]
ROW, DEPTH = 0.3037, 0.42
OPPOSITE, REACH = 0.187, 0.44
FIRM = 1e-2  # extra compliance of a line over its own, for the forces of a face to be unique [-]


def indentations(
    rubber: tuple[float, float], half: float, pitch: float, count: int, filled: float | None = None
) -> dict[str, Any]:
    """Compliances of slices of rubber, as values of a struct fingerfem_segment.

    Args:
        rubber: its Young's modulus [Pa], 0 where nothing is known of it, and its Poisson's ratio [-].
        half: of the finger's side, or of the mean side of its section's box [m].
        pitch: thickness of a slice [m].
        count: of slices.
        filled: share of its box's area that a section fills which is no rectangle [-].
    """
    young_modulus, poisson = rubber
    if young_modulus == 0.0:
        return {}
    away = pitch * np.arange(1, count)
    unit = 1 / (young_modulus * half)
    face, point = FACE, POINT
    if filled is not None:
        face, point = CURVED, max(POINT - (POINT - ROUND) * (1 - filled) / (1 - CIRCLE), 0.0)
    row = ROW * (1 - poisson**2 / 2) * unit
    own = max(np.log(DEPTH * half / pitch) + 1.5, 0.5)
    return {
        "face_compliance": (1 - poisson**2) / (face * young_modulus * pitch),
        "edge_compliance": (1 - FREE * poisson**2) / (EDGE * young_modulus * pitch),
        "line_compliance": (1 + FIRM) * row * own,
        "row_compliance": row * np.append(own, np.log1p((DEPTH * half / away) ** 2) / 2),
        "point_compliance": point * unit * np.exp(-((np.append(0.0, away) / (NEAR * half)) ** 2)),
        "opposite_compliance": OPPOSITE * unit * np.exp(-np.append(0.0, away) / (REACH * half)),
    }
