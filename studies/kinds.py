"""Scenes by what they name, and the forms that a model compiles for them."""

from __future__ import annotations

import dataclasses
from pathlib import Path
from typing import Any

from dolfinx import fem

from fingerfem import load_scene

SCENES = Path(__file__).resolve().parents[1] / "scenes"


def kinds() -> dict[str, dict[str, Any]]:
    """Scenes' tables by what they name."""
    one, two, four = (load_scene(SCENES / f"{name}.toml") for name in ("one_segment", "two_segments", "four_tendons"))
    table = one.model_dump()
    planar, alone = {"tendons": table["tendons"][:1]}, {"obstacle": None}
    straight = [table["tendons"][0] | {"path": "straight"}]
    nearly = {
        "law": "neo-hookean",
        "C1": 1.9e6,
        "D1": 3 * (1 - 2 * 0.4999) / (2 * 1.9e6 * 1.4999),
    }  # Poisson's ratio 0.4999
    return {
        "free, planar": table | planar | alone,
        "free, spatial": table | alone,
        "free, planar, straight tendon": table | alone | {"tendons": straight},
        "free, planar, nearly incompressible": table | planar | alone | {"material": nearly},
        "contact, planar": table | planar,
        "contact, spatial": table,
        "contact, planar, Nitsche": table | planar | {"obstacle": table["obstacle"] | {"method": "nitsche"}},
        "two segments, contact, planar": two.model_dump(),
        "two segments, four tensions, contact": four.model_dump(),
    }


def forms_of(model: Any) -> int:
    """Compiled forms in what a model holds."""
    if isinstance(model, fem.Form):
        return 1
    if isinstance(model, list):
        return sum(map(forms_of, model))
    if dataclasses.is_dataclass(model):
        return sum(forms_of(getattr(model, field.name)) for field in dataclasses.fields(model))
    return 0
