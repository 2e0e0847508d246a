"""`python3 -m control export` writes a page or a controller's FMU, by the ending, and refuses the rest in one line."""

import zipfile

import pytest
from typer.testing import CliRunner

from control.__main__ import app
from rom.rod.touched_segment import SHIPPED


def asked(*words: object):
    return CliRunner().invoke(app, ["export", *map(str, words)])


def test_the_ending_chooses_between_page_and_fmu(tmp_path):
    assert asked(SHIPPED, tmp_path / "finger.html").exit_code == 0
    assert (tmp_path / "finger.html").read_text().startswith("<!")
    assert asked(SHIPPED, tmp_path / "holder.fmu", "--fmi", "2").exit_code == 0
    with zipfile.ZipFile(tmp_path / "holder.fmu") as packed:
        about = packed.read("modelDescription.xml").decode()
    assert 'fmiVersion="2.0"' in about and 'name="residual"' in about


@pytest.mark.parametrize(
    ("name", "more", "rule"),
    [
        ("finger.h", [], "must be named .html or .fmu, got .*; rom export writes .h"),
        ("finger.html", ["--fmi", "2"], "must be named .html or .fmu, got .*; --fmi needs .fmu"),
        ("nowhere/finger.html", [], "must be in a folder that exists"),
        ("my finger.fmu", [], "C identifier, got"),
    ],
)
def test_what_cannot_be_written_is_refused_in_one_line(tmp_path, name, more, rule):
    refused = asked(SHIPPED, tmp_path / name, *more)
    assert isinstance(refused.exception, ValueError) and "\n" not in str(refused.exception)
    with pytest.raises(ValueError, match=rule):
        raise refused.exception
    assert list(tmp_path.iterdir()) == []
