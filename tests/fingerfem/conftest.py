"""Everything here needs DOLFINx."""

import subprocess
from pathlib import Path

import pytest
from farm import ROOT, run

SCENES = ROOT / "scenes"


@pytest.fixture(scope="session")
def draft():
    from fingerfem import FingerModel, load_scene

    return FingerModel(load_scene(SCENES / "draft.toml"))


@pytest.fixture
def table() -> dict:
    """The draft scene as plain data, to be changed."""
    import tomllib

    return tomllib.loads((SCENES / "draft.toml").read_text())


def small(folder: Path, text: str) -> Path:
    """A scene on few nodes, for the farm."""
    file = folder / "small.toml"
    file.write_text(text.split("[sampling]")[0] + "[sampling]\ntension_nodes = 4\ncontact_nodes = 4\n")
    return file


@pytest.fixture(scope="session")
def scene(tmp_path_factory) -> Path:
    """Half a coarse finger with tendons on both sides, for the farm: soon solved."""
    text = (SCENES / "draft.toml").read_text().replace("cells = [20, 5]", "cells = [9, 5]")
    text = text.replace("offset = [0.0, 0.004]", "offset = [-0.004, 0.0]")
    first, second, rest = text.split("[0.0, 100.0]")
    return small(tmp_path_factory.mktemp("scene"), f"{first}[0.0, 50.0]{second}[0.0, 10.0]{rest}")


@pytest.fixture(scope="session")
def spatial(tmp_path_factory) -> Path:
    """The draft finger on fewer cells and nodes, for what bends in all directions."""
    text = (SCENES / "draft.toml").read_text().replace("cells = [20, 5]", "cells = [10, 5]")
    return small(tmp_path_factory.mktemp("spatial"), text)


@pytest.fixture(scope="session")
def undisturbed(scene, tmp_path_factory) -> Path:
    """The set that one rank makes of it when nothing happens."""
    folder = tmp_path_factory.mktemp("sets") / "undisturbed"
    run(1, scene, folder)
    return folder


@pytest.fixture(scope="session")
def hostile(tmp_path_factory) -> str:
    library = tmp_path_factory.mktemp("hostile") / "hostile.so"
    source = Path(__file__).with_name("hostile.c")
    subprocess.run(["gcc", "-shared", "-fPIC", "-o", str(library), str(source), "-ldl"], check=True)
    return str(library)


@pytest.fixture(scope="session")
def touched(tmp_path_factory):
    """The draft finger's rod before the plane, trained up to 3 N."""
    from rom import TouchedSegment
    from rom.dataset.snapshot_set import SnapshotSet
    from rom.elements.fitting.training import train
    from rom.elements.samples.section_states import read_section_states
    from rom.rod.objects.shapes import facing_plane
    from rom.rod.rod import Rod

    folder = tmp_path_factory.mktemp("touched")
    head, rest = (ROOT / "scenes" / "draft.toml").read_text().split("[obstacle]")
    mesh = rest[rest.index("[mesh]") :].split("[sampling]")[0]
    file = folder / "pressed.toml"
    file.write_text(f"{head}[load]\nforce = 3.0\n\n{mesh}[sampling]\nlines = 20\n")
    run(2, file, folder / "training")
    states = read_section_states(SnapshotSet(folder / "training"))
    rod = Rod(elements=train(states, {}), scene=states.scene)
    return TouchedSegment(rod=rod, obstacle=facing_plane(2 * rod.half_lengths[1], (0.001, 0.031)))
