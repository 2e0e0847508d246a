"""Files of Gmsh as it writes them: a section's quadrilaterals with named groups, in format 2.2 or 4.1."""

from collections.abc import Mapping
from pathlib import Path

import numpy as np

AROUND = [0, 1, 3, 2]


def write(
    path: Path,
    points: np.ndarray,
    groups: Mapping[str, np.ndarray],
    version: str = "4.1",
    names: Mapping[str, int] | None = None,
) -> Path:
    """Write a file.

    Args:
        path: of the file.
        points: (y, z), shape (points, 2), or (x, y, z), shape (points, 3) [m].
        groups: by name their elements' corners around them, shape (elements, 4), or 3 of triangles.
        version: of the format.
        names: other names' dimensions, of groups without elements.
    """
    nodes = points if points.shape[1] == 3 else np.column_stack([np.zeros(len(points)), points])
    numbers = {name: k + 1 for k, name in enumerate(groups)}
    listed = [f'2 {k} "{name}"' for name, k in numbers.items()]
    listed += [f'{dimension} {90 + k} "{name}"' for k, (name, dimension) in enumerate((names or {}).items())]
    text = ["$MeshFormat", f"{version} 0 8", "$EndMeshFormat", "$PhysicalNames", str(len(listed)), *listed]
    text += ["$EndPhysicalNames", *(_old if version == "2.2" else _new)(nodes, groups, numbers)]
    path.write_text("\n".join(text) + "\n")
    return path


def _old(nodes: np.ndarray, groups: Mapping[str, np.ndarray], numbers: Mapping[str, int]) -> list[str]:
    text = ["$Nodes", str(len(nodes)), *(f"{k + 1} {x!r} {y!r} {z!r}" for k, (x, y, z) in enumerate(nodes.tolist()))]
    elements = [(numbers[name], one) for name, own in groups.items() for one in own.tolist()]
    text += ["$EndNodes", "$Elements", str(len(elements))]
    for k, (number, one) in enumerate(elements):
        text.append(f"{k + 1} {len(one) - 1} 2 {number} {number} {' '.join(str(node + 1) for node in one)}")
    return [*text, "$EndElements"]


def _new(nodes: np.ndarray, groups: Mapping[str, np.ndarray], numbers: Mapping[str, int]) -> list[str]:
    box = " ".join(map(repr, [*nodes.min(axis=0).tolist(), *nodes.max(axis=0).tolist()]))
    text = ["$Entities", f"0 0 {len(groups)} 0", *(f"{k} {box} 1 {k} 0" for k in numbers.values()), "$EndEntities"]
    text += ["$Nodes", f"1 {len(nodes)} 1 {len(nodes)}", f"2 1 0 {len(nodes)}", *map(str, range(1, len(nodes) + 1))]
    text += [f"{x!r} {y!r} {z!r}" for x, y, z in nodes.tolist()]
    count = sum(map(len, groups.values()))
    text += ["$EndNodes", "$Elements", f"{len(groups)} {count} 1 {count}"]
    element = 0
    for name, own in groups.items():
        text.append(f"2 {numbers[name]} {np.shape(own)[1] - 1} {len(own)}")
        for one in own.tolist():
            element += 1
            text.append(f"{element} {' '.join(str(node + 1) for node in one)}")
    return [*text, "$EndElements"]


def write_mesh(path: Path, mesh, names: Mapping[int, str], version: str = "4.1") -> Path:
    """Write a plane mesh whose tags have names; what has none is rubber."""
    around = mesh.quads[:, AROUND]
    groups = {"rubber": around[~np.isin(mesh.tags, list(names))]}
    return write(path, mesh.points, groups | {name: around[mesh.tags == tag] for tag, name in names.items()}, version)
