"""Shared code of command lines: strict JSON, exit codes, and one line for bad input."""

import json
from pathlib import Path

import pytest
import typer

from rom.console.command_line import application, check_parts, run
from rom.console.table import show
from rom.files.atomic_file import check_folder

NAN, INF = float("nan"), float("inf")


def test_json_is_strict_at_any_depth_and_has_its_exit_code(capsys):
    result = {"a": NAN, "b": [INF, -INF, 1.5, {"c": [NAN, "nan", None, True]}], "d": {"e": {"f": 0.1 + 0.2}}}
    with pytest.raises(SystemExit) as ended:
        show(result, ["for people"], as_json=True, code=3)
    out = capsys.readouterr().out
    refused = {"parse_constant": lambda name: pytest.fail(f"{name} is no JSON")}
    found = json.loads(out, **refused)
    assert ended.value.code == 3 and out.count("\n") == 1
    assert found == {"a": None, "b": [None, None, 1.5, {"c": [None, "nan", None, True]}], "d": {"e": {"f": 0.1 + 0.2}}}


def test_people_get_the_lines_and_no_json(capsys):
    with pytest.raises(SystemExit) as ended:
        show({"a": 1}, ["one line", "and another"], as_json=False)
    assert capsys.readouterr().out == "one line\nand another\n" and ended.value.code == 0


def test_of_a_check_only_what_was_found_is_said():
    assert check_parts({}) == [] and check_parts({"marked": 0}) == []
    touch = {"count": 50, "wrong": 3, "wrong_beyond_margin": 2, "margin": 2.5e-5}
    decided, *others = check_parts({"touch": touch})
    assert (
        decided == "touch is decided correctly in 47 of 50 states; 2 of 3 wrong ones are farther than 25 µm from touch"
    )
    right = check_parts({"marked": 4, "covered": 0.954, "touch": touch | {"wrong": 0}})
    assert right[0].startswith("4 states are outside") and right[1].startswith("95% of the contact forces")
    assert right[2] == "touch is decided correctly in 50 of 50 states" and not others


@pytest.mark.parametrize("error", [ValueError("size must be above 0, got -1"), OSError(28, "No space left", "a.h5")])
def test_bad_input_is_one_line_on_stderr_and_ends_with_code_2(capsys, error):
    def app() -> None:
        raise error

    with pytest.raises(SystemExit) as ended:
        run(app)
    out, said = capsys.readouterr()
    assert ended.value.code == 2 and out == "" and said.count("\n") == 1 and str(error) in said


def test_a_mistake_of_the_program_is_no_bad_input():
    def app() -> None:
        raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        run(app)
    assert isinstance(application(), typer.Typer)


def test_a_file_in_a_folder_that_there_is_not_is_refused_before_anything_is_done(tmp_path):
    check_folder(tmp_path / "a.h5")
    check_folder(Path("a.h5"))
    for wrong in (tmp_path / "nowhere" / "a.h5", Path(__file__) / "a.h5"):
        with pytest.raises(ValueError, match="output must be in a folder that exists, got"):
            check_folder(wrong)
