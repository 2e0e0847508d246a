"""Everything here needs DOLFINx."""

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


@pytest.fixture(scope="session")
def scene(tmp_path_factory) -> Path:
    """The draft finger, coarser and on fewer nodes, for the farm."""
    text = (ROOT / "scenes" / "draft.toml").read_text().split("[sampling]")[0]
    text = text.replace("cells = [20, 5]", "cells = [10, 5]")
    file = tmp_path_factory.mktemp("scene") / "small.toml"
    file.write_text(text + "\n[sampling]\ntension_nodes = 4\ncontact_nodes = 4\n")
    return file


@pytest.fixture(scope="session")
def undisturbed(scene, tmp_path_factory) -> Path:
    """The set that one rank makes of it when nothing happens."""
    folder = tmp_path_factory.mktemp("sets") / "undisturbed"
    run(1, scene, folder)
    return folder
