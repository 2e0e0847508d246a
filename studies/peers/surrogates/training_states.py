"""Part `training_states`: what other surrogates are trained on and tested with, and this project's model of the same.

Measured in the environment, as these states are solved there if no study has before.
"""

from __future__ import annotations

import time
from pathlib import Path

from rom.build import train
from rom.separated.alternating_directions import EnrichmentOptions
from rom.snapshots.snapshot_set import SnapshotSet
from rom.snapshots.training_states import read_training_states
from studies import sets
from studies.peers.surrogates import grid_states
from studies.peers.surrogates.states import LINES, QUICK_LINES, HeldOut, States
from studies.runner import Run, say

SCENE = "standard"
OPTIONS = EnrichmentOptions()


def without_fields(of: SnapshotSet) -> SnapshotSet:
    """The same set, its displacements not read: others are given tips and forces alone."""
    found = SnapshotSet(of.path)
    found.description = sets.without_store(found.description)
    return found


def states_of(training: SnapshotSet) -> States:
    """Values of a training set; its sensitivities have no place in what others learn from."""
    table = read_training_states(training)
    return States(
        tensions=table.free["parameters"][:, : table.tensions],
        free_tip=table.free["tip"],
        touch_distance=table.free["touch_distance"],
        parameters=table.contact["parameters"],
        reach=table.contact["touch_distance"],
        tip=table.contact["tip"],
        force=table.contact["contact_force"],
        lower=table.lower,
        upper=table.upper,
    )


def tested_of(held_out: SnapshotSet) -> HeldOut:
    """Held-out states, free and in contact."""
    return HeldOut(
        parameters=held_out.random("parameters"), tip=held_out.random("tip"), force=held_out.random("contact_force")
    )


def written(training: SnapshotSet, lines: int, folder: Path) -> dict:
    """The states of the first lines and this project's model of them, in files; how many, and what they cost."""
    some = sets.first_lines(training, lines)
    states = states_of(some)
    states.save(folder / f"states-{lines}.npz")
    begun = time.process_time()
    model = train(some, OPTIONS)
    seconds = time.process_time() - begun
    model.save(folder / f"ours-{lines}.h5")
    return {
        "lines": lines,
        "states": states.count,
        "free_states": len(states.tensions),
        "contact_states": len(states.parameters),
        "solving_core_seconds": some.core_seconds,
        "training_seconds": seconds,
    }


def measure(run: Run) -> dict:
    """Write the states, by number of lines, and the test states; say how many."""
    file = sets.scene(run.sets, SCENE, run.quick)
    training = without_fields(sets.training(file))
    held_out = sets.held_out(file, sets.QUICK_HELD_OUT if run.quick else sets.HELD_OUT)
    tested = tested_of(held_out)
    tested.save(run.folder / "tested.npz")
    rows = [written(training, lines, run.folder) for lines in (QUICK_LINES if run.quick else LINES)]
    for row in rows:
        say(row)
    return {
        "rows": rows,
        "test_states": len(tested.force),
        "test_contact_states": int((tested.force > 0).sum()),
        "grid_states": run.once("grid", grid_states.measure, run),
    }
