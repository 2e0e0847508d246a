"""`fit-material` prints fits, writes a table that scenes accept and a picture, and ends with the right exit code."""

import json
import re
import sys
import tomllib

import pytest
from farm import ROOT
from material_fit.synthetic import KNOWN, MODES, measured
from matplotlib.image import imread

from fingerfem.__main__ import main
from fingerfem.material_fit.fit import LAWS, compare
from fingerfem.material_fit.plot import draw
from fingerfem.scene.laws import NeoHookean
from fingerfem.scene.scene import Scene

EXAMPLE = ROOT / "examples" / "material.csv"


@pytest.fixture
def command(monkeypatch, capsys):
    """Runs the command: exit code, stdout, stderr."""

    def run(*words) -> tuple[int, str, str]:
        monkeypatch.setattr(sys, "argv", ["fingerfem", "fit-material", *map(str, words)])
        with pytest.raises(SystemExit) as ended:
            main()
        return ended.value.code or 0, *capsys.readouterr()

    return run


@pytest.fixture
def data(tmp_path):
    """Three tests of a Mooney-Rivlin rubber, in percent and kPa."""
    lines = [
        f"{one.mode},{100 * (stretch - 1):.9g},{stress / 1e3:.9g}"
        for one in measured(KNOWN["mooney-rivlin"], noise=0.002)
        for stretch, stress in zip(one.stretch, one.stress, strict=True)
    ]
    file = tmp_path / "data.csv"
    file.write_text("\n".join(["test,strain [%],nominal stress [kPa]", *lines]))
    return file


def scene_with(table: dict) -> Scene:
    scene = tomllib.loads((ROOT / "scenes" / "draft.toml").read_text())
    return Scene.model_validate(scene | table)


def test_json_has_every_law_with_its_errors_and_the_chosen_one_as_a_scene_s_table(command, data):
    code, printed, _ = command(data, "--json")
    found = json.loads(printed)
    assert code == 0 and found["chosen"] == "mooney-rivlin" and found["stretches"] == [0.25, 2.0]
    assert (
        set(found) == {"file", "tests", "stretches", "chosen", "material", "laws", "doubts"} and found["doubts"] == []
    )
    assert [(one["test"], one["points"]) for one in found["tests"]] == [(mode, 60) for mode in MODES]
    assert [one["law"] for one in found["laws"]] == list(LAWS) and all(one["usable"] for one in found["laws"])
    assert pytest.approx(1e5, rel=0.01) == scene_with({"material": found["material"]}).material.C10
    second = found["laws"][1]
    assert set(second) == {
        *("law", "usable", "reason", "material", "shear_modulus", "young_modulus", "constrained"),
        *("residual", "left_out", "stability_lost"),
    }
    assert second["shear_modulus"] == pytest.approx(2.4e5, rel=0.01)
    assert set(second["left_out"]["tests"]) == set(MODES) and 0.001 < second["left_out"]["rms"] < 0.003


def test_tables_name_constants_with_units_errors_stability_and_the_range_of_the_data(command, data):
    code, printed, _ = command(data)
    assert code == 0 and "uniaxial, 60 points, stretch 1.02 to 2, peak" in printed
    assert re.search(r"^mooney-rivlin \(chosen\) .* 0\.\d+ % .* all$", printed, re.MULTILINE)
    assert re.search(r"^mooney-rivlin: C10 = \S+ kPa; C01 = \S+ kPa; D1 = \S+ 1/Pa$", printed, re.MULTILINE)
    assert "no data are below a principal stretch of 0.25 or above 2: a law is a guess there" in printed
    assert "D1 follows from nu = 0.499, which these tests do not measure" in printed
    assert "only extrapolates" not in printed


def test_one_kind_of_test_is_said_to_leave_other_loads_to_the_law(command):
    code, printed, _ = command(EXAMPLE)
    assert code == 0 and "all data are uniaxial: to other loads, such as shear, a law only extrapolates" in printed


def test_the_written_table_is_a_scene_s_material_with_its_source(command, data, tmp_path):
    file = tmp_path / "material.toml"
    file.write_text("of an earlier fit")
    assert command(data, "-o", file, "--nu", "0.495")[0] == 0
    text = file.read_text()
    law = scene_with(tomllib.loads(text)).material
    assert law.law == "mooney-rivlin" and law.stretches == [0.25, 2.0] and law.poisson == pytest.approx(0.495)
    assert "fit-material to data.csv" in text and re.search(r"residual \(rms\): 0\.\d+ % of the peak stress", text)
    assert "C10 = " in text and "# [Pa]" in text and "# [1/Pa], from nu = 0.495" in text


