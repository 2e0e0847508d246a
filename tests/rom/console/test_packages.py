"""Without a package, every command works or names it and its source, in one line."""

import pytest
from plain_environment import OPTIONAL, commands, run_without

from rom.console.packages import REMEDIES, REQUIRED, MissingPackage, explained, require

SCENE, MODEL = "scenes/draft.toml", "rom/finger.h5"


@pytest.mark.parametrize(
    "program", ["control", *(pytest.param(one, marks=pytest.mark.long) for one in ("fingerfem", "rom"))]
)
def test_every_command_has_help_where_no_optional_package_is(program):
    for words in ([], *([name] for name in sorted(commands(program)))):
        done = run_without(OPTIONAL, program, *words, "--help")
        assert done.returncode == 0 and "Usage:" in done.stdout and done.stderr == "", done.stderr


def words_of(folder) -> dict[str, list[object]]:
    return {
        "certify": [MODEL, "F1=50"],
        "doctor": [],
        "fit-material": ["examples/material.csv"],
        "modes": [SCENE],
        "render": [SCENE, folder / "picture.png", "--case", "F1=50"],
        "retry": [folder / "no set"],
        "simulate": [SCENE, "examples/motion.toml", "-o", folder / "motion"],
        "sketch": [SCENE, folder / "picture.png"],
        "snapshots": [SCENE, folder / "set"],
        "solve": [SCENE, "F1=50"],
        "status": [folder / "no set"],
    }


def test_every_command_of_the_full_order_model_names_what_it_misses_in_one_line(tmp_path):
    assert words_of(tmp_path).keys() == commands("fingerfem")
    for command, words in words_of(tmp_path).items():
        done = run_without(OPTIONAL, "fingerfem", command, *words)
        if command == "doctor":  # lists all that is missing
            assert done.returncode == 3 and done.stderr == "" and "wrong  dolfinx" in done.stdout
            continue
        if command == "fit-material":  # needs none but what laws are read by
            assert done.returncode == 0 or done.stderr.startswith("pydantic is not installed"), done.stderr
            continue
        assert done.returncode == 2 and done.stdout == "", (command, done.stdout)
        (line,) = done.stderr.splitlines()
        if command in ("retry", "status"):  # need none of these
            assert "is not a snapshot set" in line
        else:
            assert line.split()[0].rstrip(":") in REMEDIES and "docker/run python3 -m fingerfem ..." in line, line
    assert list(tmp_path.iterdir()) == []


def test_models_and_controllers_need_no_optional_package(tmp_path):
    works = {
        "rom": [["info", MODEL], ["export", MODEL, tmp_path / "finger.h"]],
        "control": [["hold", "--distance", "0.01"], ["campaign", "--starts", "4"]],
    }
    for program, runs in works.items():
        for words in runs:
            done = run_without(OPTIONAL, program, *words)
            assert done.returncode == 0 and "Traceback" not in done.stderr, done.stderr


PROGRAMS = {"fingerfem": ["solve", SCENE], "rom": ["info", MODEL], "control": ["campaign"]}


@pytest.mark.parametrize(
    ("program", "package"), [*((one, "typer") for one in PROGRAMS), *(("control", one) for one in REQUIRED)]
)
def test_a_package_that_pip_installs_is_named_too(program, package):
    done = run_without([package], program, *PROGRAMS[program])
    assert done.returncode == 2, done.stderr
    (line,) = done.stderr.splitlines()
    assert line.startswith(f"{package} is not installed: pip install -e . installs it"), line


@pytest.mark.parametrize("package", ["mujoco", "gymnasium"])
def test_a_script_that_imports_an_optional_part_gets_the_command_that_installs_it(package):
    module = {"mujoco": "control.mujoco", "gymnasium": "control.environment"}[package]
    done = run_without([package], module)
    assert done.returncode == 1
    assert done.stderr.splitlines()[-1].endswith(f"{package} is not installed: pip install -e '.[{package}]'")


def test_a_package_that_does_not_load_says_why():
    broken = ImportError("libdolfinx.so: cannot open shared object file", name="dolfinx.cpp")
    assert explained(broken) == (
        "dolfinx does not load (libdolfinx.so: cannot open shared object file): "
        "docker/run python3 -m fingerfem ... has it"
    )
    anonymous = {"__name__": "dolfinx.fem"}
    with pytest.raises(ImportError) as caught:
        exec("raise ImportError('its dependencies are broken\\nin two lines')", anonymous)
    assert str(explained(caught.value)).startswith("dolfinx does not load (its dependencies are broken): ")
    assert explained(ImportError("cannot import name 'x'", name="rom.separated")) is None  # a fault of this project
    with pytest.raises(MissingPackage, match="no_such_package is not installed"):
        require("numpy", "no_such_package")
