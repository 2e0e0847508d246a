"""The combinations of loads that an element's polynomial has as variables: resultants first, then finer moments.

By Saint-Venant's principle a short element feels the resultants of its tensions: the axial force and two bending
moments. Which tendons carry them matters less, the less the finer the pattern. The variables are therefore moments
sum_k y_k^a z_k^b F_k of growing order a + b, made orthonormal: new = map @ tensions, tensions = map.T @ new.

The pair y^a z^b, y^b z^a is made orthonormal symmetrically (P.-O. Loewdin, J. Chem. Phys. 18, 1950). So a mirror of the
section, which permutes tendons, permutes these variables too, but for signs.
"""

from typing import Any, NamedTuple

import numpy as np
from scipy.linalg import block_diag

from rom.brief import brief
from rom.dataset.actuators import pressures_of

RESULTANTS = 1  # highest order of the moments that are resultants
DEPENDENT = 1e-6  # part of a moment below which it is one of lower moments [-]


@brief
class TensionMap(NamedTuple):
    """Variables of a polynomial in place of t loads, tensions and then pressures.

    Attributes:
        matrix: orthogonal, shape (t, t): of variables as rows, by loads.
        orders: of the moment that each of them is; RESULTANTS at most if it is a resultant, shape (t,).
    """

    matrix: np.ndarray
    orders: np.ndarray


def tension_map(offsets: np.ndarray) -> TensionMap:
    """The variables for tendons at offsets (y, z) of the section, shape (t, 2) [m].

    They are the tensions themselves if the resultants determine these, as of two tendons.

    Raises:
        ValueError: two tendons have one offset.
    """
    count = len(offsets)
    y, z = (np.asarray(offsets, float) / (np.abs(offsets).max() or 1.0)).T
    rows, orders = np.zeros((0, count)), []  # type: np.ndarray, list[int]
    for order in range(count):
        for b in range(order // 2 + 1):
            a = order - b
            moments = np.array([y**a * z**b, y**b * z**a])
            new = _orthonormal(moments - moments @ rows.T @ rows)
            rows, orders = np.concatenate([rows, new]), orders + [order] * len(new)
    if len(rows) < count:
        raise ValueError(f"tendons.offset must differ from tendon to tendon, got {np.asarray(offsets).tolist()}")
    if max(orders) <= RESULTANTS:
        rows = np.eye(count)
    return TensionMap(rows, np.array(orders))


def of_scene(scene: dict[str, Any]) -> TensionMap:
    """The variables for the loads of a scene: of its tendons, then the pressures as they are.

    A pressure's resultants are not all that a short element feels of it: it also widens its chamber.
    """
    tendons, pressures = tension_map(np.array([tendon["offset"] for tendon in scene["tendons"]])), pressures_of(scene)
    matrix = block_diag(tendons.matrix, np.eye(pressures)) if pressures else tendons.matrix
    return TensionMap(matrix, np.append(tendons.orders, np.zeros(pressures, int)))


def _orthonormal(moments: np.ndarray) -> np.ndarray:
    """Orthonormal rows that span a pair of rows, as near to these as can be; fewer if they are dependent."""
    left, sizes, right = np.linalg.svd(moments, full_matrices=False)
    rank = int((sizes > DEPENDENT).sum())
    return left @ right if rank == len(moments) else np.copysign(1.0, left[0, :rank, None]) * right[:rank]
