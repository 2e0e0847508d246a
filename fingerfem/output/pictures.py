"""Pictures of deformed fingers, coloured by a field: the axial second Piola-Kirchhoff stress S11 by default.

VTK aborts the process where there is no display, so drawing (`fingerfem.output.panels`) happens in a process of its own
under Xvfb.
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

from fingerfem.mechanics.obstacles import Body

if TYPE_CHECKING:
    from fingerfem.equilibrium.state import State
    from fingerfem.model import FingerModel
    from fingerfem.scene.scene import Scene
    from fingerfem.scene.tables import Tendon


POINTS = 100  # along a tendon
FIELDS = {"S11": ("S11 [MPa]", 1e-6), "von_mises": ("von Mises [MPa]", 1e-6), "J": ("J [-]", 1.0)}  # label, scale


class NoDisplay(ValueError):
    """Pictures need a display or Xvfb."""


@dataclass(frozen=True, kw_only=True)
class TendonLine:
    """A tendon in a panel.

    Attributes:
        points: along it at rest, from the clamp to the plate that it pulls on, shape (points, 3) [m].
        tension: [N].
    """

    points: np.ndarray
    tension: float


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
        obstacle: bodies and their d [m]; None if there are none.
        half: the mesh is the half z >= 0, to be drawn with its mirror image.
        tendons: to be drawn as they run through the deformed finger.
    """

    title: str
    cells: np.ndarray
    kinds: np.ndarray
    points: np.ndarray
    displacement: np.ndarray
    field: str
    values: np.ndarray
    obstacle: tuple[list[Body], float] | None
    half: bool
    tendons: tuple[TendonLine, ...]

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
            title=_title(model.scene, state.parameters),
            cells=cells,
            kinds=kinds,
            points=points,
            displacement=state.displacement.reshape(-1, 3),
            field=field,
            values=cell_fields(model)[field],
            obstacle=None if d is None else (model.problem.bodies, d),
            half=model.scene.is_half,
            tendons=tuple(_line(model.scene, tendon, state.parameters[tendon.name]) for tendon in model.scene.tendons),
        )


def _title(scene: Scene, values: dict[str, float]) -> str:
    """Tensions, d in mm, and what presses on plates where it does."""
    count, units = len(scene.actuators), {parameter["name"]: parameter["unit"] for parameter in scene.parameters}
    shown = [name for k, name in enumerate(values) if k < count or name == "d" or values[name]]
    return ", ".join(
        f"d = {1e3 * values[name]:.3g} mm" if name == "d" else f"{name} = {values[name]:.3g} {units[name]}"
        for name in shown
    )


def _line(scene: Scene, tendon: Tendon, tension: float) -> TendonLine:
    """A tendon at rest; a straight one stays so between its ends."""
    inner, outer = scene.outline.plates[tendon.segment - 1]
    along = np.linspace(0.0, (inner + outer) / 2, POINTS if tendon.path == "channel" else 2)
    across = np.outer(scene.geometry.size_at(along), tendon.offset)
    return TendonLine(points=np.column_stack([along, across]), tension=tension)


def draw(panels: Sequence[Deformed], picture: str | Path) -> None:
    """Write a PNG with the panels side by side, two a row, seen along -z: a plane that faces the finger is edge-on.

    Raises:
        NoDisplay: there is neither a display nor Xvfb, or VTK failed.
    """
    command = [sys.executable, "-m", "fingerfem.output.panels", str(picture)]
    if not os.environ.get("DISPLAY"):
        if shutil.which("xvfb-run") is None:
            raise NoDisplay("pictures need a display or xvfb-run (Debian package xvfb), got neither")
        command = ["xvfb-run", "-a", "-s", "-screen 0 1600x1200x24", *command]
    Path(picture).parent.mkdir(parents=True, exist_ok=True)
    done = subprocess.run(command, input=pickle.dumps(list(panels)), capture_output=True)
    if done.returncode or not Path(picture).exists():
        lines = done.stderr.decode(errors="replace").strip().splitlines() or [f"exit code {done.returncode}"]
        raise NoDisplay(f"VTK could not draw {picture}: {lines[-1]}")
