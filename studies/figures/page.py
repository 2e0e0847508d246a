"""The pictures of docs/figures.md, from the study's folder."""

from __future__ import annotations

import shutil
from pathlib import Path

from studies.runner import DOCS


def prepare(found: dict, folder: Path) -> dict:
    """Copy them."""
    for name in found["figures"]:
        shutil.copy(folder / f"{name}.png", DOCS)
    return {}
