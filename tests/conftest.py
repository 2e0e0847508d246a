"""Fixtures of all tests: the bundled finger, its table before the plane, and fingers that `make test` trains first."""

import json
import os
import time
from pathlib import Path

import pytest
from hypothesis import settings

settings.register_profile("no clock", deadline=None, derandomize=True)  # tests assert properties, never seconds
settings.load_profile("no clock")

ROOT = Path(__file__).resolve().parents[1]
TRAIN = "make out/tests/ready"
UNTIL = "FINGERFEM_TESTS_UNTIL"  # variable with a time [s since 1970], see .ci/run


@pytest.hookimpl(tryfirst=True)
def pytest_runtest_setup():
    """Skip, and so count, tests that would begin too late; ranks of an MPI job might not agree on the time."""
    if time.time() > float(os.environ.get(UNTIL, "inf")) and "OMPI_COMM_WORLD_SIZE" not in os.environ:
        pytest.skip("the time of this run is over")


@pytest.hookimpl(trylast=True)
def pytest_collection_modifyitems(items: list[pytest.Item]):
    """Begin at another file every hour where late tests are skipped, so that none is skipped always."""
    if UNTIL in os.environ:
        files = list(dict.fromkeys(item.path for item in items))
        first = 37 * int(float(os.environ[UNTIL]) // 3600) % max(len(files), 1)  # the same for all processes of a run
        order = {file: (k - first) % len(files) for k, file in enumerate(files)}
        items.sort(key=lambda item: order[item.path])


@pytest.fixture(scope="session")
def model():
    """The bundled finger before its plane."""
    import rom

    return rom.load()


@pytest.fixture(scope="session")
def rod(model):
    """The bundled finger alone."""
    return model.rod


@pytest.fixture(scope="session")
def table():
    """The bundled finger's table before the plane y = side/2 + d, of few nodes."""
    from sampled import tabled

    return tabled(0.004, nodes=10)


@pytest.fixture(scope="session")
def table_file(table, tmp_path_factory) -> Path:
    """The table as a model file."""
    table.save(file := tmp_path_factory.mktemp("table") / "table.h5")
    return file


@pytest.fixture(scope="session")
def models(model, table):
    """Exported models, by name."""
    from assembled import two_segments

    return {"rod": model, "table": table, "two_segments": two_segments()}


@pytest.fixture(scope="session")
def chambered():
    """An elastic rod with a tendon and two chambers, as a finger of one segment."""
    from rom.elements.fitting import training
    from rom.rod.rod import Rod
    from tests.rom.elements import chambered_rod

    elements = training.train(chambered_rod.states(14, 0), {}, highest=3.0)
    return Rod(elements=elements, scene=chambered_rod.scene())


@pytest.fixture(scope="session")
def trained() -> Path:
    """The folder of the draft finger's sets: training, heldout; for long tests also finer."""
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
def held_out(trained):
    from rom.dataset.snapshot_set import SnapshotSet

    return SnapshotSet(trained / "heldout")
