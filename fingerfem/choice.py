"""Mesh, sampling and terms for an accuracy, a budget or a preset: from the measured front of speed against accuracy.

`studies/tradeoff.py` measures the front on the draft finger and writes front.json beside this module; docs/tradeoff.md
shows it. Other fingers get cells of the same shape, and as many lines of states a tension.
"""

from __future__ import annotations

import json
import re
from functools import cache
from pathlib import Path
from typing import Any

from fingerfem.durations import seconds

FRONT = Path(__file__).with_name("front.json")
KEYS = ("accuracy", "budget", "preset")
OF_MESH, OF_SAMPLING = ("cells", "order"), ("lines", "tension_nodes", "contact_nodes")
MEASURED_TENSIONS, SLENDERNESS = 2, 5.0  # of the finger the front was measured on; its length over its side [-]


@cache
def front() -> list[dict[str, Any]]:
    """What no other choice beats in both cost and error, cheapest first.

    Each has `cells`, `order`, `lines` [a tension], `tolerance`; `preset` if it is one; and as measured `contact_force`,
    `contact_force_of_mesh`, `contact_force_of_surrogate` (95 % of states, relative [-]), `core_seconds` [s], `states`.
    """
    return json.loads(FRONT.read_text())["choices"]


def chosen(table: dict[str, Any]) -> dict[str, Any]:
    """A scene's table with mesh, sampling and what to expect in place of its accuracy, budget or preset.

    Raises:
        ValueError: name, rule, value.
    """
    asked = [key for key in KEYS if table.get(key) is not None]
    if not asked:
        return table
    if len(asked) > 1:
        raise ValueError(f"{asked[1]} must be left out where {asked[0]} is given, got {table[asked[1]]!r}")
    for part, keys in (("mesh", OF_MESH), ("sampling", OF_SAMPLING)):
        for key in keys:
            if key in table.get(part, {}):
                raise ValueError(f"{part}.{key} must be left out where {asked[0]} chooses it, got {table[part][key]}")
    geometry, tensions = table.get("geometry", {}), len(table.get("tendons", []))
    one = _choice(asked[0], table[asked[0]])
    try:
        longest = max(geometry["segments"]) / geometry["side"] / SLENDERNESS
    except (KeyError, TypeError, ValueError, ZeroDivisionError):
        return table  # whatever is wrong with the geometry is told as such
    along, across = one["cells"]
    lines = max(3, round(one["lines"] * tensions))
    return table | {
        "mesh": table.get("mesh", {}) | {"cells": [max(round(along * longest), 3), across], "order": one["order"]},
        "sampling": table.get("sampling", {}) | {"lines": lines},
        "expected": {
            key: one[key]
            for key in (
                "contact_force",
                "contact_force_of_mesh",
                "contact_force_of_surrogate",
                "core_seconds",
                "states",
            )
        }
        | {"tolerance": one["tolerance"]},
    }


def _choice(key: str, value: Any) -> dict[str, Any]:
    choices = front()
    if key == "preset":
        named = {one["preset"]: one for one in choices if one.get("preset")}
        if value not in named:
            raise ValueError(f"preset must be one of {', '.join(named)}, got {value!r}")
        return named[value]
    if key == "accuracy":
        wanted = _share(value)
        found = [one for one in choices if one["contact_force"] <= wanted]
        if not found:
            best = min(one["contact_force"] for one in choices)
            raise ValueError(
                f'accuracy must be at least "{100 * best:.2g} %", the best that was measured, got "{value}"'
            )
        return min(found, key=lambda one: one["core_seconds"])
    budget = seconds("budget", value)
    found = [one for one in choices if one["core_seconds"] <= budget]
    if not found:
        least = min(one["core_seconds"] for one in choices)
        raise ValueError(
            f'budget must be at least "{least:.0f}s" of core time, the least that was measured, got "{value}"'
        )
    return min(found, key=lambda one: one["contact_force"])


def _share(text: Any) -> float:
    """A percentage such as "1 %" [-]."""
    match = re.fullmatch(r"\s*([0-9]*\.?[0-9]+)\s*%\s*", text) if isinstance(text, str) else None
    if match is None or not 0 < float(match[1]) <= 50:
        raise ValueError(f'accuracy must be a share such as "1 %", above 0 and at most 50 %, got {text!r}')
    return float(match[1]) / 100
