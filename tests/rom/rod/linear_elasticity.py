"""Linear elasticity of a square bar that two rigid objects squeeze: boxes of eight nodes with the mean dilatation.

The half side and Young's modulus are 1. A second method for the springs of rubber contact.
"""

import numpy as np
from scipy.sparse import coo_matrix, csc_matrix
from scipy.sparse.linalg import splu

SIGNS = np.array([[(k & 1) * 2 - 1, ((k >> 1) & 1) * 2 - 1, (k >> 2) * 2 - 1] for k in range(8)], float)


def graded(fine: float, growth: float, length: float) -> np.ndarray:
    """Grid lines from 0 to a length, of cells that grow from the first one."""
    steps = fine * growth ** np.arange(200)
    lines = np.append(0.0, np.cumsum(steps))
    lines = lines[: int(np.searchsorted(lines, length)) + 1]
    return lines * length / lines[-1]


def stiffness(nodes: np.ndarray, boxes: np.ndarray, poisson: float) -> csc_matrix:
    """The stiffness of boxes, their corners in the order of SIGNS."""
    sizes = nodes[boxes[:, 7]] - nodes[boxes[:, 0]]
    bulk, shear = 1 / (3 - 6 * poisson), 1 / (2 + 2 * poisson)
    gradients = []
    for point in SIGNS / np.sqrt(3):
        factors = 1 + SIGNS * point
        local = SIGNS / 8 * np.column_stack([np.delete(factors, i, axis=1).prod(axis=1) for i in range(3)])
        gradients.append(local * (2 / sizes)[:, None, :])
    mean, found = np.mean(gradients, axis=0).reshape(-1, 24), 0.0
    for own in gradients:
        strain = np.zeros((len(boxes), 3, 3, 8, 3))
        for i in range(3):
            for j in range(3):
                strain[:, i, j, :, i] += own[:, :, j] / 2
                strain[:, i, j, :, j] += own[:, :, i] / 2
        strain = strain.reshape(-1, 3, 3, 24)
        strain -= np.eye(3)[:, :, None] * np.einsum("eiik->ek", strain)[:, None, None] / 3
        found = found + 2 * shear * np.einsum("eija,eijb->eab", strain, strain) / 8
    found = (found + bulk * mean[:, :, None] * mean[:, None, :]) * sizes.prod(axis=1)[:, None, None]
    dofs = (3 * boxes[:, :, None] + np.arange(3)).reshape(-1, 24)
    rows, columns = np.repeat(dofs, 24, axis=1).ravel(), np.tile(dofs, 24).ravel()
    return coo_matrix((found.ravel(), (rows, columns)), shape=(3 * len(nodes),) * 2).tocsc()


def squeezed(
    nodes: np.ndarray,
    matrix: csc_matrix,
    fixed: np.ndarray,
    touched: tuple[np.ndarray, np.ndarray, np.ndarray],
    depth: float,
) -> np.ndarray:
    """Forces of rigid objects on nodes, shape (n, 3).

    Args:
        nodes: shape (nodes, 3).
        matrix: of stiffness.
        fixed: degrees of freedom that do not move.
        touched: nodes that may touch, their gaps, and the objects' normals there, shapes (n,), (n,) and (n, 3).
        depth: of every object beyond touch.
    """
    where, gap, normal = touched
    free = np.setdiff1d(np.arange(3 * len(nodes)), fixed)
    loads = np.zeros((3 * len(nodes), len(where)))
    for k in range(3):
        loads[3 * where + k, np.arange(len(where))] = normal[:, k]
    loads = loads[free]
    compliance, wanted = loads.T @ splu(matrix[free][:, free]).solve(loads), depth - gap
    pressed, forces = wanted > 0, np.zeros(len(where))
    for _ in range(50):
        forces[:] = 0
        forces[pressed] = np.linalg.solve(compliance[np.ix_(pressed, pressed)], wanted[pressed])
        then = np.where(pressed, forces > 0, compliance @ forces < wanted - 1e-12)
        if (then == pressed).all():
            return forces[:, None] * normal
        pressed = then
    raise AssertionError("no set of contacts is consistent")


def _bar(x: np.ndarray, y: np.ndarray, z: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Nodes, shape (nodes, 3), boxes, shape (boxes, 8), and the grid of their numbers."""
    grid = np.arange(len(x) * len(y) * len(z)).reshape(len(x), len(y), len(z))
    ends = slice(None, -1), slice(1, None)
    corners = [grid[ends[k & 1], ends[(k >> 1) & 1], ends[k >> 2]].ravel() for k in range(8)]
    return np.stack(np.meshgrid(x, y, z, indexing="ij"), -1).reshape(-1, 3), np.column_stack(corners), grid


def cylinder_across_face(radius: float, depth: float, poisson: float, fine: float = 0.05) -> float:
    """The force of two cylinders along z on opposite faces, of a quarter of the bar, times 4."""
    x, y, z = graded(fine, 1.1, 4.0), 1 - graded(fine, 1.25, 1.0)[::-1], 1 - graded(0.08, 1.4, 1.0)[::-1]
    nodes, boxes, grid = _bar(x, y, z)
    fixed = np.unique(np.concatenate([3 * grid[0].ravel(), 3 * grid[:, 0].ravel() + 1, 3 * grid[:, :, 0].ravel() + 2]))
    where = grid[:, -1].ravel()
    where = where[nodes[where, 0] < 0.5]
    touched = where, nodes[where, 0] ** 2 / (2 * radius), np.tile([0.0, -1.0, 0.0], (len(where), 1))
    return -4 * float(squeezed(nodes, stiffness(nodes, boxes, poisson), fixed, touched, depth)[:, 1].sum())


def ball_on_edge(radius: float, depth: float, poisson: float, fine: float = 0.06) -> float:
    """The force of two balls on opposite edges, of the half x > 0 of the bar, times 2."""
    side = 1 - graded(fine, 1.35, 1.0)[::-1]
    side = np.append(-side[:0:-1], side)
    nodes, boxes, grid = _bar(graded(fine, 1.25, 2.5), side, side)
    middle = len(side) // 2
    held = 3 * grid[-1, middle, middle] + np.array([1, 2])  # with the next one, no rigid motion is left
    fixed = np.unique(np.concatenate([3 * grid[0].ravel(), held, [3 * grid[-1, -1, middle] + 2]]))
    parts = []
    for sign in (1.0, -1.0):
        end = -1 if sign > 0 else 0
        faces = np.unique(np.concatenate([grid[:, end].ravel(), grid[:, :, end].ravel()]))
        faces = faces[np.linalg.norm(nodes[faces] - [0.0, sign, sign], axis=1) < 0.5]
        away = nodes[faces] - sign * (1 + radius / np.sqrt(2)) * np.array([0.0, 1.0, 1.0])
        far = np.linalg.norm(away, axis=1)
        parts.append((faces, far - radius, away / far[:, None]))
    touched = tuple(np.concatenate(arrays) for arrays in zip(*parts, strict=True))
    forces = squeezed(nodes, stiffness(nodes, boxes, poisson), fixed, touched, depth)
    return 2 * float(np.linalg.norm(forces[: len(parts[0][0])].sum(axis=0)[1:]))
