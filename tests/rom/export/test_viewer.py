"""The page without a model is made from today's sources; files that are no pages are refused."""

from __future__ import annotations

import re
import runpy
from pathlib import Path

import pytest

from rom import Surrogate
from rom.checked_file import ModelError
from rom.export.page import VIEWER, about, write

ROOT = Path(__file__).resolve().parents[3]


def test_the_viewer_is_made_from_these_sources():
    made = re.search(r"sources (\w+)", VIEWER.read_text())
    current = runpy.run_path(str(ROOT / "rom" / "export" / "browser" / "build.py"))["sources"]()
    assert made is not None and made[1] == current, "make page"


def test_the_viewer_names_three_s_licence():
    assert "three.js authors, MIT licence" in VIEWER.read_text()


def test_a_surrogate_s_plate_is_told_from_its_rubber(trained):
    model = Surrogate.load(trained / "finger.h5")
    found = about(model)
    assert found["sections"] == 21 and found["metal"] == [False] * 19 + [True, True]
    assert [tendon["last"] for tendon in found["tendons"]] == [20, 20]


def test_a_page_is_named_html(tmp_path):
    with pytest.raises(ModelError, match=r"page must be a file named \.html, got .*finger\.h5"):
        write(Surrogate.load(), tmp_path / "finger.h5")
