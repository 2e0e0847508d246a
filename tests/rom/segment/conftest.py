"""The map of a rod, fitted once."""

import pytest

from tests.rom.segment import rod


@pytest.fixture(scope="session")
def rod_fit():
    return rod.fitted()


@pytest.fixture(scope="session")
def segment(rod_fit):
    return rod_fit[0]
