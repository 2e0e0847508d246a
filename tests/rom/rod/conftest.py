"""The map of a rod, fitted once."""

import pytest

from tests.rom.rod import kirchhoff as rod


@pytest.fixture(scope="session")
def rod_fit():
    return rod.fitted()


@pytest.fixture(scope="session")
def segment(rod_fit):
    return rod_fit[0]
