"""The states that other packages are given, from the draft finger's grid."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from scipy.interpolate import CubicSpline

from rom.build import train
from rom.held_out import FELT, split
from rom.snapshots.snapshot_set import SnapshotSet
from rom.surrogate import Surrogate
from studies import sets
from studies.runner import Run
from studies.surrogate.accuracy import OPTIONS, draft_sets


def states_for_others(file: Path, training: SnapshotSet, tested: SnapshotSet, model: Surrogate) -> None:
    """Write what other packages are given: states with parameters scaled to [0, 1], and the grid."""
    parameters, force = training.states_of("contact", "parameters"), training.states_of("contact", "contact_force")
    outputs, touching = np.column_stack([training.states_of("contact", "tip"), force]), force > 0
    points, true = tested.random("parameters"), tested.random("contact_force")
    felt = true > FELT
    description, lead = training.description, training.description.lead
    (other,) = description.other_axes
    onset = CubicSpline(description.tension_nodes[other], training.onset())(points[:, other])
    reach, (lower, upper) = model.evaluate(points).touch_distance, model.limits
    aligned = points.copy()
    aligned[:, lead] = (points[:, lead] - onset) / (upper[lead] - onset)
    aligned[:, -1] = (reach - points[:, -1]) / (reach - lower[-1])
    axes: dict[str, Any] = {f"nodes_{k}": np.array(nodes) for k, nodes in enumerate(description.tension_nodes)}
    axes[f"nodes_{lead}"] = np.array(description.onset_nodes)
    axes[f"nodes_{description.tensions}"] = np.array(description.contact_nodes)
    np.savez(
        file,
        parameters=(parameters[touching] - lower) / (upper - lower),
        outputs=outputs[touching],
        grid=np.concatenate([training.contact("tip"), training.contact("contact_force")[..., None]], axis=-1),
        points=points[felt],
        scaled=((points - lower) / (upper - lower))[felt],
        aligned=np.clip(aligned, 0, np.append(upper[:-1], 1))[felt],
        force=true[felt],
        **axes,
    )


def measure(run: Run) -> dict[str, int]:
    """Write the states and this project's model of them, for others.py."""
    training = sets.training(sets.scene(run.sets, "draft grid"))
    model, tested = train(training, OPTIONS), split(draft_sets(run)[1])[1]
    model.save(run.folder / "others.h5")
    states_for_others(run.folder / "others.npz", training, tested, model)
    return {"training_states": training.states, "test_states": len(tested.random("contact_force"))}
