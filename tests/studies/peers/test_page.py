"""Alternatives are held against the reference, and what they do not answer is counted."""

import pytest

from studies.peers.page import errors
from studies.peers.question import CONTACT, FREE, Answers, finger


def answers(scale: float, **instead) -> dict:
    """Answers that are off by a factor everywhere."""
    given = {
        "free_tips": [[-0.002 * scale, 0.010 * scale, 0.0] for _ in FREE],
        "contact_tips": [[-0.001 * scale, 0.005 * scale, 0.0] for _ in CONTACT],
        "contact_forces": [2.0 * scale for _ in CONTACT],
    }
    fixed = {"name": "someone", "kind": "beam", "seconds": 1e-3 * scale, "settings": "", "limits": ""}
    return Answers(**given | fixed | instead).as_json()


@pytest.mark.parametrize("scale", [1.0, 0.9, 1.2])
def test_errors_are_relative_to_the_reference(scale):
    found = errors(answers(scale), answers(1.0))
    for quantity in ("free_tips", "contact_tips", "contact_forces"):
        assert found[quantity] == pytest.approx({"median": abs(scale - 1), "max": abs(scale - 1)})
    assert found["missing_free"] == found["missing_contact"] == []


def test_states_without_an_answer_are_counted_once_and_do_not_flatter():
    forces, tips = [None, *[2.0 * 1.1] * (len(CONTACT) - 1)], [None, *[[-0.001, 0.005, 0.0]] * (len(CONTACT) - 1)]
    found = errors(answers(1.0, contact_forces=forces, contact_tips=tips), answers(1.0))
    assert found["missing_contact"] == [0] and found["contact_forces"]["median"] == pytest.approx(0.1)
    none = errors(answers(1.0, contact_forces=[None] * len(CONTACT)), answers(1.0))
    assert none["contact_forces"] is None and none["missing_contact"] == []


def test_the_finger_is_the_one_of_the_scene_file():
    shape = finger()
    # E and Poisson's ratio of the paper's constants, C1 = 1.9 MPa and D1 = 2.43e-7 1/Pa.
    assert shape.young == pytest.approx(9.88e6, rel=1e-3) and shape.poisson == pytest.approx(0.300, abs=1e-3)
    assert shape.offset < shape.side / 2 and shape.plate < shape.length
