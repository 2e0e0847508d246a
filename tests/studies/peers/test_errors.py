"""Alternatives are held against the reference, and what they do not answer is counted."""

import pytest

from studies.peers.errors import apart, compared, errors, orders, rest
from studies.peers.question import CONTACT, FREE, Answers, finger


def answers(scale: float, **told) -> dict:
    """What someone answers who is off by a factor everywhere."""
    given = {
        "free_tips": [[-0.002 * scale, 0.010 * scale, 0.0] for _ in FREE],
        "contact_tips": [[-0.001 * scale, 0.005 * scale, 0.0] for _ in CONTACT],
        "contact_forces": [2.0 * scale for _ in CONTACT],
    }
    fixed = {"name": "someone", "kind": "beam", "seconds": 1e-3 * scale, "settings": "", "limits": ""}
    return Answers(**given | fixed | told).as_json()


@pytest.mark.parametrize("scale", [1.0, 0.9, 1.2])
def test_errors_are_relative_to_the_reference(scale):
    found = errors(answers(scale), answers(1.0))
    for quantity in ("free_tips", "contact_tips", "contact_forces"):
        assert found[quantity] == pytest.approx({"median": abs(scale - 1), "max": abs(scale - 1)})
    assert found["missing"] == 0


def test_states_without_an_answer_are_counted_and_do_not_flatter():
    forces = [None, *[2.0 * 1.1] * (len(CONTACT) - 1)]
    found = errors(answers(1.0, contact_forces=forces), answers(1.0))
    assert found["missing"] == 1 and found["contact_forces"]["median"] == pytest.approx(0.1)
    assert errors(answers(1.0, contact_forces=[None] * len(CONTACT)), answers(1.0))["contact_forces"] is None


def test_times_are_multiples_of_the_fastest():
    rows = compared([answers(1.0), answers(4.0)], answers(1.0))
    assert [row["times"] for row in rows] == pytest.approx([1.0, 4.0])


def test_the_finger_is_the_one_of_the_scene_file():
    shape = finger()
    # E and Poisson's ratio of the paper's constants, C1 = 1.9 MPa and D1 = 2.43e-7 1/Pa.
    assert shape.young == pytest.approx(9.88e6, rel=1e-3) and shape.poisson == pytest.approx(0.300, abs=1e-3)
    assert shape.offset < shape.side / 2 and shape.plate < shape.length


@pytest.mark.parametrize("order", [2.0, 3.0])
def test_the_order_of_convergence_is_found_from_three_meshes(order):
    meshes = []
    for cells in ([10, 4], [20, 8], [50, 20]):
        off = 0.1 * (10 / cells[0]) ** order
        meshes.append(answers(1.0 + off, refinement=[{"cells": cells, "order": 2}]))
    assert list(orders(meshes).values()) == pytest.approx([order] * 3)
    assert apart(meshes[0], meshes[2])["tip"] == pytest.approx(1.1 / (1 + 0.1 * 5**-order) - 1)
    truth = apart(meshes[2], answers(1.0))["tip"]
    assert rest(meshes[1], meshes[2], order)["tip"] == pytest.approx(truth, rel=0.02)
