"""The finger at rest, as the states of a set refer to it."""

from __future__ import annotations

from dataclasses import dataclass, fields
from pathlib import Path

import numpy as np

from rom.brief import brief
from rom.dataset.grid import SHARE
from rom.files.atomic_file import write_whole


def body_file(path: str | Path) -> Path:
    """File of a set's finger at rest; it need not exist yet."""
    return Path(path) / "body.npz"


@brief
@dataclass(frozen=True, kw_only=True)
class RestBody:
    """The finger at rest.

    Attributes:
        nodes: sorted by x, then y, then z, shape (nodes, 3) [m].
        sections: cross-sections, the mesh's element boundaries along x, shape (sections,) [m].
        plates: where every segment's plate begins and ends along x, shape (segments, 2) [m].
        half_lengths: of the tip plate along its own axes, shape (3,) [m].
        is_half: whether only the half z >= 0 is modelled, the other being its mirror image.
    """

    nodes: np.ndarray
    sections: np.ndarray
    plates: np.ndarray
    half_lengths: np.ndarray
    is_half: bool

    @property
    def tolerance(self) -> float:
        """Largest difference of coordinates that count as equal [m]."""
        return SHARE * 2 * float(self.half_lengths[1])

    @property
    def section_nodes(self) -> np.ndarray:
        """Positions y and z of the nodes of the section at the clamp, shape (n, 2) [m]."""
        return self.nodes[self.nodes[:, 0] <= self.nodes[0, 0] + self.tolerance, 1:]

    def write(self, file: Path) -> None:
        """Write it, unless the file is there: everyone who does writes the same."""
        if not file.exists():
            numbers = {one.name: np.asarray(getattr(self, one.name)) for one in fields(self)}
            write_whole(file, lambda stream: np.savez(stream, **numbers))  # type: ignore[arg-type]

    @staticmethod
    def read(file: Path) -> RestBody:
        """Read what `write` has written; whatever goes wrong with a broken file is raised as it is."""
        with np.load(file, allow_pickle=False) as stored:
            numbers = {one.name: stored[one.name] for one in fields(RestBody)}
        return RestBody(**numbers | {"is_half": bool(numbers["is_half"])})
