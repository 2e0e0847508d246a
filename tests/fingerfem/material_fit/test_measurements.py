"""Tests of rubber are read from CSV files; all other files are refused in one line with its number and the rule."""

import re

import numpy as np
import pytest

from fingerfem.material_fit.measurements import STRESS_UNITS, read_measurements

STRETCH = np.linspace(1.05, 2.0, 20)
STRESS = 2e5 * (STRETCH - STRETCH**-2)  # [Pa]
GOOD = [f"{stretch},{stress}" for stretch, stress in zip(STRETCH, STRESS, strict=True)]


def written(folder, lines, encoding="utf-8"):
    file = folder / "data.csv"
    file.write_text("\n".join(lines) + "\n", encoding)
    return file


def rows(stretch, stress, delimiter=","):
    return [f"{a:.12g}{delimiter}{b:.12g}" for a, b in zip(stretch, stress, strict=True)]


@pytest.mark.parametrize(
    ("header", "elongation", "stress"),
    [
        ("stretch [-],stress [Pa]", STRETCH, STRESS),
        ("strain [-],nominal stress [kPa]", STRETCH - 1, STRESS / 1e3),
        ("Engineering Strain (%),Engineering Stress (MPa)", 100 * (STRETCH - 1), STRESS / 1e6),
        ("strain [mm/mm],stress [N/mm2]", STRETCH - 1, STRESS / 1e6),
        ("stretch [%],stress [psi]", 100 * STRETCH, STRESS / 6894.757293168),
    ],
)
def test_strain_in_percent_and_stress_in_psi_are_the_same_test(tmp_path, header, elongation, stress):
    (one,) = read_measurements(written(tmp_path, [header, *rows(elongation, stress)]), test="uniaxial")
    assert one.mode == "uniaxial"
    assert one.stretch == pytest.approx(STRETCH, rel=1e-10) and one.stress == pytest.approx(STRESS, rel=1e-10)


def test_a_psi_is_a_pound_force_per_square_inch():
    assert STRESS_UNITS["psi"] == pytest.approx(0.45359237 * 9.80665 / 0.0254**2, rel=1e-12)


def test_comments_blank_lines_other_columns_and_decimal_commas_are_read_past(tmp_path):
    lines = [f"{k};{a:.6f};{b:.3f}".replace(".", ",") for k, (a, b) in enumerate(zip(STRETCH - 1, STRESS, strict=True))]
    file = written(
        tmp_path,
        ["# pulled by hand", "", "Time (s);uniaxial strain [-];stress [Pa]", *lines[:5], "", "# pause", *lines[5:]],
    )
    (one,) = read_measurements(file)
    assert one.stretch == pytest.approx(STRETCH, abs=1e-6) and one.stress == pytest.approx(STRESS, abs=1e-2)


def test_a_column_names_the_test_of_every_row_and_rows_may_have_any_order(tmp_path):
    lines = [f"{name},{row}" for row in reversed(GOOD) for name in ("Uniaxial", "pure shear", "biaxial")]
    found = read_measurements(written(tmp_path, ["test,stretch [-],stress [Pa]", *lines], "utf-8-sig"))
    assert [one.mode for one in found] == ["uniaxial", "planar", "equibiaxial"]
    assert all((np.diff(one.stretch) > 0).all() and one.stress == pytest.approx(STRESS) for one in found)
    assert found[0].peak == pytest.approx(STRESS[-1])


def test_stretches_up_to_one_are_read_in_tension_and_in_compression(tmp_path):
    stretch = np.concatenate([1 / STRETCH, STRETCH])
    file = written(tmp_path, ["uniaxial stretch [-],stress [Pa]", *rows(stretch, 2e5 * (stretch - stretch**-2))])
    (one,) = read_measurements(file, to=1.5)
    assert one.stretch[0] == pytest.approx(1 / 1.5, rel=0.05) and one.stretch[-1] == pytest.approx(1.5, rel=0.05)
    assert one.stretch.min() >= 1 / 1.5 and one.stretch.max() <= 1.5


def test_noise_of_the_other_sign_near_rest_is_no_fault(tmp_path):
    lines = ["1.001,-300.0", "1.0,200.0", *GOOD]  # of 3.5e5 Pa
    (one,) = read_measurements(written(tmp_path, ["uniaxial stretch [-],stress [Pa]", *lines]))
    assert len(one.stretch) == 22


