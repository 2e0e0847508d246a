"""Everything here needs DOLFINx."""

from pathlib import Path

import pytest

SCENES = Path(__file__).resolve().parents[2] / "scenes"


@pytest.fixture(scope="session")
def draft():
    from fingerfem import FingerModel, load_scene

    return FingerModel(load_scene(SCENES / "draft.toml"))


@pytest.fixture
def table() -> dict:
    """The draft scene as plain data, to be changed."""
    import tomllib

    return tomllib.loads((SCENES / "draft.toml").read_text())
