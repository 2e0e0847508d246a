"""Pictures of deformed fingers, coloured by a field: the axial second Piola-Kirchhoff stress S11 unless told otherwise.

VTK aborts the process where there is no display, so drawing happens in a process of its own under Xvfb.
"""

from __future__ import annotations

import os
import pickle
import shutil
import subprocess
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from fingerfem.mechanics.obstacles import Body, Box, Cylinder, Plane, Sphere

if TYPE_CHECKING:
    from fingerfem.equilibrium.state import State
    from fingerfem.model import FingerModel


FIELDS = {"S11": ("S11 [MPa]", 1e-6), "von_mises": ("von Mises [MPa]", 1e-6), "J": ("J [-]", 1.0)}  # label, scale


class NoDisplay(ValueError):
    """Pictures need a display or Xvfb."""


@dataclass(frozen=True, kw_only=True)
class Deformed:
    """One panel: a deformed mesh with a field.

    Attributes:
        title: above the panel.
        cells, kinds: VTK connectivity and cell types.
        points: nodes at rest, shape (nodes, 3) [m].
        displacement: shape (nodes, 3) [m].
        field: one of FIELDS.
        values: of the field in each cell, shape (cells,), in SI units; nan in plates.
        obstacle: and its d [m]; None if there is none.
        half: the mesh is the half z >= 0, to be drawn with its mirror image.
    """

    title: str
    cells: np.ndarray
    kinds: np.ndarray
    points: np.ndarray
    displacement: np.ndarray
    field: str
    values: np.ndarray
    obstacle: tuple[Body, float] | None
    half: bool

    @classmethod
    def of(cls, model: FingerModel, state: State, field: str = "S11") -> Deformed:
        """The panel of a state that `model` has solved.

        Raises:
            ValueError: the field is none of FIELDS.
        """
        from dolfinx import plot

        from fingerfem.output.cell_fields import cell_fields

        if field not in FIELDS:
            raise ValueError(f"field must be one of {', '.join(FIELDS)}, got {field}")
        model.take(state)
        cells, kinds, points = plot.vtk_mesh(model.problem.space)
        d = state.parameters.get("d")
        return cls(
            title=", ".join(
                f"{name} = {value * 1e3:.3g} mm" if name == "d" else f"{name} = {value:.3g} N"
                for name, value in state.parameters.items()
            ),
            cells=cells,
            kinds=kinds,
            points=points,
            displacement=state.displacement.reshape(-1, 3),
            field=field,
            values=cell_fields(model)[field],
            obstacle=None if d is None else (model.problem.obstacle, d),
            half=model.scene.is_half,
        )


def draw(panels: Sequence[Deformed], picture: str | Path) -> None:
    """Write a PNG with the panels side by side, two a row.

    Raises:
        NoDisplay: there is neither a display nor Xvfb, or VTK failed.
    """
    command = [sys.executable, "-m", "fingerfem.output.pictures", str(picture)]
    if not os.environ.get("DISPLAY"):
        if shutil.which("xvfb-run") is None:
            raise NoDisplay("pictures need a display or xvfb-run (Debian package xvfb), got neither")
        command = ["xvfb-run", "-a", "-s", "-screen 0 1600x1200x24", *command]
    Path(picture).parent.mkdir(parents=True, exist_ok=True)
    done = subprocess.run(command, input=pickle.dumps(list(panels)), capture_output=True)
    if done.returncode or not Path(picture).exists():
        raise NoDisplay(f"VTK could not draw {picture}: {done.stderr.decode().strip()[-300:]}")


VIEW = np.array([0.0, -0.15, 1.0])  # from the finger towards the eye: upright, from a little below the plane
PANEL = 800  # width [pixels]
SIDES = ("x_length", "y_length", "z_length")


