"""rom as a person at a terminal sees it: 80 columns, bars, sentences, Ctrl-C."""

import sys

import pytest
from terminal import ran, shown

ROM = [sys.executable, "-m", "rom"]
NOTHING = "stopped by Ctrl-C; nothing was written, the same command begins again"


def test_build_shows_its_progress(trained, tmp_path):
    model, sets = tmp_path / "finger.h5", [str(trained / "training"), "--held-out", str(trained / "heldout")]
    seen = shown([*ROM, "build", *sets, "-o", str(model)])
    assert seen.code == 0 and model.exists()
    seen.assert_readable()
    for step in ("separating the samples", "checking on held-out states"):
        assert [bar for bar in seen.bars if step in bar], seen.text


def test_check_shows_a_bar_with_colours_unless_these_are_not_wanted(grid_file, trained):
    command = [*ROM, "check", str(grid_file), str(trained / "heldout")]
    for settings, colours in (({}, True), ({"NO_COLOR": "1"}, False)):
        seen = shown(command, **settings)
        assert seen.code == 0 and seen.bars and seen.coloured == colours
        assert "within estimate" in seen.text and "touch is decided correctly in" in seen.text
        seen.assert_readable()


def test_in_a_pipe_there_are_no_bars_and_no_control_sequences(grid_file, trained):
    done = ran("rom", "check", grid_file, trained / "heldout")
    assert done.returncode == 0 and "\x1b" not in done.stdout + done.stderr and "━" not in done.stderr


def test_bad_input_is_one_sentence_that_is_broken_between_words(tmp_path):
    seen = shown([*ROM, "build", str(tmp_path), "-o", str(tmp_path / "no such folder" / "finger.h5")])
    assert seen.code == 2
    assert "output must be in a folder that exists" in " ".join(seen.text.split())


@pytest.mark.parametrize("times", [1, 3])
def test_ctrl_c_ends_build_in_one_line_and_leaves_no_file(trained, tmp_path, times):
    command = [*ROM, "build", str(trained / "training"), "-o", str(tmp_path / "finger.h5")]
    shown(command, interrupt_at="separating", times=times).assert_interrupted(NOTHING)
    assert not list(tmp_path.iterdir())
