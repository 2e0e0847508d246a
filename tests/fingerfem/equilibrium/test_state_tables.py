"""States of the full-order model as tables: named, with units, in a notebook too."""

import pytest

from fingerfem import FingerModel, load_scene


@pytest.fixture(scope="module")
def state():
    return FingerModel(load_scene("scenes/draft.toml")).solve([50.0, 0.0], distance=0.005)


def cell(tables, quantity: str, column: int) -> float:
    """Value in the first row of a quantity in the tables."""
    found, *_ = [
        row[column] for table in tables if not isinstance(table, str) for row in table.rows if row[0] == quantity
    ]
    return float(found)


def test_quantities_are_named_with_units(state):
    tables = state.tables()
    assert cell(tables, "contact force", 1) == pytest.approx(state.contact_force, rel=1e-3)
    assert cell(tables, "tip y", 1) == pytest.approx(1e3 * state.tip[1], rel=1e-3)
    assert cell(tables, "pad pressure", 1) == pytest.approx(1e-3 * state.pad_pressure, rel=1e-3)
    loads, _, sensitivities, stable, took = tables
    assert [row[-1] for row in loads.rows] == ["N", "N", "mm"]
    assert sensitivities.header == ["derivative of", "unit", "by F1 [N]", "by F2 [N]", "by d [mm]"]
    (force,) = [row for row in sensitivities.rows if row[0] == "contact force"]
    assert float(force[-1]) == pytest.approx(1e-3 * state.sensitivities["contact_force"]["d"], rel=1e-2)
    assert stable.startswith("stable: yes") and "Newton iterations" in took


def test_a_notebook_shows_them(state):
    page = state._repr_html_()
    assert page.count("<table>") == 3 and "<td>contact force</td>" in page and "<td>kPa</td>" in page
