"""control as a person at a terminal sees it: 80 columns, a bar, Ctrl-C."""

import sys

from terminal import shown

CONTROL = [sys.executable, "-m", "control"]


def test_hold_and_campaign_fit_the_window(table_file):
    for words in (["hold", str(table_file), "--distance", "0.01"], ["campaign", str(table_file)]):
        seen = shown([*CONTROL, *words])
        assert seen.code == 0 and "converged" in seen.text and "{" not in seen.text
        assert bool([bar for bar in seen.bars if "holding" in bar]) == (words[0] == "campaign")
        seen.assert_readable()


def test_ctrl_c_ends_a_campaign_in_one_line(table_file):
    seen = shown([*CONTROL, "campaign", str(table_file), "--starts", "10000000"], interrupt_at="holding")
    seen.assert_interrupted("stopped by Ctrl-C; nothing was written, the same command begins again")


def test_answers_are_tables_with_units(table_file):
    words = {
        ("reach", str(table_file), "0.0", "-0.2", "0.0"): (
            3,
            ["unreachable", "off the target", " mm", " N"],
        ),
        ("grasp", str(table_file)): (0, ["force [N]", "radius 12.000 mm"]),
    }
    for said, (code, parts) in words.items():
        seen = shown([*CONTROL, *said])
        text = " ".join(seen.text.split())
        assert seen.code == code and all(part in text for part in parts), text
        seen.assert_readable()
