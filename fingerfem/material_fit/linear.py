"""Least squares for laws that are linear in their constants, if asked among the stable ones."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from scipy.linalg import solve_triangular
from scipy.optimize import nnls

from fingerfem.material_fit.points import Points
from fingerfem.material_fit.stresses import nominal_stress
from fingerfem.scene.laws import Law
from fingerfem.scene.laws.stability import EQUAL, MODES, ends, stress

STATES, DIRECTIONS = 20, 60  # of each half of a path; of a change of strain, in which its work is computed
# Least work of a unit strain, over twice the shear modulus [-]: bounds a loss between states, or by the little
# compression of a real law.
MARGIN = 0.01
ABSENT = 1e-9  # of the largest constant: a constant below that is round-off [-]


def unit_laws(law: type[Law], names: Sequence[str]) -> list[Law]:
    """The law with one constant of 1 Pa and the others 0, for every name; incompressible."""
    tables: list[dict[str, Any]] = [{one: float(one == name) for one in names} for name in names]
    return [law.model_construct(**table, D1=np.inf) for table in tables]


def fit_linear(
    law: type[Law], names: Sequence[str], points: Points, stable: tuple[float, float] | None
) -> dict[str, float]:
    """The constants [Pa] of the least weighted squares.

    Args:
        law: the law.
        names: of its constants in which the energy is linear.
        points: measured.
        stable: principal stretches between which the result must be stable [-].
    """
    units = unit_laws(law, names)

    def stresses(mode: str, stretch: np.ndarray) -> np.ndarray:
        return np.stack([nominal_stress(one, mode, stretch) for one in units], axis=1)

    terms = points.by_mode(stresses)
    A, b = terms * points.scale[:, None], points.stress * points.scale
    constants = np.linalg.lstsq(A, b)[0] if stable is None else least_squares_in_cone(A, b, work(units, stable))
    constants[np.abs(constants) < ABSENT * np.abs(constants).max()] = 0.0
    return dict(zip(names, constants.tolist(), strict=True))


def least_squares_in_cone(A: np.ndarray, b: np.ndarray, G: np.ndarray) -> np.ndarray:
    """The c of least |A c - b| with G c >= 0, shape (constants,).

    In z = R c, with A = Q R, it is the projection of Q^T b on a cone. By Moreau, what the projection takes away is a
    combination of the rows of G R^-1 with coefficients of one sign, and of these the nearest.

    Args:
        A: of full rank, shape (points, constants).
        b: shape (points,).
        G: shape (inequalities, constants).
    """
    Q, R = np.linalg.qr(A)
    f = Q.T @ b
    rows = solve_triangular(R, G.T, trans="T")
    rows = rows / np.linalg.norm(rows, axis=0)
    taken, _ = nnls(rows, -f)
    return solve_triangular(R, f + rows @ taken)


def work(units: Sequence[Law], stretches: tuple[float, float]) -> np.ndarray:
    """Work of unit changes of strain beyond its least, per constant, shape (changes, constants) [-].

    Hill's inequality of incompressible rubber, see `fingerfem.scene.laws.stability`, on the paths of the three tests:
    a change of strain does not change the volume, and the pressure does no work.
    """
    across, along = np.array([1.0, -1.0, 0.0]) / np.sqrt(2), np.array([1.0, 1.0, -2.0]) / np.sqrt(6)
    angles = np.linspace(0, np.pi, DIRECTIONS, endpoint=False)
    changes = np.outer(np.cos(angles), across) + np.outer(np.sin(angles), along)
    strains = [np.zeros(3)]
    for mode, (stretched, free) in MODES.items():
        path = stretched - free * stretched.sum() / free.sum()
        strains += [x * path for end in ends(mode, stretches) for x in np.linspace(0, np.log(end), STATES + 1)[1:]]
    columns = []
    for law in units:
        rows = []
        for e in strains:
            tau, slope = stress(law, e)
            rows += np.einsum("ci,ij,cj->c", changes, slope, changes).tolist()
            for i, j in ((0, 1), (1, 2), (0, 2)):
                equal = abs(e[i] - e[j]) < EQUAL
                rows.append(slope[i, i] - slope[i, j] if equal else (tau[i] - tau[j]) / (e[i] - e[j]))
        columns.append(np.array(rows) - 2 * MARGIN * law.shear_modulus)
    return np.stack(columns, axis=1)