@pytest.mark.parametrize("name", LAWS)
def test_any_law_that_is_asked_for_is_written_so_that_scenes_accept_it(command, data, tmp_path, name):
    file = tmp_path / "material.toml"
    assert command(data, "--law", name, "--terms", "1", "-o", file)[0] == 0
    assert scene_with(tomllib.loads(file.read_text())).material.law == name


def test_the_picture_has_points_a_curve_of_each_law_and_hatches_beyond_the_data(command, data, tmp_path):
    assert command(data, "--plot", tmp_path / "fit.png")[0] == 0
    picture = imread(tmp_path / "fit.png")
    assert picture.shape[1] > 1000 and picture[..., :3].std() > 0.02
    panels = draw(compare(measured(KNOWN["mooney-rivlin"]))).axes
    assert [axes.get_title() for axes in panels] == list(MODES)
    for axes in panels:
        labels = [line.get_label() for line in axes.lines]
        assert labels == ["measured", "neo-hookean", "mooney-rivlin (chosen)", "yeoh", "ogden"]
        spans = sorted((patch.get_extents().x0, patch.get_hatch()) for patch in axes.patches)
        assert [hatch for _, hatch in spans] == ["///", "///"]
        low, high = axes.get_xlim()
        assert low < 0.9 and high > 2.2


def test_fewer_stretches_are_fitted_by_to(command, data):
    found = json.loads(command(data, "--to", "1.3", "--json")[1])
    assert found["stretches"][1] == pytest.approx(1.3, abs=0.02) and found["tests"][0]["points"] < 30


def test_where_no_law_is_usable_the_reason_is_printed_nothing_is_written_and_the_exit_code_is_3(command, tmp_path):
    gel = measured(NeoHookean(C1=1e5, D1=1e-8), ["uniaxial"])[0]
    rows = [f"{stretch},{stress / 1e4}" for stretch, stress in zip(gel.stretch, gel.stress, strict=True)]
    data, output = tmp_path / "gel.csv", tmp_path / "material.toml"
    data.write_text("\n".join(["uniaxial stretch [-],stress [Pa]", *rows]))
    code, printed, _ = command(data, "--law", "neo-hookean", "-o", output)
    assert code == 3 and not output.exists()
    assert "neo-hookean is refused: C1 must be at least 100 Pa, got 10.0" in printed and "no law is usable" in printed
    code, printed, _ = command(data, "--law", "neo-hookean", "--json")
    found = json.loads(printed)
    assert code == 3 and found["chosen"] is None and found["laws"][0]["reason"].startswith("C1 must be at least")


@pytest.mark.parametrize(
    ("words", "rule"),
    [
        (["none.csv"], "none.csv: No such file or directory"),
        ([EXAMPLE, "--test", "planar"], r"material.csv, line \d+: must name the test once, uniaxial"),
        ([EXAMPLE, "--law", "gent"], "law must be one of neo-hookean, mooney-rivlin, yeoh, ogden, got gent"),
        ([EXAMPLE, "--nu", "0.3"], "nu must be from 0.49 to 0.49999"),
        ([EXAMPLE, "--to", "1"], "to must be a stretch above 1, got 1"),
        ([EXAMPLE, "-o", EXAMPLE], "output must end in .toml and be in a folder that exists"),
        ([EXAMPLE, "-o", "nowhere/material.toml"], "output must end in .toml and be in a folder that exists"),
        ([EXAMPLE, "--plot", "fit.doc"], "plot must end in one of"),
        ([EXAMPLE, "--plot", "nowhere/fit.png"], "plot must be in a folder that exists"),
    ],
)
def test_bad_input_is_one_line_and_exit_code_2(command, words, rule):
    before = EXAMPLE.read_bytes()
    code, printed, said = command(*words)
    assert code == 2 and printed == "" and len(said.splitlines()) == 1 and re.search(rule, said)
    assert EXAMPLE.read_bytes() == before


def test_the_example_has_the_rubber_that_its_comment_names(command):
    comment = EXAMPLE.read_text().split("uniaxial")[0]
    named = {name: float(value) for name, value in re.findall(r"(C\d) = (\S+) kPa", comment)}
    found = json.loads(command(EXAMPLE, "--law", "yeoh", "--json")[1])
    law = found["material"]
    stress = {C: 1e3 * value for C, value in named.items()}
    assert list(stress) == ["C1", "C2", "C3"] and law["C1"] == pytest.approx(stress["C1"], rel=0.03)
    assert found["laws"][0]["left_out"]["rms"] < 0.015
