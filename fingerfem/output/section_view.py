"""The section of a finger at the clamp, drawn from its mesh: what is inside, tendons, pad and measures."""

from collections.abc import Iterable

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PolyCollection

from fingerfem.output.dimensions import FONT, INLAY, MM, PAD, RUBBER, dimension, finish, millimetres
from fingerfem.scene.grid_lines import section_mesh
from fingerfem.scene.scene import Scene
from fingerfem.scene.sections import PlaneMesh, Section, material_of
from fingerfem.scene.tables import Tendon


def draw_section(axes: Axes, scene: Scene, colours: Iterable[tuple[Tendon, str]]) -> None:
    """The section with channels, chambers, other materials, tendons and the pad, seen from the clamp: z to the right.

    A material that has the whole section is not drawn here.
    """
    mesh, shape = section_mesh(scene.outline, scene.mesh.cells[1], order=scene.mesh.order), scene.geometry.shape
    half, width = MM * float(np.abs(mesh.points).max()), MM * scene.geometry.channel_width
    _fill(axes, mesh, RUBBER, "0.4", 1.0)
    for inlay in scene.outline.inlays:
        if inlay.region != "section":
            _fill(axes, _part(mesh, material_of(mesh, inlay)), INLAY, "0.4", 1.0)
    for chamber, cavity in zip(scene.chambers, scene.outline.cavities, strict=True):
        _fill(axes, _part(mesh, mesh.tags == cavity.tag), "white", "0.4", 1.0)
        y, z = MM * mesh.column_centroid(cavity.tag)
        axes.text(z, y, chamber.name, color="0.4", ha="center", va="center", fontsize=FONT)
    for line in (axes.axhline, axes.axvline):
        line(0, ls="-.", color="0.5", lw=0.8, zorder=1)
    for (tendon, colour), column in zip(colours, scene.outline.columns, strict=False):
        y, z = MM * column.offset
        _fill(axes, _part(mesh, mesh.tags == column.tag), colour, colour, 0.25)
        axes.plot([z], [y], "o", color=colour, ms=6)
        beside = abs(z) <= abs(y)  # names stand beside tendons that lie above one another, and upright otherwise
        at, turned = ((z + 0.7 * width, y), 0) if beside else ((z, y + 0.7 * width), 90)
        ha, va = ("left", "center") if beside else ("center", "bottom")
        here = [other.name for other in scene.tendons if other.offset == tendon.offset]
        if tendon.name == here[0]:
            axes.text(*at, ", ".join(here), color=colour, ha=ha, va=va, rotation=turned, fontsize=FONT)
    pad = scene.obstacle.pad if scene.obstacle else None
    if pad is not None:
        wide, top = MM * (shape.extents[1] if pad.width is None else pad.width) / 2, MM * shape.top
        axes.plot([-wide, wide], [top, top], color=PAD, lw=5, solid_capstyle="butt")
        axes.text(-wide, top + 0.12 * half, "pad", color=PAD, ha="left", va="bottom", fontsize=FONT)
    left, right = MM * mesh.points[:, 1].min(), MM * mesh.points[:, 1].max()
    dimension(axes, (left, -1.2 * half), (right, -1.2 * half), measures(shape), (0, -0.08 * half))
    axes.set(xlim=(-1.35 * half, 1.35 * half), ylim=(-1.7 * half, 1.45 * half))
    axes.set_title("section, from the clamp", fontsize=FONT)
    finish(axes, "z [mm]", "y [mm]")


def measures(shape: Section) -> str:
    """The numbers of a section's table, such as `diameter 20 mm`; of a file, its extents."""
    numbers = {name: value for name, value in shape.model_dump().items() if isinstance(value, float)}
    numbers = numbers or dict(zip(("height", "width"), shape.extents, strict=True))
    return ",\n".join(f"{name} {millimetres(MM * value)}" for name, value in numbers.items())


def _part(mesh: PlaneMesh, own: np.ndarray) -> PlaneMesh:
    """Some quadrilaterals of a mesh, shape (quads,)."""
    return PlaneMesh(points=mesh.points, quads=mesh.quads[own], tags=mesh.tags[own])


def _fill(axes: Axes, mesh: PlaneMesh, face: str, edge: str, opacity: float) -> None:
    """A mesh's cells without lines between them, and its border."""
    across = MM * mesh.points[:, ::-1]
    cells = PolyCollection(list(MM * mesh.corners[..., ::-1]), fc=face, ec="none", alpha=opacity, antialiased=False)
    axes.add_collection(cells)
    axes.add_collection(LineCollection(list(across[mesh.border]), colors=edge))
