"""Tables for people: in a pipe, in a notebook, on a narrow terminal."""

import numpy as np
import pytest

from rom import Rod, TouchedSegment
from rom.console.table import Table, number, parameters, print_tables, quantities, row
from rom.rod.touched_segment import SHIPPED


def test_values_are_in_the_units_that_people_read():
    assert row("tip x", 0.0123456, "m", 2.5e-5) == ["tip x", "12.35", "0.025", "mm"]
    assert row("pad pressure", 534_655.0, "Pa") == ["pad pressure", "534.7", "", "kPa"]
    assert number(1e-20, "m") == "0" and number(np.nan, "N") == "-" and number(np.inf, "N") == "inf"


def test_columns_stand_under_their_headers():
    text = quantities([row("tip x", 0.0123456, "m", 2.5e-5), row("F1", 20.0, "N")], "loads").text
    assert text.splitlines() == [
        "loads",
        "quantity   value   ± error   unit",
        "tip x      12.35     0.025     mm",
        "F1            20                N",
    ]


def test_a_column_of_errors_stands_only_where_there_are_some():
    assert quantities([row("F1", 20.0, "N")]).header == ["quantity", "value", "unit"]


def test_html_shows_what_could_be_taken_for_tags():
    found = Table(title="a < b", header=["name"], rows=[["<script>"]]).html
    assert "<script>" not in found and "&lt;script&gt;" in found and "a &lt; b" in found


def test_units_in_brackets_are_no_markup_for_rich(monkeypatch, capsys):
    pytest.importorskip("rich")
    monkeypatch.setattr("sys.stdout.isatty", lambda: True, raising=False)
    print_tables([Table(header=["finger", "F1 [N]"], rows=[["1 [red]", "20"]]), "d = [0, 1] m"])
    seen = capsys.readouterr().out
    assert "F1 [N]" in seen and "1 [red]" in seen and "d = [0, 1] m" in seen


@pytest.mark.parametrize("kind", ["table", "touched", "rod"])
def test_models_and_their_answers_show_tables_in_a_notebook(kind, table):
    model = {"table": table, "touched": TouchedSegment.load(), "rod": Rod.load(SHIPPED)}[kind]
    page = model._repr_html_()
    assert page.count("<table>") >= 2 and "contact force" in page
    assert all(f"<td>{one.name}</td>" in page for one in model.parameters)
    if isinstance(model, Rod):
        return
    answer = model.evaluate([30.0, 5.0, 0.010])
    html = answer._repr_html_()
    assert "<td>tip x</td>" in html and "± error" in html and "inside what was trained" in html
    assert "not inside" in model.evaluate([300.0, 5.0, 0.010])._repr_html_()
    many = model.evaluate([[30.0, 5.0, 0.010]] * 25)._repr_html_()
    assert "10 of 25 points" in many and many.count("<tr>") == 11


def test_parameters_have_their_limits_in_the_units_that_people_read():
    assert parameters(TouchedSegment.load().parameters).rows[0] == ["F1", "0", "100", "N"]
