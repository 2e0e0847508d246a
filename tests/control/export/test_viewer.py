"""Pages without a browser: the one without a model is made from today's sources, and C answers as Python does."""

import re
import runpy
from pathlib import Path

import numpy as np
import pytest
from sampled import some_points

import rom
from control.export.page import AROUND, VIEWER, about, write
from rom.export.model import struct
from rom.files.checked_file import ModelError
from rom.native import LIBRARY, pointer

ROOT = Path(__file__).resolve().parents[3]


def test_the_viewer_is_made_from_these_sources():
    made = re.search(r"sources (\w+)", VIEWER.read_text())
    current = runpy.run_path(str(ROOT / "control" / "export" / "browser" / "build.py"))["sources"]()
    assert made is not None and made[1] == current, "make page"


def test_the_viewer_names_three_s_licence():
    assert "three.js authors, MIT licence" in VIEWER.read_text()


def test_a_rod_s_plate_is_distinguished_from_its_rubber_and_a_table_has_no_shape(table):
    found = about(rom.load())
    assert found["sections"] == len(found["metal"]) > 10
    assert found["metal"] == [False] * (found["sections"] - 2) + [True, True]
    assert [tendon["last"] for tendon in found["tendons"]] == [found["sections"] - 1] * 2
    assert about(table)["sections"] == 0


@pytest.mark.parametrize(("name", "count"), [("round", AROUND), ("square", 4)])
def test_the_border_of_a_section_is_at_its_distance_from_the_axis(name, count):
    found, box = np.array(about(rom.load(name))["border"]), 0.01 * np.array([[-1, -1], [-1, 1], [1, -1], [1, 1]])
    radius = 0.01 * (1.0 if name == "round" else np.sqrt(2.0))
    assert np.linalg.norm(found @ box, axis=1) == pytest.approx(np.full(count, radius), rel=1e-12)
    assert found.sum(axis=1) == pytest.approx(np.ones(count))


def test_a_tendon_of_a_page_passes_through_its_offset():
    model = rom.load("round")
    box = 0.01 * np.array([[-1, -1], [-1, 1], [1, -1], [1, 1]])
    drawn = [one["weights"] @ box for one in about(model)["tendons"]]
    assert np.allclose(drawn, [one["offset"] for one in model.scene["tendons"]], rtol=0, atol=1e-15)


def test_a_page_is_named_html(tmp_path):
    with pytest.raises(ModelError, match=r"page must be a file named \.html, got .*finger\.h5"):
        write(rom.load(), tmp_path / "finger.h5")


def test_c_alone_answers_as_python_does_for_a_table(table):
    own, points = struct(table), some_points(table, 500)
    expected = table.evaluate(points)
    for i, point in enumerate(points):
        out, errors, jacobian, wrench = np.empty(6), np.empty(4), np.empty(36), np.zeros(18)
        memory = np.empty(LIBRARY.functions.fingerfem_model_memory(own))
        given = map(pointer, (point, memory, wrench, out, errors, jacobian))
        status = LIBRARY.functions.fingerfem_model_evaluate(own, *given, LIBRARY.ffi.NULL)
        assert (status == 0) == expected.inside[i]
        assert errors[1] == pytest.approx(expected.error["contact_force"][i], rel=1e-9, abs=1e-12)
        assert out[3] == pytest.approx(expected.contact_force[i], rel=1e-9, abs=1e-12)
