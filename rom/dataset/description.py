"""Contents of a snapshot set: scene, parameters and nodes, which determine its first tasks."""

import hashlib
import json
from collections.abc import Collection
from dataclasses import dataclass, field
from functools import cached_property
from itertools import groupby, product
from typing import Any

import numpy as np

from rom.brief import brief
from rom.dataset.actuators import count_of

FORMAT = 8  # of snapshot sets
FORMER = 7  # of which held-out sets and those of scenes with a load are as they are now, but for another key
# Keys of a scene that change none of the finger's answers.
NOT_OF_THE_FINGER = ("name", "sampling", "expected", "coarse", "accuracy", "budget", "preset")


def difference(wanted: Any, found: Any, ignored: Collection[str] = NOT_OF_THE_FINGER, key: str = "") -> str:
    """The first key in which two scenes differ, with both values, in words; empty if they do not differ.

    Args:
        wanted: a scene or a part of one, as plain data.
        found: the other one.
        ignored: keys of the scene that may differ.
        key: of the part; empty for a scene.
    """
    if isinstance(wanted, dict) and isinstance(found, dict):
        names = [name for name in wanted | found if name not in ignored]
        parts = [(f"{key}.{name}".lstrip("."), wanted.get(name), found.get(name)) for name in names]
    elif isinstance(wanted, list) and isinstance(found, list) and len(wanted) == len(found):
        parts = [(f"{key}.{k}", one, other) for k, (one, other) in enumerate(zip(wanted, found, strict=True))]
    else:
        return "" if wanted == found else f"{key} must be {wanted}, got {found}"
    return next(filter(None, (difference(one, other, (), name) for name, one, other in parts)), "")


@dataclass(frozen=True)
class Line:
    """The states of one task, solved in their order.

    Attributes:
        kind: free (along the lead tension), contact (along the contact path), pressed (a free state and pressed ones,
            at tensions of its own) or random (held-out states of the same tensions).
        index: what it holds fixed, as positions: of the other tensions' combination; and for contact of the lead
            tension's node. A number of its own for pressed and random lines.
        nodes: positions along the line, of `tension_nodes[lead]` or of `contact_nodes`; of a random line in `random`;
            of a pressed line 0 for the free state, then 1 and so on in its `wrenches`.
        tensions: of a pressed line [N].
    """

    kind: str
    index: tuple[int, ...]
    nodes: tuple[int, ...]
    tensions: tuple[float, ...] = ()


@brief
@dataclass(frozen=True, kw_only=True)
class Description:
    """Contents of a snapshot set; sets with equal descriptions hold equal numbers.

    Attributes:
        scene: the scene as plain data, with its fingerprint.
        parameters: name, unit, lower and upper of each: tensions, pressures, then d or the wrenches' components.
        lead: index of the lead tension.
        tension_nodes: nodes of every tension [N].
        contact_nodes: nodes of the contact path between touch (0) and its nearest (1) [-].
        random: held-out parameters, shape (count, p); empty for a training set.
        scattered: tensions of the lines of a scene with a load, shape (lines, tensions) [N]; empty for a grid.
        wrenches: of these lines, on the plates in their own frames, shape (lines, states, 6 plates) [N, N m].
        begins_with: how many of these lines a set has at first to which more are added, in their order; 0 has all.
    """

    scene: dict[str, Any]
    fingerprint: str
    parameters: list[dict[str, Any]]
    lead: int
    tension_nodes: list[list[float]]
    contact_nodes: list[float]
    random: list[list[float]]
    scattered: list[list[float]]
    versions: dict[str, str]
    wrenches: list[list[list[float]]] = field(default_factory=list)
    begins_with: int = 0
    format: int = FORMAT

    @property
    def has_obstacle(self) -> bool:
        """True if the scene has a plane."""
        return self.parameters[-1]["name"] == "d"

    @property
    def stored(self) -> list[str]:
        """Quantities stored besides those that always are."""
        return self.scene["sampling"]["store"]

    @property
    def has_field(self) -> bool:
        """True if the displacement of all nodes is stored."""
        return "displacement" in self.stored

    @property
    def actuators(self) -> int:
        """Number of tensions and pressures."""
        return count_of(self.scene)

    @property
    def has_load(self) -> bool:
        """True if wrenches press on the scene's plates."""
        return self.scene.get("load") is not None

    @cached_property
    def others(self) -> list[tuple[float, ...]]:
        """Every combination of nodes of the tensions that do not lead [N]."""
        return list(product(*[self.tension_nodes[k] for k in self.other_axes]))

    @property
    def held_out_id(self) -> str:
        """A hash of the held-out parameters, which identifies these states; empty for a training set."""
        text = json.dumps([self.fingerprint, self.random])
        return hashlib.sha256(text.encode()).hexdigest()[:16] if self.random else ""

    @property
    def refines(self) -> bool:
        """True if lines are added round by round."""
        return self.begins_with > 0

    @cached_property
    def lines(self) -> dict[str, Line]:
        """The first lines by the names of their tasks; a task only ever needs tasks before it."""
        if self.random:
            return {f"random-{k}": Line("random", (k,), nodes) for k, nodes in enumerate(self._held_out_lines())}
        if self.wrenches:
            return {f"pressed-{k}": self.pressed_line(k) for k in range(self.begins_with or len(self.wrenches))}
        others, contact = range(len(self.others)), tuple(range(len(self.contact_nodes)))
        lines = {f"free-{j}": Line("free", (j,), tuple(range(len(self.tension_nodes[self.lead])))) for j in others}
        if self.has_obstacle:
            for j, i in product(others, range(len(self.tension_nodes[self.lead]))):
                lines[f"contact-{j}-{i}"] = Line("contact", (j, i), contact)
        return lines

    def _held_out_lines(self) -> list[tuple[int, ...]]:
        """Positions of the held-out points that follow each other at the same tensions."""
        together = groupby(range(len(self.random)), lambda k: self.random[k][: self.actuators])
        return [tuple(points) for _, points in together]

    def has(self, line: Line) -> bool:
        """True if a line can be added to this set: it is one of its sequence of pressed lines."""
        return (
            line.kind == "pressed"
            and 0 <= line.index[0] < len(self.wrenches)
            and line == self.pressed_line(line.index[0])
        )

    def pressed_line(self, k: int) -> Line:
        """The k-th line of a free state and pressed ones."""
        return Line("pressed", (k,), tuple(range(1 + len(self.wrenches[k]))), tuple(self.scattered[k]))

    @property
    def other_axes(self) -> list[int]:
        """Positions of the tensions that do not lead."""
        return [k for k in range(self.actuators) if k != self.lead]

    @property
    def tasks(self) -> list[str]:
        """Names of the first tasks."""
        return list(self.lines)

    def insert_lead(self, others: tuple[float, ...], lead: float) -> np.ndarray:
        """Tensions, shape (tensions,) [N], from the others and the lead."""
        return np.insert(np.array(others, float), self.lead, lead)
