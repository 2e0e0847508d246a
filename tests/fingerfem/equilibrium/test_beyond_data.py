"""A state that is stretched beyond the data of its law is marked, by stretches that a second way finds too."""

import numpy as np
import pytest
from farm import ROOT
from typer.testing import CliRunner

from fingerfem import FingerModel
from fingerfem.scene.scene import Scene


def solved(table: dict, stretches: list[float]):
    material = {"law": "neo-hookean", "C1": 1.9e6, "D1": 2.43e-7, "stretches": stretches}
    model = FingerModel(Scene.model_validate(table | {"material": material}))
    return model, model.solve([30.0, 0.0], sensitivities=False)


def test_the_extreme_stretches_are_those_of_the_nodes_strain_to_a_cell(table):
    model, state = solved(table, [0.5, 2.0])
    low, high = state.stretches
    x = model.problem.space.tabulate_dof_coordinates()
    moved = x + model.problem.displacement.reshape(-1, 3)
    outer = [np.flatnonzero((abs(x[:, 1] - y) < 1e-9) & (abs(x[:, 2]) < 1.1e-3)) for y in (-0.005, 0.005)]
    lengths = []
    for row in outer:
        row = row[np.lexsort((x[row, 0], x[row, 2]))]
        steps = np.diff(x[row], axis=0), np.diff(moved[row], axis=0)
        along = (steps[0][:, 0] > 1e-6) & (x[row][1:, 0] < 0.045)
        lengths += (np.linalg.norm(steps[1][along], axis=1) / steps[0][along, 0]).tolist()
    assert low < min(lengths) + 0.02 and high > max(lengths) - 0.02
    assert min(lengths) < 0.95 and max(lengths) > 1.02


@pytest.mark.parametrize(("stretches", "beyond"), [([0.5, 2.0], False), ([0.99, 2.0], True), ([0.5, 1.01], True)])
def test_a_state_is_marked_by_either_end_of_the_data(table, stretches, beyond):
    _, state = solved(table, stretches)
    assert state.beyond_data is beyond
    shown = [one for one in state.tables() if one == "stretched beyond the data of the law"]
    assert len(shown) == beyond


def test_a_law_without_data_marks_nothing(draft):
    state = draft.solve([30.0, 0.0], sensitivities=False)
    assert state.beyond_data is None and "stretches" not in state.as_json()


def test_solve_says_how_far_the_data_go(tmp_path):
    from fingerfem.__main__ import app

    text = (ROOT / "scenes" / "draft.toml").read_text().replace("D1 = 2.43e-7", "D1 = 2.43e-7\nstretches = [0.99, 1.5]")
    file = tmp_path / "scene.toml"
    file.write_text(text)
    done = CliRunner().invoke(app, ["solve", str(file), "F1=30", "F2=0"])
    assert done.exit_code == 0 and "the law is a guess at stretches of" in done.output
