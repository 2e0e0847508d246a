"""What a snapshot set holds: scene, parameters and nodes, from which follow its tasks."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from itertools import product
from typing import Any

import numpy as np

FORMAT = 2  # of snapshot sets


@dataclass(frozen=True, kw_only=True)
class Description:
    """What a set holds; equal descriptions hold equal numbers.

    Attributes:
        scene: the scene as plain data, with its fingerprint.
        parameters: name, unit, lower and upper of each, tensions first, then d.
        lead: index of the lead tension.
        tension_nodes: nodes of every tension [N].
        onset_nodes: nodes of the lead tension between onset (0) and its highest (1) [-].
        contact_nodes: nodes of the plane's way between touch (0) and its nearest (1) [-].
        random: held-out parameters, shape (count, p); empty for a training set.
    """

    scene: dict[str, Any]
    fingerprint: str
    parameters: list[dict[str, Any]]
    lead: int
    tension_nodes: list[list[float]]
    onset_nodes: list[float]
    contact_nodes: list[float]
    random: list[list[float]]
    versions: dict[str, str]
    format: int = FORMAT

    @property
    def has_obstacle(self) -> bool:
        """Whether the scene has a plane."""
        return self.parameters[-1]["name"] == "d"

    @property
    def stored(self) -> list[str]:
        """Quantities stored besides those that always are."""
        return self.scene["sampling"]["store"]

    @property
    def has_field(self) -> bool:
        """Whether the displacement of all nodes is stored."""
        return "displacement" in self.stored

    @property
    def tensions(self) -> int:
        """Number of tensions."""
        return len(self.parameters) - self.has_obstacle

    @cached_property
    def others(self) -> list[tuple[float, ...]]:
        """Every combination of nodes of the tensions that do not lead [N]."""
        return list(product(*[nodes for k, nodes in enumerate(self.tension_nodes) if k != self.lead]))

    @cached_property
    def tasks(self) -> list[str]:
        """Names of all tasks; a task only ever needs tasks before it."""
        if self.random:
            return [f"random-{k}" for k in range(len(self.random))]
        free = [f"free-{j}" for j in range(len(self.others))]
        if not self.has_obstacle:
            return free
        return free + [f"contact-{j}-{i}" for j in range(len(self.others)) for i in range(len(self.onset_nodes))]

    def insert_lead(self, others: tuple[float, ...], lead: float) -> np.ndarray:
        """Tensions [N] from the others and the lead."""
        return np.insert(np.array(others, float), self.lead, lead)
