"""The scene of the question, on any mesh."""

from __future__ import annotations

import tomllib
from typing import Any

from studies.peers.question import SCENE


def planar(along: int, across: int, order: int) -> dict[str, Any]:
    """The scene's table with F1 alone: half the finger is modelled, by symmetry."""
    table = tomllib.loads(SCENE.read_text())
    table["tendons"] = table["tendons"][:1]
    table["mesh"] = {"cells": [along, across], "order": order}
    table.pop("sampling", None)
    return table
