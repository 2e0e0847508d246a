"""A command that is given a file of another kind names what takes that file; and what is named takes it."""

import shutil
from pathlib import Path

import pytest
from terminal import ROOT
from typer.testing import CliRunner

from control.__main__ import app as control
from control.export.page import write as write_page
from rom.__main__ import app as rom
from rom.export.c_header import export
from rom.export.fmu.archive import pack
from rom.files.file_kinds import (
    FMU,
    HEADER,
    HELD_OUT_SET,
    OLD,
    PAGE,
    ROD,
    SCENE,
    SEPARATED,
    SURROGATE,
    TRAINING_SET,
    Kind,
    kind_of,
    uses_of,
)
from rom.rod.touched_segment import SHIPPED

PROGRAMS = {"rom": rom, "control": control}
# Words of every command that takes a file, by its name in the table; {} is the file, OUT a folder.
COMMANDS = {
    "rom info": ["info", "{}"],
    "rom check": ["check", "{}", "HELDOUT"],
    "rom check SET/": ["check", "MODEL", "{}"],
    "rom assemble": ["assemble", "SCENE", "{}", "-o", "OUT/assembled.h5"],
    "rom assemble SCENE": ["assemble", "{}", "FINGER", "-o", "OUT/assembled.h5"],
    "rom specialise": ["specialise", "{}", "-o", "OUT/table.h5"],
    "rom export .h": ["export", "{}", "OUT/finger.h"],
    "rom export .fmu": ["export", "{}", "OUT/finger.fmu"],
    "rom build": ["build", "{}", "-o", "OUT/model.h5"],
    "rom build --held-out": ["build", "TRAINING", "-o", "OUT/model.h5", "--held-out", "{}"],
    "control reach": ["reach", "{}", "0.0", "-0.001", "0.0"],
    "control hold": ["hold", "{}", "--distance", "0.01"],
    "control grasp": ["grasp", "{}"],
    "control calibrate": ["calibrate", "{}", "LOG"],
    "control campaign": ["campaign", "{}", "--starts", "4"],
    "control export .html": ["export", "{}", "OUT/finger.html"],
    "control export .fmu": ["export", "{}", "OUT/finger.fmu"],
}
SLOW = (
    "rom build",
    "rom build --held-out",
    "rom export .fmu",
    "rom check SET/",
    "rom specialise",
    "control campaign",
    "control export .fmu",
)  # whose success other tests have
KINDS = (SEPARATED, SURROGATE, ROD, OLD, TRAINING_SET, HELD_OUT_SET, SCENE, FMU, HEADER, PAGE)


@pytest.fixture(scope="module")
def files(trained, grid_model, tmp_path_factory) -> dict[str, Path]:
    """One file of every kind."""
    folder = tmp_path_factory.mktemp("files")
    grid_model.save(folder / "table.h5")
    (folder / "surrogate.h5").write_bytes(b"fingerfem surrogate, format 4, sha256 0\n")
    shutil.copy(SHIPPED, folder / "finger.h5")
    (folder / "old.h5").write_bytes(b"fingerfem segment map, format 3, sha256 0\n")
    export(grid_model, folder / "finger.h")
    pack({"modelDescription.xml": b"<fmiModelDescription/>"}, folder / "finger.fmu")
    write_page(grid_model, folder / "finger.html")
    shutil.copy(ROOT / "scenes" / "draft.toml", folder / "draft.toml")
    found = {
        SEPARATED: folder / "table.h5",
        SURROGATE: folder / "surrogate.h5",
        ROD: folder / "finger.h5",
        OLD: folder / "old.h5",
        TRAINING_SET: trained / "training",
        HELD_OUT_SET: trained / "heldout",
        SCENE: folder / "draft.toml",
        FMU: folder / "finger.fmu",
        HEADER: folder / "finger.h",
        PAGE: folder / "finger.html",
    }
    return {kind.name: file for kind, file in found.items()}


def accepts(kind: Kind, command: str) -> bool:
    """True if a command takes a kind; a set is the second word of `rom check`, a scene the first of two."""
    if command in ("rom check", "rom check SET/"):
        return (kind in (TRAINING_SET, HELD_OUT_SET)) == (command == "rom check SET/") and "rom check" in kind.uses
    if command in ("rom assemble", "rom assemble SCENE"):
        return (kind is SCENE) == (command == "rom assemble SCENE") and "rom assemble" in kind.uses
    return command in kind.uses


@pytest.mark.parametrize("kind", KINDS, ids=lambda kind: kind.name)
def test_a_file_is_recognised(files, kind):
    assert kind_of(files[kind.name]) is kind and uses_of(files[kind.name]).endswith(f"for {', '.join(kind.uses)}")


def test_what_is_none_of_the_project_s_is_of_no_kind(tmp_path):
    (tmp_path / "thesis.tex").write_text("\\documentclass")
    (tmp_path / "finger.fmu").write_text("no archive")
    for path in (tmp_path, tmp_path / "thesis.tex", tmp_path / "finger.fmu", tmp_path / "nothing"):
        assert kind_of(path) is None and uses_of(path) == ""


@pytest.mark.parametrize("command", COMMANDS)
@pytest.mark.parametrize("kind", KINDS, ids=lambda kind: kind.name)
def test_a_command_takes_a_file_or_says_what_takes_it(files, trained, tmp_path, kind, command):
    if command in SLOW and accepts(kind, command):
        return
    named = {
        "HELDOUT": files["a held-out set"],
        "MODEL": files["a separated model"],
        "TRAINING": files["a training set"],
    }
    named["LOG"] = ROOT / "examples" / "log.csv"
    named |= {"SCENE": files["a scene"], "FINGER": files["a finger of rod elements"]}
    words = [
        str(named.get(word, word.replace("{}", str(files[kind.name])).replace("OUT/", f"{tmp_path}/")))
        for word in COMMANDS[command]
    ]
    done = CliRunner().invoke(PROGRAMS[command.split()[0]], words)
    if accepts(kind, command):
        assert done.exception is None or done.exit_code in (0, 3), done.exception
    else:
        assert isinstance(done.exception, ValueError) and "\n" not in str(done.exception)
        assert str(done.exception).endswith(uses_of(files[kind.name])), done.exception


@pytest.mark.parametrize("command", ["rom info", "control hold", "control export .html"])
@pytest.mark.parametrize("old", [OLD, SURROGATE], ids=lambda kind: kind.name)
def test_an_old_file_is_refused_with_how_to_make_it_anew(files, tmp_path, command, old):
    words = [word.replace("{}", str(files[old.name])).replace("OUT/", f"{tmp_path}/") for word in COMMANDS[command]]
    done = CliRunner().invoke(PROGRAMS[command.split()[0]], words)
    assert isinstance(done.exception, ValueError) and "\n" not in str(done.exception)
    assert str(done.exception).endswith(old.uses[0]) and "rom build SET/" in old.uses[0]


def test_an_export_of_another_ending_names_those_that_there_are(files, tmp_path):
    done = CliRunner().invoke(rom, ["export", str(files["a separated model"]), str(tmp_path / "finger.html")])
    assert str(done.exception) == (
        f"output must be named .h or .fmu, got {tmp_path / 'finger.html'}; control export writes .html"
    )
    assert not list(tmp_path.iterdir())
