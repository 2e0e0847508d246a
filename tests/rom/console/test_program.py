"""Commands print what fits the encoding of their output, and messages name the files that were asked for."""

import os
import resource
import subprocess
import sys

import pytest
from terminal import ROOT, shown

from rom.console.program import one_line

SMALL = 4096  # [bytes] of the largest file that may be written
COMMANDS = {
    "rom info": ["info", "rom/finger.h5"],
    "rom check": ["check", "rom/finger.h5", "{}/heldout"],
    "control hold": ["hold", "--distance", "0.01"],
    "control reach": ["reach", "rom/finger.h5", "0", "-0.001", "0"],
    "control grasp": ["grasp"],
    "control campaign": ["campaign", "--starts", "4"],
}
PLAIN = {"µ": "u", "±": "+-"}


@pytest.mark.parametrize("code", [130, 143])
def test_an_error_on_the_way_out_does_not_change_the_exit_code_of_a_signal(code):
    with pytest.raises(SystemExit) as ended, one_line():
        try:
            raise SystemExit(code)
        finally:
            raise ValueError("the archive must be closed")
    assert ended.value.code == code


def test_a_warning_is_one_line():
    program = "import warnings; from rom.console.program import begin; begin(); warnings.warn('a guess', stacklevel=1)"
    done = subprocess.run([sys.executable, "-c", program], cwd=ROOT, capture_output=True, text=True)
    assert done.returncode == 0 and done.stderr == "a guess\n"


def command(name, trained) -> list[str]:
    words = [word.format(trained) for word in COMMANDS[name]]
    return [sys.executable, "-m", name.split()[0], *words]


def printed(name, trained, encoding: str) -> str:
    settings = os.environ | {"PYTHONIOENCODING": encoding}
    done = subprocess.run(command(name, trained), cwd=ROOT, env=settings, capture_output=True)
    assert b"encode" not in done.stderr and b"Traceback" not in done.stderr, done.stderr
    assert done.returncode in (0, 3), done.stderr
    return done.stdout.decode(encoding)


@pytest.mark.parametrize(
    "name",
    [one if one in ("rom check", "control hold") else pytest.param(one, marks=pytest.mark.long) for one in COMMANDS],
)
def test_in_ascii_a_command_prints_the_same_in_plain_characters(trained, name):
    ours, theirs = printed(name, trained, "ascii"), printed(name, trained, "utf-8")
    for character, plain in PLAIN.items():
        theirs = theirs.replace(character, plain)
    assert ours.isascii() and len(ours.splitlines()) == len(theirs.splitlines())
    if name != "control campaign":  # which prints times
        assert ours.split() == theirs.split()


def test_in_ascii_columns_stand_under_their_headers(trained):
    lines = printed("control hold", trained, "ascii").splitlines()
    (k,) = [k for k, line in enumerate(lines) if line.startswith("contact force")]
    header = next(line for line in reversed(lines[:k]) if "+- error" in line)
    end = header.index("+- error") + len("+- error")
    assert lines[k][end - 1].isdigit() and lines[k][end : end + 3] == "   "


@pytest.mark.parametrize("name", ["rom check", "rom info", "control campaign"])
def test_on_a_terminal_bars_and_boxes_are_plain_too(trained, name):
    seen = shown(command(name, trained), PYTHONIOENCODING="ascii")
    assert seen.code == 0 and "encode" not in seen.text, seen.text
    assert seen.raw.isascii(), [one for one in seen.raw if not one.isascii()]
    assert "---" in seen.text


def limited(*words: object) -> subprocess.CompletedProcess[str]:
    """A command that cannot write a large file."""
    return subprocess.run(
        [sys.executable, "-m", *map(str, words)],
        cwd=ROOT,
        capture_output=True,
        text=True,
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (SMALL, SMALL)),
    )


@pytest.mark.parametrize(
    "words",
    [
        ["rom", "assemble", "scenes/draft.toml", "rom/finger.h5", "-o", "{}/finger.h5"],
        ["control", "export", "rom/finger.h5", "{}/finger.html"],
        ["rom", "export", "rom/finger.h5", "{}/finger.h"],
    ],
    ids=lambda words: words[1],
)
def test_a_file_that_cannot_be_written_is_named_as_it_was_asked_for_and_leaves_nothing(tmp_path, words):
    done = limited(*(word.format(tmp_path) for word in words))
    assert done.returncode == 2, done.stderr
    assert done.stderr.splitlines()[-1] == f"[Errno 27] File too large: '{words[-1].format(tmp_path)}'"
    assert "Traceback" not in done.stderr and list(tmp_path.iterdir()) == []
