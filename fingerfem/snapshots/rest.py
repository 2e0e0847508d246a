"""The finger at rest, as its snapshots refer to it."""

from __future__ import annotations

import numpy as np

from fingerfem.scene.scene import Scene
from rom.snapshots.body import Body


def body(scene: Scene, nodes: np.ndarray) -> Body:
    """The finger of a scene whose mesh has these nodes, shape (nodes, 3) [m]."""
    geometry = scene.geometry
    on_edge = np.isclose(np.abs(nodes[:, 1:]), geometry.side / 2, atol=1e-6 * geometry.side).all(axis=1)
    return Body(
        nodes=nodes,
        edge_nodes=np.flatnonzero(on_edge),
        plates=np.array(scene.outline.plates),
        half_lengths=np.array([geometry.plate, geometry.side, geometry.side]) / 2,
        is_half=scene.is_half,
    )
