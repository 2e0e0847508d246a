"""Draws panels of deformed fingers: python3 -m fingerfem.output.panels PICTURE.png, with pickled panels on stdin.

VTK renders finger and obstacle along -z in parallel projection, so that lengths along x and y are true and nothing
seems to pass a plane that it only touches; matplotlib adds axes in mm, the tendons and a colour bar.
"""

import io
import pickle
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
import pyvista
from matplotlib import colormaps, patheffects
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Colormap, Normalize
from matplotlib.lines import Line2D
from matplotlib.patches import Patch, Rectangle
from matplotlib.ticker import MaxNLocator
from PIL import Image

from fingerfem.mechanics.obstacles import Body, Box, Cylinder, Plane, Sphere
from fingerfem.output.pictures import FIELDS, Deformed

MM = 1e3  # millimetres per metre
WIDTH, DOTS_PER_INCH, FONT = 12.0, 110, 13  # of the picture [inches], [1/inch], [points]
FINER = 2  # pixels rendered per pixel of the picture
OBSTACLE, PLATES = "#84969f", "#5f5f5f"  # colours of no value: greyish blue, dark grey
PULLED, SLACK = "#ff00c8", "#ffffff"  # of tendons
OUTLINE = [patheffects.Stroke(linewidth=3.0, foreground="black"), patheffects.Normal()]
STEPS = 25  # of a colour map: one of them has zero in its middle, and a PNG of 256 colours holds them all
SIDES = ("x_length", "y_length", "z_length")


@dataclass(frozen=True, kw_only=True)
class View:
    """Region and resolution of every panel.

    Attributes:
        extent: left, right, lowest, highest [mm].
        pixels: rendered across.
    """

    extent: tuple[float, float, float, float]
    pixels: int

    @property
    def height_over_width(self) -> float:
        """Aspect ratio of the panel [-]."""
        left, right, lowest, highest = self.extent
        return (highest - lowest) / (right - left)


def colour_map(field: str) -> Colormap:
    """Colour map of a field of FIELDS, in steps: a diverging one if zero has a meaning."""
    return colormaps["coolwarm" if field == "S11" else "viridis"].resampled(STEPS)


