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

if TYPE_CHECKING:
    from fingerfem.model import FingerModel
    from fingerfem.state import State


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
        plane: y of the obstacle [m], or None.
        half: the mesh is the half z >= 0, to be drawn with its mirror image.
    """

    title: str
    cells: np.ndarray
    kinds: np.ndarray
    points: np.ndarray
    displacement: np.ndarray
    field: str
    values: np.ndarray
    plane: float | None
    half: bool

    @classmethod
    def of(cls, model: FingerModel, state: State, field: str = "S11") -> Deformed:
        """The panel of a state that `model` has solved.

        Raises:
            ValueError: the field is none of FIELDS.
        """
        from dolfinx import plot

        from fingerfem.fields import cell_fields

        if field not in FIELDS:
            raise ValueError(f"field must be one of {', '.join(FIELDS)}, got {field}")
        model.take(state)
        cells, kinds, points = plot.vtk_mesh(model.space)
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
            plane=None if d is None else model.scene.geometry.side / 2 + d,
            half=model.scene.is_half,
        )


def draw(panels: Sequence[Deformed], picture: str | Path) -> None:
    """Write a PNG with the panels side by side, two a row.

    Raises:
        NoDisplay: there is neither a display nor Xvfb, or VTK failed.
    """
    command = [sys.executable, "-m", "fingerfem.render", str(picture)]
    if not os.environ.get("DISPLAY"):
        if shutil.which("xvfb-run") is None:
            raise NoDisplay("pictures need a display or xvfb-run (Debian package xvfb), got neither")
        command = ["xvfb-run", "-a", "-s", "-screen 0 1600x1200x24", *command]
    Path(picture).parent.mkdir(parents=True, exist_ok=True)
    done = subprocess.run(command, input=pickle.dumps(list(panels)), capture_output=True)
    if done.returncode or not Path(picture).exists():
        raise NoDisplay(f"VTK could not draw {picture}: {done.stderr.decode().strip()[-300:]}")


def _draw_here(panels: Sequence[Deformed], picture: str) -> None:
    import pyvista

    rows, columns = (len(panels) + 1) // 2, min(2, len(panels))
    plotter = pyvista.Plotter(
        shape=(rows, columns), off_screen=True, window_size=[800 * columns, 520 * rows], border=False
    )
    label, scale = FIELDS[panels[0].field]
    shown = np.concatenate([panel.values for panel in panels]) * scale
    limit = float(np.nanpercentile(np.abs(shown), 99)) or 1.0
    limits = [-limit, limit] if panels[0].field == "S11" else [float(np.nanmin(shown)), limit]
    length, side = panels[0].points[:, 0].max(), np.ptp(panels[0].points[:, 1])
    bar = {
        "title": label,
        "vertical": True,
        "position_x": 0.88,
        "position_y": 0.15,
        "height": 0.7,
        "n_labels": 5,
        "color": "black",
        "label_font_size": 18,
        "title_font_size": 18,
    }
    for k, panel in enumerate(panels):
        plotter.subplot(k // 2, k % 2)
        grid = pyvista.UnstructuredGrid(panel.cells, panel.kinds, panel.points + panel.displacement)
        grid.cell_data[label] = panel.values * scale
        if panel.half:
            grid = grid.merge(grid.reflect((0, 0, 1)))
        plotter.add_mesh(
            grid,
            scalars=label,
            cmap="coolwarm" if limits[0] < 0 else "viridis",
            clim=limits,
            nan_color="gray",
            show_edges=True,
            line_width=0.5,
            ambient=0.5,
            diffuse=0.5,
            show_scalar_bar=k == len(panels) - 1,
            scalar_bar_args=bar,
        )
        if panel.plane is not None:
            middle = (length / 2, panel.plane, 0)
            plane = pyvista.Plane(center=middle, direction=(0, 1, 0), i_size=1.2 * length, j_size=4 * side)
            plotter.add_mesh(plane, color="tan", opacity=0.4)
        plotter.add_text(panel.title, font_size=12, color="black")
        plotter.set_background("white")
        centre = np.array([0.52 * length, 0.3 * length, 0.0])
        plotter.camera_position = [tuple(centre + length * np.array([0.5, 0.7, 3.0])), tuple(centre), (0, 1, 0)]
        plotter.enable_parallel_projection()
        plotter.camera.parallel_scale = 0.45 * length
    plotter.screenshot(picture)


if __name__ == "__main__":
    from fingerfem.render import Deformed

    _draw_here(pickle.load(sys.stdin.buffer), sys.argv[1])
