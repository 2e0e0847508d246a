"""Pictures of a motion and of modes."""

from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from fingerfem.dynamics.modes import Modes
from fingerfem.dynamics.moving_problem import MovingProblem

WIDTH, HEIGHT, DOTS_PER_INCH = 5.0, 2.6, 110  # of a panel [inches]
MILLI = 1e3
ENERGIES = ("kinetic", "strain", "contact", "branches", "lost")


def write_motion(rows: list[dict[str, float]], file: Path) -> None:
    """Draw a motion's rows: the tip, the contact force if there is any, and the energies."""
    has_contact = "contact_force" in rows[0]
    columns = {name: np.array([row[name] for row in rows]) for name in rows[0]}
    count = 2 + has_contact
    figure = Figure(figsize=(WIDTH, HEIGHT * count), layout="constrained")
    panels = list(np.ravel(figure.subplots(count, 1, sharex=True)))
    for name in ("tip_x", "tip_y", "tip_z"):
        panels[0].plot(columns["time"], MILLI * columns[name], label=name.replace("_", " "))
    _label(panels[0], "displacement [mm]")
    if has_contact:
        panels[1].plot(columns["time"], columns["contact_force"])
        panels[1].set_ylabel("contact force [N]")
    for name in ENERGIES:
        if columns[name].any():
            panels[-1].plot(columns["time"], MILLI * columns[name], label=name)
    _label(panels[-1], "energy [mJ]")
    panels[-1].set_xlabel("time [s]")
    figure.savefig(file, dpi=DOTS_PER_INCH)


def write_modes(modes: Modes, file: Path) -> None:
    """Draw the mean displacements of cross-sections, a panel a mode, the largest of a mode 1."""
    rows = -(-len(modes.frequencies) // 2)
    figure = Figure(figsize=(2 * WIDTH, HEIGHT * rows), layout="constrained")
    panels = np.ravel(figure.subplots(rows, 2, sharex=True, squeeze=False))
    for axes, shape, title in zip(panels, modes.lines, modes.titles, strict=False):
        largest = np.abs(shape[:, 1:4]).max()
        for name, own in zip("xyz", shape[:, 1:4].T, strict=True):
            axes.plot(MILLI * shape[:, 0], own / largest, label=f"u{name}")
        axes.set_title(title, fontsize=9)
        _label(axes, "mean displacement [-]")
        axes.set_xlabel("position along the finger [mm]")
    figure.savefig(file, dpi=DOTS_PER_INCH)


def write_mode_fields(problem: MovingProblem, modes: Modes, file: Path) -> None:
    """Write an equilibrium's displacement [m] and the modes about it, the largest of each 1, for ParaView.

    Raises:
        ValueError: the file is no .vtu.
    """
    import pyvista
    from dolfinx import plot

    if file.suffix != ".vtu":
        raise ValueError(f"a file for ParaView must end in .vtu, got {file}")
    grid = pyvista.UnstructuredGrid(*plot.vtk_mesh(problem.space))
    grid.point_data["displacement"] = problem.displacement.reshape(-1, 3)
    for k, (shape, frequency) in enumerate(zip(modes.shapes, modes.frequencies, strict=True)):
        grid.point_data[f"mode_{k + 1}_{frequency:.4g}_Hz"] = shape.reshape(-1, 3) / np.abs(shape).max()
    file.parent.mkdir(parents=True, exist_ok=True)
    grid.save(file)


def _label(axes: Axes, vertical: str) -> None:
    axes.set_ylabel(vertical)
    axes.legend(frameon=False, fontsize=8)
