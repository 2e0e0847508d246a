"""The trained draft finger and the demo that tests share; `make test` makes them first, by TRAIN."""

import json
from dataclasses import replace
from pathlib import Path

import pytest
from hypothesis import settings

settings.register_profile("no clock", deadline=None, derandomize=True)  # tests assert properties, never seconds
settings.load_profile("no clock")

ROOT = Path(__file__).resolve().parents[1]
TRAIN = "make out/tests/ready"


@pytest.fixture(scope="session")
def trained() -> Path:
    """The folder of the draft finger's sets: training, heldout, finer."""
    folder = ROOT / "out" / "tests"
    if not (folder / "ready").exists():
        pytest.fail(f"these tests need the draft finger's sets: make test, or {TRAIN}")
    return folder


@pytest.fixture(scope="session")
def demo(trained) -> Path:
    """The folder of the demo on coarse meshes."""
    return trained / "demo"


@pytest.fixture(scope="session")
def report(demo) -> dict:
    return json.loads((demo / "report.json").read_text())


@pytest.fixture(scope="session")
def surrogate(trained):
    """As it errs on its own mesh: what the draft mesh errs by hides all else."""
    from rom import Surrogate

    found = Surrogate.load(trained / "finger.h5")
    return replace(found, errors=replace(found.errors, mesh=None))


@pytest.fixture(scope="session")
def held_out(trained):
    from rom.snapshots.snapshot_set import SnapshotSet

    return SnapshotSet(trained / "heldout")