def _draw_here(panels: Sequence[Deformed], picture: str) -> None:
    import pyvista
    from PIL import Image

    label, scale = FIELDS[panels[0].field]
    shown = np.concatenate([panel.values for panel in panels]) * scale
    limit = float(np.nanpercentile(np.abs(shown), 99)) or 1.0
    limits = [-limit, limit] if panels[0].field == "S11" else [float(np.nanmin(shown)), limit]
    fingers = [_finger(panel, label, scale) for panel in panels]
    obstacles = [_obstacle(panel) for panel in panels]

    # One camera for all panels, which sees whatever any of them shows, with room for title and colour bar.
    right = np.cross([0.0, 1.0, 0.0], VIEW)
    right /= np.linalg.norm(right)
    up = np.cross(VIEW, right) / np.linalg.norm(VIEW)
    points = np.concatenate([mesh.points for mesh in [*fingers, *obstacles] if mesh is not None])
    width, height = 1.3 * np.ptp(points @ right), 1.25 * np.ptp(points @ up)
    centre = (points.max(axis=0) + points.min(axis=0)) / 2 + 0.08 * width * right + 0.05 * height * up
    pixels = int(np.clip(PANEL * height / width, 300, 800))
    columns = min(2, len(panels))
    plotter = pyvista.Plotter(
        shape=(-(-len(panels) // columns), columns),
        off_screen=True,
        window_size=[PANEL * columns, pixels * -(-len(panels) // columns)],
        border=False,
    )
    for k, (panel, finger, obstacle) in enumerate(zip(panels, fingers, obstacles, strict=True)):
        plotter.subplot(k // columns, k % columns)
        last = k == len(panels) - 1
        plotter.add_mesh(
            finger,
            scalars=label,
            cmap="coolwarm" if limits[0] < 0 else "viridis",
            clim=limits,
            nan_color="gray",
            show_edges=True,
            line_width=0.5,
            ambient=0.5,
            diffuse=0.5,
            show_scalar_bar=last,
            scalar_bar_args=BAR | {"title": label},
        )
        if obstacle is not None:
            flat = isinstance(obstacle, pyvista.PolyData) and not np.ptp(obstacle.point_normals, axis=0).any()
            plotter.add_mesh(obstacle, color="tan", opacity=0.5, lighting=not flat, show_edges=flat, edge_color="gray")
        plotter.add_text(panel.title, font_size=12, color="black")
        plotter.set_background("white")
        plotter.camera_position = [tuple(centre + np.ptp(points) * VIEW), tuple(centre), (0, 1, 0)]
        plotter.enable_parallel_projection()
        plotter.camera.parallel_scale = max(height, width * pixels / PANEL) / 2
    image = Image.fromarray(plotter.screenshot(None, return_img=True))
    image.quantize(256, Image.Quantize.MAXCOVERAGE).save(picture, optimize=True)  # a third of the bytes


BAR = {
    "vertical": True,
    "position_x": 0.88,
    "position_y": 0.15,
    "height": 0.7,
    "n_labels": 5,
    "color": "black",
    "label_font_size": 18,
    "title_font_size": 18,
}


def _finger(panel: Deformed, label: str, scale: float):
    """The deformed mesh, whole."""
    import pyvista

    grid = pyvista.UnstructuredGrid(panel.cells, panel.kinds, panel.points + panel.displacement)
    grid.cell_data[label] = panel.values * scale
    return grid.merge(grid.reflect((0, 0, 1))) if panel.half else grid


def _obstacle(panel: Deformed):
    """The obstacle; a plane is ruled by squares as wide as the finger, and drawn where the finger is."""
    import pyvista

    if panel.obstacle is None:
        return None
    body, d = panel.obstacle
    centre = np.array(body.centre) + d * np.array(body.direction)
    length, side = panel.points[:, 0].max(), np.ptp(panel.points[:, 1])
    columns = round(1.05 * length / side) + 1
    match body:
        case Plane():
            normal, middle = np.array(body.normal), np.array([columns * side / 2, 0.0, 0.0])
            middle -= normal * (normal @ (middle - centre))
            return pyvista.Plane(middle, -normal, 3 * side, columns * side, 3, columns)
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


if __name__ == "__main__":
    from fingerfem.output.pictures import Deformed

    _draw_here(pickle.load(sys.stdin.buffer), sys.argv[1])