HEADER = "uniaxial stretch [-],stress [kPa]"
REFUSED = {
    "no line": ([], "must have a line that names the columns, got no line"),
    "no unit": (
        ["uniaxial stretch,stress [kPa]", *GOOD],
        r"line 1: uniaxial stretch must name its unit in brackets, one of -,",
    ),
    "unknown unit": (
        ["uniaxial stretch [-],stress [bar]", *GOOD],
        r"line 1: stress \[bar\] must name its unit .* Pa, kPa, MPa",
    ),
    "true stress": (
        ["uniaxial stretch [-],true stress [kPa]", *GOOD],
        r"line 1: must name one column of a nominal stress, got true stress",
    ),
    "true strain": (
        ["uniaxial log strain [-],stress [kPa]", *GOOD],
        r"line 1: must name one column of a stretch or a nominal strain, got uniaxial log",
    ),
    "no stress": (
        ["uniaxial stretch [-],force [N]", *GOOD],
        r"one column of a nominal stress, got uniaxial stretch \[-\], force \[N\]",
    ),
    "two strains": (
        ["stretch [-],strain [-],stress [Pa]"],
        r"one column of a stretch or a nominal strain, got stretch \[-\], strain",
    ),
    "no test": (
        ["stretch [-],stress [kPa]", *GOOD],
        "must name the test once, uniaxial, .* got 0 of these",
    ),
    "two tests": (["test,uniaxial stretch [-],stress [kPa]", *GOOD], "must name the test once, .* got 2 of these"),
    "simple shear": (
        ["test,stretch [-],stress [kPa]", *(f"simple shear,{row}" for row in GOOD)],
        r"line 2: test must be uniaxial, equibiaxial, planar or pure shear \(planar\), got 'simple shear'",
    ),
    "endless cell": ([HEADER, "1" * 200_000], "line 2: must be cells of CSV, got field larger than field limit"),
    "no number": ([HEADER, *GOOD, "1.5,high"], r"line 22: stress must be a finite number, \[kPa\], got 'high'"),
    "NaN": ([HEADER, *GOOD, "nan,3.0"], r"line 22: stretch must be a finite number, \[-\], got 'nan'"),
    "infinite": ([HEADER, "2.0,inf", *GOOD], r"line 2: stress must be a finite number, \[kPa\], got 'inf'"),
    "few cells": ([HEADER, *GOOD, "1.5"], "line 22: must have at least 2 cells, got 1"),
    "decimal commas": ([HEADER, *GOOD, "1,5,3,0"], "line 22: must have 2 cells, .* got 4; decimal commas need tabs"),
    "no stretch": ([HEADER, *GOOD, "0.0,-5.0"], "line 22: stretch must be above 0.05 and below 20, got 0"),
    "negative stretch": ([HEADER, *GOOD, "-0.5,-5.0"], "line 22: stretch must be above 0.05 and below 20, got -0.5"),
    "percent as stretch": ([HEADER, "150,1.0", *GOOD], "line 2: stretch must be above 0.05 and below 20, got 150"),
    "few points": ([HEADER, *GOOD[:7]], "uniaxial test must have at least 8 different stretches, got 7"),
    "equal points": ([HEADER, *GOOD[:7], *GOOD[:7]], "uniaxial test must have at least 8 different stretches, got 7"),
    "no point": ([HEADER], "uniaxial test must have at least 8 different stretches, got 0"),
    "other sign": (
        [HEADER, *GOOD, "1.4,-90000"],
        r"line 22: stress must be above 0 in tension, .* got -9e\+07 Pa at a stretch of 1.4",
    ),
    "compression as positive": (
        ["uniaxial strain [-],stress [kPa]", *rows(1 / STRETCH - 1, STRESS)],
        "line 2: stress must be .* below 0 in compression",
    ),
    "stress at rest": (
        [HEADER, *GOOD, "1.0,90000"],
        r"line 22: stress must be .* 0 at rest, .* got 9e\+07 Pa at a stretch of 1$",
    ),
    "no load": ([HEADER, *rows(STRETCH, 0 * STRETCH)], "uniaxial test must have a stress, got 0 at all points"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_other_files_are_refused_in_one_line_with_file_line_rule_and_value(tmp_path, name):
    lines, rule = REFUSED[name]
    file = written(tmp_path, lines)
    with pytest.raises(ValueError, match=rule) as refusal:
        read_measurements(file)
    assert str(refusal.value).startswith(str(file)) and "\n" not in str(refusal.value)


def test_what_the_caller_adds_is_checked_too(tmp_path):
    file = written(tmp_path, ["stretch [-],stress [kPa]", *GOOD])
    with pytest.raises(ValueError, match=r"test must be uniaxial, .* got 'torsion'"):
        read_measurements(file, test="torsion")
    with pytest.raises(ValueError, match=r"to must be a stretch above 1, got 0.9"):
        read_measurements(file, test="uniaxial", to=0.9)
    with pytest.raises(ValueError, match="uniaxial test must have at least 8 different stretches, got 2"):
        read_measurements(file, test="uniaxial", to=1.12)


def test_what_is_no_text_file_is_refused_by_its_name(tmp_path):
    with pytest.raises(ValueError, match=re.escape(f"{tmp_path / 'none.csv'}: No such file")):
        read_measurements(tmp_path / "none.csv")
    (tmp_path / "picture.csv").write_bytes(b"\x89PNG\xff\xfe")
    with pytest.raises(ValueError, match=r"picture.csv: must be a CSV file in UTF-8, got"):
        read_measurements(tmp_path / "picture.csv")
    (tmp_path / "scene.toml").write_text('name = "x"\n')
    with pytest.raises(ValueError, match=r"scene.toml: must be a CSV file; it is a scene, for fingerfem solve"):
        read_measurements(tmp_path / "scene.toml")
