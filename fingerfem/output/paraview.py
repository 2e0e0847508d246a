"""Files for ParaView."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from fingerfem.discretisation import regions
from fingerfem.output.cell_fields import cell_fields, contact_pressure

if TYPE_CHECKING:
    from fingerfem.equilibrium.state import State
    from fingerfem.model import FingerModel


def write_vtu(model: FingerModel, state: State, file: str | Path) -> None:
    """Write a state as a VTK unstructured grid; ParaView's filter Warp By Vector shows the finger deformed.

    Points at rest [m] with displacement [m], contact_pressure [Pa]; cells with S11, von_mises [Pa], J [-], region, and
    material: 0 the rubber, k the k-th of the others, -1 in plates.

    Raises:
        ValueError: the file is no .vtu, or the finger is shared by ranks.
    """
    import pyvista
    from dolfinx import plot

    if Path(file).suffix != ".vtu":
        raise ValueError(f"a file for ParaView must end in .vtu, got {file}")
    if model.problem.comm.size > 1:
        raise ValueError(f"a file for ParaView must be written by one rank, got {model.problem.comm.size}")
    model.take(state)
    grid = pyvista.UnstructuredGrid(*plot.vtk_mesh(model.problem.space))
    grid.point_data["displacement"] = state.displacement.reshape(-1, 3)
    grid.point_data["contact_pressure"] = contact_pressure(model)
    for name, values in cell_fields(model).items():
        grid.cell_data[name] = values
    region = np.zeros(grid.n_cells, np.int32)
    region[model.problem.mesh.cells.indices] = model.problem.mesh.cells.values
    grid.cell_data["region"] = region
    grid.cell_data["material"] = regions.materials(region)
    Path(file).parent.mkdir(parents=True, exist_ok=True)
    grid.save(file)
