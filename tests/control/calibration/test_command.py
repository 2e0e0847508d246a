"""python3 -m control calibrate prints tables or JSON, and writes a finger and a plot."""

import json

import pytest
from synthetic_logs import columns, written
from terminal import ROOT
from typer.testing import CliRunner

import rom
from control.__main__ import app
from rom.__main__ import app as rom_app

LOG, MODEL = ROOT / "examples" / "log.csv", ROOT / "rom" / "finger.h5"


def run(*words):
    return CliRunner().invoke(app, ["calibrate", str(MODEL), str(LOG), *map(str, words)])


def test_tables_name_parameters_intervals_and_residuals_and_rom_info_repeats_them(tmp_path):
    done = run("-o", tmp_path / "mine.h5")
    assert done.exit_code == 0, done.exception
    for words in ("calibrated on log.csv (30 poses, ", "95 % from", "base rz", "leave-one-out", "kPa"):
        assert words in done.output
    shown = CliRunner().invoke(rom_app, ["info", str(tmp_path / "mine.h5")]).output
    assert done.output in shown


def test_json_has_the_same_numbers_as_the_file(tmp_path):
    done = run("-o", tmp_path / "mine.h5", "--json", "--fit", "modulus", "--fit", "base", "--noise", "position=0.5mm")
    numbers = json.loads(done.output)
    assert numbers == json.loads(json.dumps(rom.load(tmp_path / "mine.h5").rod.calibration))
    modulus = numbers["parameters"]["modulus"]
    low, high = modulus["interval"]
    assert low < 0.9 * modulus["start"] < high and high / low < 1.04


def test_the_plot_has_a_panel_a_quantity(tmp_path):
    pytest.importorskip("matplotlib")
    assert run("--plot", tmp_path / "residuals.svg").exit_code == 0
    text = (tmp_path / "residuals.svg").read_text()
    assert all(f"<!-- {name} -->" in text for name in ("tension", "position", "orientation"))


@pytest.mark.parametrize(
    ("words", "rule"),
    [
        (["--noise", "position=0.5"], "noise must be such as position=0.5mm, orientation=1deg or tension=2%"),
        (["--noise", "tension=2mm"], "noise must be such as"),
        (["-o", "no folder/mine.h5"], "output must be in a folder that exists"),
        (["--plot", "residuals.xyz"], "plot must end in one of"),
    ],
)
def test_options_are_refused_in_one_line(words, rule):
    done = run(*words)
    assert isinstance(done.exception, ValueError) and rule in str(done.exception)


def test_a_log_that_determines_nothing_gives_exit_code_3_and_no_file(tmp_path):
    file = written(tmp_path / "log.csv", columns(1), "F1 [mm]", "F2 [mm]", "x", "y", "z", "qw", "qx", "qy", "qz")
    words = ["calibrate", str(MODEL), str(file), "--fit", "modulus", "-o", str(tmp_path / "mine.h5")]
    done = CliRunner().invoke(app, words)
    assert done.exit_code == 3 and "modulus is not determined by this log" in done.output, done.output
    assert not (tmp_path / "mine.h5").exists()
