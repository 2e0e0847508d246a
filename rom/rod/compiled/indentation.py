"""Indentation of rubber by contact forces, in addition to bending and stretch of the finger.

The rubber is cut into slices of thickness p along the finger. Its half side is h, Young's modulus E. Springs along the
finger press where an object reaches them (native/shapes/indentation.c). Their compliance, of a whole slice, is

    on an edge, or at a point of a face      1 / (EDGE E p),  1 / (FACE E p)           [m/N]

as the one-dimensional springs that press on a ball as its contact of Hertz does (Popov, Contact Mechanics and Friction,
2010, chapter 19): E / (1 - nu^2) / sqrt(2) is 0.777 E at nu = 0.3. The depth counts from the finger's axis. A
half-space sinks at the depth of the axis, too, so that points of one face at the distance x sink less, by

    f / (E h) POINT exp(-(x / (NEAR h))^2).

An outline without faces is as stiff in place of FACE E as Hertz's contact with a ball of its own radius,
E / (1 - nu^2) / sqrt(2) / 2^(1/4). POINT is smaller there: linear in the share of the box's area, ROUND for a circle.

A force f on a line across a face lowers the face at the distance x along the finger by

    f / (E h) ROW / 2 ln(1 + (DEPTH h / x)^2),

which is a line load on a half-space, ROW = (1 - nu^2) / pi at nu = 0.3, beside its opposite as deep below as the finger
is thick; over the line's own slice, by f / (E h) ROW (ln(DEPTH h / p) + 3/2). The opposite face comes to meet it by

    f / (E h) OPPOSITE exp(-x / (REACH h)).

DEPTH, OPPOSITE and REACH are those of linear elasticity on 40 x 10 cells; EDGE, FACE, POINT and NEAR agree with balls
that squeeze a finger from two sides, on meshes that are refined (studies/rubber/indentation.py).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

FACE, EDGE = 0.76, 0.37  # [-]
POINT, NEAR, ROUND = 0.7, 0.6, 0.4
CIRCLE = np.pi / 4  # share of a box's area that a circle fills [-]
CURVED = 2**-0.75  # of E / (1 - nu^2): stiffness of an outline before a ball of its own radius [-]
ROW, DEPTH = 0.29, 0.42
OPPOSITE, REACH = 0.187, 0.44
FIRM = 1e-2  # extra compliance of a line over its own, for the forces of a face to be unique [-]


@dataclass(frozen=True, kw_only=True)
class Outlined:
    """A section that is no rectangle: share of its box's area that it fills, and Poisson's ratio of the rubber [-]."""

    filled: float
    poisson: float


def indentations(
    young_modulus: float, half: float, pitch: float, count: int, outlined: Outlined | None = None
) -> dict[str, Any]:
    """Compliances of slices of rubber, as values of a struct fingerfem_segment.

    Args:
        young_modulus: of the rubber [Pa]; 0 where nothing is known of it.
        half: of the finger's side, or of the mean side of its section's box [m].
        pitch: thickness of a slice [m].
        count: of slices.
        outlined: of a section that is no rectangle.
    """
    if young_modulus == 0.0:
        return {}
    away = pitch * np.arange(1, count)
    unit = 1 / (young_modulus * half)
    face, point = FACE, POINT
    if outlined is not None:
        face = CURVED / (1 - outlined.poisson**2)
        point = max(POINT - (POINT - ROUND) * (1 - outlined.filled) / (1 - CIRCLE), 0.0)
    own = max(np.log(DEPTH * half / pitch) + 1.5, 0.5)
    return {
        "face_compliance": 1 / (face * young_modulus * pitch),
        "edge_compliance": 1 / (EDGE * young_modulus * pitch),
        "line_compliance": (1 + FIRM) * ROW * own * unit,
        "row_compliance": ROW * unit * np.append(own, np.log1p((DEPTH * half / away) ** 2) / 2),
        "point_compliance": point * unit * np.exp(-((np.append(0.0, away) / (NEAR * half)) ** 2)),
        "opposite_compliance": OPPOSITE * unit * np.exp(-np.append(0.0, away) / (REACH * half)),
    }
