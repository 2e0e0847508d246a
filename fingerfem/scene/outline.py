"""Boundaries that a finger's mesh must follow: plates, channels, chambers, other materials and a pad."""

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from fingerfem.scene.placed import Chamber, Material
from fingerfem.scene.sections import RUBBER, Cavity, Column, Inlay, Wanted
from fingerfem.scene.tables import Geometry, Pad, Tendon
from rom.dataset.grid import SHARE


class GridOutline(NamedTuple):
    """Boundaries that the mesh's grid lines must follow, and the parts between them."""

    geometry: Geometry
    tendons: Sequence[Tendon]
    pad: Pad | None
    chambers: Sequence[Chamber] = ()
    materials: Sequence[Material] = ()

    @property
    def is_planar(self) -> bool:
        """True if everything inside has a mirror image in z = 0, so that the finger's two halves are alike."""
        mirrored = all(one.is_mirrored for one in [*self.chambers, *self.materials])
        return mirrored and all(tendon.offset[1] == 0 for tendon in self.tendons)

    @property
    def tolerance(self) -> float:
        """Largest difference of coordinates that count as equal [m]."""
        return SHARE * self.geometry.side

    @property
    def plates(self) -> list[tuple[float, float]]:
        """Start and end of every segment's plate along x [m]."""
        return self.geometry.plates

    @property
    def columns(self) -> list[Column]:
        """Cells of the section's mesh for every tendon."""
        places = [tuple(tendon.offset) for tendon in self.tendons]
        near = 1e-9 * self.geometry.channel_width
        alike = [
            next(j for j, one in enumerate(places) if np.abs(np.subtract(one, place)).max() <= near) for place in places
        ]
        return [
            Column(name=tendon.name, path=tendon.path, offset=np.array(tendon.offset), tag=tag)
            for tendon, tag in zip(self.tendons, alike, strict=True)
        ]

    @property
    def cavities(self) -> list[Cavity]:
        """Cells of the section's mesh for every chamber; those of one region share their cells."""
        where = [one.model_dump(include={"region", "centre", "size"}) for one in self.chambers]
        own = [
            one | {"name": chamber.name} if chamber.region == "group" else one
            for one, chamber in zip(where, self.chambers, strict=True)
        ]
        return [
            Cavity(**_inside(one), tag=RUBBER - 1 - own.index(key)) for one, key in zip(self.chambers, own, strict=True)
        ]

    @property
    def inlays(self) -> list[Inlay]:
        """Cells of the section's mesh for every other material."""
        last = RUBBER - 1 - len(self.chambers)
        return [Inlay(**_inside(one), tag=last - k) for k, one in enumerate(self.materials)]

    def wanted(self, across: int, half: bool, order: int) -> Wanted:
        """Requirements on the section's mesh, with cells across of an order."""
        return Wanted(
            columns=self.columns,
            width=self.geometry.channel_width,
            across=across,
            pad=None if self.pad is None else self.pad.width,
            half=half,
            cavities=self.cavities,
            inlays=self.inlays,
            curved=order > 1,
        )


def _inside(one: Chamber | Material) -> dict[str, Any]:
    """Name and region of a chamber or a material, as the section's mesh takes them."""
    centre, size = (np.array(pair or [0.0, 0.0]) for pair in (one.centre, one.size))
    return {"name": one.name, "region": one.region, "centre": centre, "size": size}
