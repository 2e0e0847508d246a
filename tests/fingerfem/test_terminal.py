"""Output on a terminal of the full-order model, the farm and the demo, also after Ctrl-C."""

import re
import shutil
import sys
from pathlib import Path

import pytest
from farm import assert_same, command, run
from terminal import shown

from rom.dataset.snapshot_set import read_description, task_file

FARM = [sys.executable, "-m", "fingerfem", "snapshots"]
LEFT = 12  # lines of states that are to be solved: enough for a bar to show some of them, however fast they are
KEPT = "solved states are kept; run the same command again"
DEMO = """
import sys
from pathlib import Path
from rom.console.interruption import interruptible

interruptible("demo: stopped")
from studies.demo import farm

farm(sys.argv[2], Path(sys.argv[1]))
"""


def counts(bars: set[str]) -> set[str]:
    return {found[0] for bar in bars if (found := re.search(r"\d+/\d+", bar))}


@pytest.fixture
def begun(undisturbed, tmp_path) -> Path:
    """The small scene's set without its last lines of states."""
    folder = tmp_path / "set"
    shutil.copytree(undisturbed, folder)
    for task in contacts(folder)[-LEFT:]:
        task_file(folder, task).unlink()
    return folder


def contacts(folder: Path) -> list[str]:
    return [task for task in read_description(folder).lines if task.startswith("contact")]


def unfinished(folder: Path) -> str:
    """Texts of a bar before all lines that were left are solved, from none on: they take tenths of a second."""
    total = len(list(folder.glob("tasks/*.npz"))) + LEFT
    return "|".join(f" {total - k}/{total} " for k in range(1, LEFT + 1))


def nothing_is_left_over(folder: Path) -> bool:
    return not list((folder / "attempts").iterdir()) and not [*folder.glob("tasks/.*"), *folder.glob("claimed/*")]


@pytest.mark.long
def test_under_mpirun_the_farm_s_bar_moves_while_it_works(scene, undisturbed, begun):
    words = [word for word in command(2, scene, begun, "--progress", "bar") if word != "--json"]
    seen = shown(words)
    assert seen.code == 0 and len(counts(seen.bars)) > 2, seen.text
    seen.assert_readable()
    assert_same(begun, undisturbed)


@pytest.mark.long
def test_the_demo_s_own_call_of_the_farm_shows_a_bar(scene, undisturbed, begun):
    seen = shown([sys.executable, "-c", DEMO, str(begun), str(scene)], FINGERFEM_RANKS="2")
    assert seen.code == 0 and len(counts(seen.bars)) > 2, seen.text
    seen.assert_readable()
    assert_same(begun, undisturbed)


@pytest.mark.long
def test_ctrl_c_stops_the_demo_s_call_in_one_line_and_the_next_completes_the_set(scene, undisturbed, begun):
    words = [sys.executable, "-c", DEMO, str(begun), str(scene)]
    seen = shown(words, interrupt_at=unfinished(begun), FINGERFEM_RANKS="2")
    seen.assert_interrupted("demo: stopped")
    assert seen.raw.rfind("\x1b[?25h") > seen.raw.rfind("\x1b[?25l")  # the cursor is back
    assert shown(words, FINGERFEM_RANKS="2").code == 0
    assert_same(begun, undisturbed)


@pytest.mark.long
def test_ctrl_c_drops_the_line_at_hand_and_is_no_death(scene, undisturbed, begun):
    words = [*FARM, str(scene), str(begun)]
    shown(words, interrupt_at=unfinished(begun), times=3).assert_interrupted(f"stopped by Ctrl-C: {KEPT}")
    assert nothing_is_left_over(begun)
    run(1, scene, begun)
    assert_same(begun, undisturbed)


def test_ctrl_c_ends_mpirun_without_noise_and_the_next_completes_the_set(scene, undisturbed, begun):
    words = command(2, scene, begun, "--progress", "bar")
    seen = shown(words, interrupt_at=unfinished(begun))
    assert seen.code != 0  # mpirun's own
    seen.assert_readable()
    said = [line.strip() for line in seen.after_interrupt]
    # mpirun kills ranks a quarter of a second after it asks them to end; they are seldom too late.
    assert said in ([], [f"stopped by Ctrl-C or SIGTERM: {KEPT}"])
    run(2, scene, begun)
    assert_same(begun, undisturbed)


@pytest.mark.long
def test_ctrl_c_ends_the_demo_in_one_line(tmp_path):
    seen = shown([sys.executable, "studies/demo.py", str(tmp_path), "--quick"], interrupt_at=" [1-9]/12 ")
    seen.assert_interrupted(f"demo: stopped by Ctrl-C: {KEPT}")


def test_solve_fits_the_window_and_ctrl_c_ends_it_in_one_line(scene):
    seen = shown([sys.executable, "-m", "fingerfem", "solve", str(scene), "F1=50", "d=0.005"])
    assert seen.code == 0 and "contact force" in seen.text
    seen.assert_readable()
    fine = f"echo begun; exec {sys.executable} -m fingerfem solve scenes/two_segments.toml F_s=40 F_l=40 d=0.005"
    seen = shown(["sh", "-c", fine], interrupt_at="begun", pause=2.0)
    seen.assert_interrupted("stopped by Ctrl-C; nothing was written, the same command begins again")


@pytest.mark.long
def test_in_ascii_states_bars_and_names_are_plain(scene, undisturbed, begun, tmp_path):
    named = tmp_path / "named.toml"
    named.write_text(scene.read_text().replace('name = "', 'name = "Prüfling µ ', 1))
    for words in (["solve", str(named), "F1=10", "d=0.005"], ["status", str(undisturbed)]):
        seen = shown([sys.executable, "-m", "fingerfem", *words], PYTHONIOENCODING="ascii")
        assert seen.code == 0 and seen.raw.isascii() and "encode" not in seen.text, seen.text
    seen = shown([*FARM, str(scene), str(begun), "--progress", "bar"], PYTHONIOENCODING="ascii")
    assert seen.code == 0 and seen.raw.isascii() and "states/s" in seen.text, seen.text
    words = [word for word in command(2, scene, tmp_path / "new", "--progress", "bar") if word != "--json"]
    seen = shown(words, PYTHONIOENCODING="ascii")
    assert seen.code == 0 and seen.raw.isascii(), seen.text
    assert_same(begun, undisturbed)


LONG = """
import sys, time
from types import SimpleNamespace as Some
from pathlib import Path
from fingerfem.snapshots.progress import Reporter

plan = Some(lines=range(12345), rounds=[Some(error=0.0123)] * 9)
description, folder = Some(refines=True), Path(sys.argv[1])
ledger = Some(
    plan=plan, outcomes=range(11111), failures=range(123), states=0, path=folder, description=description,
    refresh=lambda: setattr(ledger, "states", ledger.states + 1),
)
with Reporter(ledger) as report:
    report()
    time.sleep(0.05)
"""


@pytest.mark.long
def test_the_bar_of_a_long_refined_set_fits_the_window(tmp_path):
    seen = shown([sys.executable, "-c", LONG, str(tmp_path)])
    assert seen.code == 0
    seen.assert_readable()
    assert [bar for bar in seen.bars if "11111/12345" in bar and "123 failed" in bar and "error 1.2 %" in bar], (
        seen.text
    )
