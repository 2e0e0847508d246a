"""Coulomb friction at points of a surface that press on a rigid obstacle.

A point that presses with the force N has a tangential spring of the contact's own stiffness k [N/m]. The stretch s of
the spring is that of the last equilibrium, plus the displacement of the point along the obstacle since then. Its force
f, the drag on the obstacle, obeys Coulomb's law. With any stiffness r of at most k, and b = mu N:

    |f + r (s - f/k)| <= b: s = f/k (it sticks),    else f = b m, m = (f + r (s - f/k)) / |f + r (s - f/k)| (it slides)

(Alart, Curnier, Comput. Methods Appl. Mech. Eng. 92, 1991). The answer does not depend on r. With r = k the law is the
usual return mapping, f = k s or f = b s/|s| (Wriggers, Computational Contact Mechanics, 2006, section 5.2). Then a
point sticks only within a stretch of b/k, a micrometre, which Newton's method jumps over. With the stiffness of the
rubber around a point it does not. The law is linearised in f, s and b, and solved for f. So forces are no unknowns of
their own.

Likewise, a point presses if N - r (g + N/k) > 0 with the gap g, where its force is N = -k g.
"""

from typing import NamedTuple

import numpy as np


class Tangential(NamedTuple):
    """Tangential forces of m points, linearised.

    Attributes:
        forces: of the linearised law, shape (m, 3) [N]; they obey the law where they are those that were tried.
        stiffness: their derivatives by the stretches, symmetric, shape (m, 3, 3) [N/m].
        by_bounds: and by the bounds, shape (m, 3) [-].
        slides: whether a point slides, shape (m,).
    """

    forces: np.ndarray
    stiffness: np.ndarray
    by_bounds: np.ndarray
    slides: np.ndarray


def across(normals: np.ndarray) -> np.ndarray:
    """Projections on tangential planes of normals, shape (m, 3, 3)."""
    return np.asarray(np.eye(3) - normals[:, :, None] * normals[:, None])


def law(
    stretches: np.ndarray,
    normals: np.ndarray,
    stiffness: tuple[np.ndarray, np.ndarray],
    bounds: np.ndarray,
    tried: np.ndarray,
) -> Tangential:
    """The law, linearised about forces that are tried.

    Args:
        stretches: s, tangential, shape (m, 3) [m].
        normals: of the obstacle at the points, shape (m, 3) [-].
        stiffness: k and r, shapes (m,) [N/m].
        bounds: b, shape (m,) [N].
        tried: f, tangential, shape (m, 3) [N].
    """
    k, r = stiffness
    tangential = across(normals)
    way = tried + r[:, None] * (stretches - tried / k[:, None])
    size = np.linalg.norm(way, axis=1)
    slides = size > bounds
    share = np.where(slides, bounds / np.where(slides, size, 1.0), 1.0)
    unit = np.where(slides[:, None], way / np.where(slides, size, 1.0)[:, None], 0.0)
    # At a point that sticks, share is 1 and this k; at one that slides, this turns the force.
    tangent = share * r / (1 - share * (1 - r / k))
    by_stretch = tangent[:, None, None] * (tangential - unit[:, :, None] * unit[:, None])
    forces = np.einsum("mij,mj->mi", by_stretch, stretches) + bounds[:, None] * unit
    return Tangential(forces, by_stretch, unit, slides)


def returned(stretches: np.ndarray, k: np.ndarray, bounds: np.ndarray) -> np.ndarray:
    """The forces that obey the law, by the return mapping of k s, shape (m, 3) [N]."""
    size = k * np.linalg.norm(stretches, axis=1)
    share = np.minimum(1.0, bounds / np.where(size > 0, size, 1.0))
    return np.asarray((np.where(size > 0, share, 1.0) * k)[:, None] * stretches)