def draw_here(panels: Sequence[Deformed], picture: str) -> None:
    """Write a PNG with the panels side by side, two a row; needs a display."""
    field = panels[0].field
    label, scale = FIELDS[field]
    shown = np.concatenate([panel.values for panel in panels]) * scale
    limit = float(np.nanpercentile(np.abs(shown), 99)) or 1.0
    limits = (-limit if field == "S11" else float(np.nanmin(shown)), limit)
    fingers = [_finger(panel, scale) for panel in panels]
    obstacles = [_obstacle(panel) for panel in panels]
    columns = min(2, len(panels))
    rows = -(-len(panels) // columns)
    panel_width = (WIDTH - 2.1) / columns  # [inches]
    view = View(
        extent=_extent([mesh for mesh in [*fingers, *obstacles] if mesh is not None]),
        pixels=round(FINER * DOTS_PER_INCH * panel_width),
    )
    height = rows * (panel_width * view.height_over_width + 0.85) + 0.5
    figure, grid = plt.subplots(rows, columns, figsize=(WIDTH, height), layout="constrained", squeeze=False)
    for axes, panel, finger, obstacle in zip(grid.flat, panels, fingers, obstacles, strict=False):
        axes.imshow(_rendered(finger, obstacle, colour_map(field), limits, view), extent=view.extent)
        _overlay(axes, panel, tendon_paths(panel))
    for axes in grid.flat[len(panels) :]:
        axes.set_axis_off()
    scalars = ScalarMappable(Normalize(*limits), colour_map(field))
    bar = figure.colorbar(scalars, ax=grid, fraction=0.03, pad=0.01, aspect=18 * rows)
    bar.set_label(label, fontsize=FONT)
    bar.ax.tick_params(labelsize=FONT - 1)
    figure.legend(handles=_legend(panels), loc="outside lower center", ncols=4, frameon=False, fontsize=FONT)
    _save(figure, picture)


def _save(figure: Any, picture: str) -> None:
    """Saves a figure as a PNG of 256 colours: a third of the bytes."""
    raw = io.BytesIO()
    figure.savefig(raw, dpi=DOTS_PER_INCH, bbox_inches="tight")
    plt.close(figure)
    image = Image.open(raw).convert("RGB").quantize(256, Image.Quantize.MEDIANCUT, dither=Image.Dither.NONE)
    image.save(picture, optimize=True)


def _extent(meshes: Sequence[Any]) -> tuple[float, float, float, float]:
    """Extent of every panel: left, right, lowest, highest [mm]."""
    points = MM * np.concatenate([mesh.points for mesh in meshes])
    (left, lowest, _), (right, highest, _) = points.min(axis=0), points.max(axis=0)
    room = 0.04 * (right - left)
    return left - room, right + room, lowest - room, highest + room


def _rendered(finger: Any, obstacle: Any, colours: Colormap, limits: tuple[float, float], view: View) -> np.ndarray:
    """The pixels of finger and obstacle, shape (height, width, 3)."""
    left, right, lowest, highest = (value / MM for value in view.extent)
    width, height = view.pixels, round(view.pixels * view.height_over_width)
    plotter = pyvista.Plotter(off_screen=True, window_size=[width, height])
    plotter.set_background("white")
    plotter.add_mesh(
        finger,
        scalars="field",
        cmap=colours,
        clim=limits,
        nan_color=PLATES,
        show_scalar_bar=False,
        ambient=0.75,  # so that colours are those of the bar, yet sides differ
        diffuse=0.35,
        show_edges=True,
        edge_opacity=0.35,
    )
    if obstacle is not None:
        is_slab = isinstance(obstacle, pyvista.UnstructuredGrid)  # seen edge-on, with nothing behind it
        opacity = 1.0 if is_slab else 0.6
        plotter.add_mesh(
            obstacle, color=OBSTACLE, opacity=opacity, lighting=not is_slab, show_edges=is_slab, edge_color="white"
        )
    x, y = (left + right) / 2, (lowest + highest) / 2
    plotter.camera_position = [(x, y, 10 * (right - left)), (x, y, 0.0), (0, 1, 0)]
    plotter.enable_parallel_projection()
    plotter.camera.parallel_scale = (highest - lowest) / 2
    plotter.reset_camera_clipping_range()
    pixels = plotter.screenshot(None, return_img=True)
    plotter.close()
    return np.asarray(pixels)


def _overlay(axes: Axes, panel: Deformed, tendons: Sequence[np.ndarray]) -> None:
    """Title, axes, clamp and tendons, shapes (points, 3) [m], as seen through the finger."""
    half = MM * np.ptp(panel.points[:, 1]) / 2
    extent = axes.get_xlim()
    axes.add_patch(Rectangle((extent[0], -1.3 * half), -extent[0], 2.6 * half, fc="0.9", ec="0.3", hatch="////"))
    for line, points in zip(panel.tendons, tendons, strict=True):
        x, y, _ = MM * points.T
        dashes = "-" if line.tension else (0, (4, 2))
        colour = PULLED if line.tension else SLACK
        axes.plot(x, y, ls=dashes, color=colour, lw=1.6, path_effects=OUTLINE, zorder=3)
        axes.plot(x[-1:], y[-1:], "o", color=colour, mec="black", ms=6, zorder=4)
    axes.set_title(panel.title, fontsize=FONT)
    axes.set_xlabel("x [mm]", fontsize=FONT)
    axes.set_ylabel("y [mm]", fontsize=FONT)
    axes.tick_params(labelsize=FONT - 1)
    axes.xaxis.set_major_locator(MaxNLocator(6, steps=[1, 2, 5, 10]))
    axes.yaxis.set_major_locator(MaxNLocator(5, steps=[1, 2, 5, 10]))


def _legend(panels: Sequence[Deformed]) -> list[Any]:
    """Entries of the legend, for the panels' own contents."""
    pulls = [bool(line.tension) for panel in panels for line in panel.tendons]
    entries: list[Any] = []
    for is_pulled, name, colour, dashes in (
        (True, "tendon, pulled", PULLED, "-"),
        (False, "tendon, slack", SLACK, (0, (3, 1.5))),
    ):
        if is_pulled in pulls:
            entries.append(Line2D([], [], color=colour, ls=dashes, lw=1.6, path_effects=OUTLINE, label=name))
    entries.append(Patch(fc=PLATES, label="plate"))
    if any(panel.obstacle is not None for panel in panels):
        entries.append(Patch(fc=OBSTACLE, label="rigid obstacle"))
    return entries


def _finger(panel: Deformed, scale: float) -> Any:
    """The deformed mesh, whole, with its field times a scale."""
    grid = pyvista.UnstructuredGrid(panel.cells, panel.kinds, panel.points + panel.displacement)
    grid.cell_data["field"] = panel.values * scale
    return grid.merge(grid.reflect((0, 0, 1))) if panel.half else grid


def tendon_paths(panel: Deformed) -> list[np.ndarray]:
    """Paths of tendons in the deformed finger, shapes (points, 3) [m]; straight ones begin at the clamp."""
    grid = pyvista.UnstructuredGrid(panel.cells, panel.kinds, panel.points)
    grid.point_data["displacement"] = panel.displacement
    inward = 1e-6 * np.ptp(panel.points[:, 0]) * np.array([1.0, 0.0, 1.0])  # the mesh's own faces count as within
    paths = []
    for line in panel.tendons:
        probed = pyvista.PolyData(line.points + inward).sample(grid)
        paths.append(line.points + np.asarray(probed["displacement"]))
    return paths


def _obstacle(panel: Deformed) -> Any:
    """The obstacle."""
    if panel.obstacle is None:
        return None
    bodies, d = panel.obstacle
    meshes = [_body(panel, body, d) for body in bodies]
    return meshes[0] if len(meshes) == 1 else pyvista.merge(meshes)


def _body(panel: Deformed, body: Body, d: float) -> Any:
    """A body; a plane is the face of a slab ruled by squares as wide as the finger, drawn where the finger is."""
    centre = np.array(body.centre) + d * np.array(body.direction)
    length, side = panel.points[:, 0].max(), np.ptp(panel.points[:, 1])
    columns = round(1.05 * length / side) + 1
    match body:
        case Plane():
            normal, middle = np.array(body.normal), np.array([columns * side / 2, 0.0, 0.0])
            middle -= normal * (normal @ (middle - centre))
            return _slab(middle, normal, side, columns)
        case Sphere():
            return pyvista.Sphere(body.radius, centre, theta_resolution=40, phi_resolution=40)
        case Cylinder():
            return pyvista.Cylinder(centre, body.axis, body.radius, 3 * side, resolution=60)
        case Box():
            box = pyvista.Cube(center=(0.0, 0.0, 0.0), **dict(zip(SIDES, body.sides, strict=True)))
            placed = np.eye(4)
            placed[:3, :3], placed[:3, 3] = np.array(body.axes).T, centre
            return box.transform(placed, inplace=False)
    raise ValueError(f"obstacle must be a plane, sphere, cylinder or box, got {body}")


def _slab(middle: np.ndarray, normal: np.ndarray, side: float, columns: int) -> Any:
    """Cells in rows along x, three across, on the far side of a plane with a normal, about a point of it [m]."""
    across = np.cross([1.0, 0.0, 0.0] if abs(normal[0]) < 0.9 else [0.0, 1.0, 0.0], -normal)
    across /= np.linalg.norm(across)
    grid = pyvista.ImageData(dimensions=(columns + 1, 2, 4), spacing=(side, 0.4 * side, side))
    grid.origin = (-columns * side / 2, 0.0, -1.5 * side)
    placed = np.eye(4)
    placed[:3, :3], placed[:3, 3] = np.column_stack([np.cross(-normal, across), -normal, across]), middle
    return grid.cast_to_unstructured_grid().transform(placed, inplace=False)


if __name__ == "__main__":
    draw_here(pickle.load(sys.stdin.buffer), sys.argv[1])
