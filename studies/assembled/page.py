"""A sum for the table of docs/accuracy.md."""

from __future__ import annotations

from pathlib import Path


def prepare(found: dict, folder: Path) -> dict:
    """Adds the number of planes that touched rubber."""
    return {"rubber": sum(row["planes"]["rubber"] for row in found["fingers"]["fingers"])}
