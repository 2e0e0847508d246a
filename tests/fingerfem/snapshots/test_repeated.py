"""States that a set holds twice are one state: left out of a fit, each would be found in its twin."""

import numpy as np
import pytest
from farm import ROOT, run

from rom.build import train
from rom.separated.alternating_directions import EnrichmentOptions
from rom.snapshots.snapshot_set import SnapshotSet
from studies.extremes.data import as_it_is, rewritten


@pytest.mark.parametrize("apart", [pytest.param(0.0, marks=pytest.mark.long), 3e-10])
def test_a_set_of_every_state_twice_makes_the_model_of_the_set(apart, tmp_path):
    text = (ROOT / "scenes" / "draft.toml").read_text().split("[sampling]")[0].replace("[20, 5]", "[10, 5]")
    (tmp_path / "lines.toml").write_text(f"{text}\n[sampling]\nlines = 8\ncontact_nodes = 6\n")
    run(2, tmp_path / "lines.toml", tmp_path / "lines")
    once = rewritten(SnapshotSet(tmp_path / "lines"), "once", as_it_is)

    def nearly(name: str, values: np.ndarray) -> np.ndarray:
        return values if name == "regime" else values * (1 + apart)

    twice = rewritten(once, "twice", as_it_is, nearly)
    assert twice.states == 2 * once.states
    for kind in ("free", "contact"):
        assert np.array_equal(twice.states_of(kind, "tip"), once.states_of(kind, "tip"))
    points = np.random.default_rng(0).random((200, 3)) * [100, 100, 0.03] + [0, 0, 0.001]
    ours, theirs = (train(one, EnrichmentOptions(tolerance=1e-2)).evaluate(points) for one in (once, twice))
    assert np.array_equal(ours.contact_force, theirs.contact_force) and np.array_equal(ours.tip, theirs.tip)
