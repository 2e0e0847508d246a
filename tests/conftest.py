"""The trained draft finger that tests share; `make test` makes it first, by TRAIN."""

import json
from dataclasses import replace
from pathlib import Path

import pytest
from hypothesis import settings

settings.register_profile("no clock", deadline=None, derandomize=True)  # tests assert properties, never seconds
settings.load_profile("no clock")

ROOT = Path(__file__).resolve().parents[1]
TRAIN = "docker/run python3 studies/demo.py out/tests scenes/draft.toml"


@pytest.fixture(scope="session")
def demo() -> Path:
    folder = ROOT / "out" / "tests"
    if not (folder / "report.json").exists():
        pytest.fail(f"these tests need the trained draft finger: make test, or {TRAIN}")
    return folder


@pytest.fixture(scope="session")
def report(demo) -> dict:
    return json.loads((demo / "report.json").read_text())


@pytest.fixture(scope="session")
def surrogate(demo):
    """As it errs on its own mesh: what the draft mesh errs by hides all else."""
    from rom import Surrogate

    found = Surrogate.load(demo / "finger.h5")
    return replace(found, errors=replace(found.errors, mesh=None))


@pytest.fixture(scope="session")
def held_out(demo):
    from rom.snapshots.snapshot_set import SnapshotSet

    return SnapshotSet(demo / "heldout")
