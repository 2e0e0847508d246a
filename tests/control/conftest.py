"""Controlled fingers: the bundled one, whose atlas takes seconds, and its table."""

import pytest

import rom
from control import Finger


@pytest.fixture(scope="session")
def rod_finger() -> Finger:
    return Finger(rom.load())


@pytest.fixture(scope="session")
def table_finger(table) -> Finger:
    return Finger(table)


@pytest.fixture(scope="session", params=["rod_finger", "table_finger"])
def finger(request) -> Finger:
    return request.getfixturevalue(request.param)
