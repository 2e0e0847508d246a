"""A small grid set of numbers that are drawn: one tendon before a plane."""

from pathlib import Path

import numpy as np
import pytest

from rom.dataset import schema
from rom.dataset.body import RestBody, body_file
from rom.dataset.description import Description
from rom.dataset.folder import create
from rom.dataset.snapshot_set import write_task

NODES = 4
BODY = RestBody(
    nodes=np.array([[0.0, 0, 0], [0.05, 0, 0]]),
    sections=np.array([0.0, 0.05]),
    plates=np.array([[0.049, 0.05]]),
    half_lengths=np.array([0.0005, 0.005, 0.005]),
    is_half=False,
)


def described(**changes) -> Description:
    nodes = np.linspace(0, 1, NODES).tolist()
    parts = {
        "scene": {"tendons": [{}], "sampling": {"store": ["displacement"]}},
        "fingerprint": "drawn",
        "parameters": [
            {"name": "F1", "unit": "N", "lower": 0.0, "upper": 1.0},
            {"name": "d", "unit": "m", "lower": 0.001, "upper": 0.03},
        ],
        "lead": 0,
        "tension_nodes": [nodes],
        "contact_nodes": nodes,
        "random": [],
        "scattered": [],
        "versions": {},
    }
    return Description(**parts | changes)


def drawn(states: int, random: np.random.Generator) -> dict[str, np.ndarray]:
    """States with an answer; their numbers are drawn."""
    sizes = schema.sizes(segments=1, sections=2, tendons=1, actuators=1, nodes=2)
    blanks = schema.blanks({"state", "obstacle", "displacement"}, sizes, 2)
    return {name: random.random((states, *blank.shape)).astype(blank.dtype) for name, blank in blanks.items()} | {
        "parameters": random.random((states, 2)),
        "iterations": np.ones(states, int),
        "converged": np.ones(states, bool),
        "reason": np.full(states, ""),
        "last_good": np.full((states, 2), np.nan),
        "nodes": np.arange(states),
        "seconds": np.array(1.0),
    }


@pytest.fixture
def grid_set(tmp_path) -> Path:
    """The set's folder; at the lowest tension it does not reach the plane."""
    folder, description, random = tmp_path / "grid", described(), np.random.default_rng(0)
    create(folder, description)
    BODY.write(body_file(folder))
    for task, line in description.lines.items():
        arrays = drawn(0 if task == "contact-0-0" else len(line.nodes), random)
        write_task(folder, task, description.fingerprint, arrays)
    return folder
