"""Mesh and lines of states for an accuracy, a budget or a preset: from the measured front of speed against accuracy.

`studies/tradeoff` measures the front with rod elements of the draft finger, its page writes front.json beside this
module, and docs/speed.md shows it. Other fingers get cells of the same shape and more lines of states for more
tensions. The cost is scaled by cells and lines. The error is promised for the law of rubber and up to the number of
tensions that it was measured with, without weight. A scene without a load gets the mesh alone: its sampling is its own,
and its cost is not known.
"""

import json
import math
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

from fingerfem.scene.amounts import percentage, seconds

FRONT = Path(__file__).with_name("front.json")
KEYS = ("accuracy", "budget", "preset")
OF_MESH: tuple[str, ...] = ("cells", "order")
OF_LINES: dict[str, tuple[str, ...]] = {
    "sampling": ("lines", "tension_nodes", "contact_nodes"),
    "coarse": (*OF_MESH, "lines"),
}
TENSIONS, SLENDERNESS = 2, 5.0  # of the finger the front was measured on; its length over its side [-]
LAW = "neo-hookean"  # of its rubber
# By number of tensions: lines of states over those of one tension, and errors of fingers of elements over those of two.
# Products of polynomials grow faster than tensions. More tensions than errors here have no promise.
GROWTH, ERRORS = (1.0, 2.0, 4.0, 8.0), (1.0, 1.0, 1.0, 2.0)
LINES = 3  # the fewest a scene may ask for
LONGEST, PLAIN = 1e6, {"cells": [20, 5]}  # no finger is longer [-]; cells of a scene that is to be refused


@cache
def front() -> list[dict[str, Any]]:
    """The presets, and what no other choice beats in both cost and error of the contact force; cheapest first.

    Each has `cells`, `order`, `lines` [a tension]; `coarse`, `cells` and `order` of the mesh at whose states its own
    begin, or None; `preset`, its name or None; and as measured `contact_force` and `displacement` (error of the finger
    of elements, 95th percentile, relative [-]), `core_seconds` [s], `states`.
    """
    return json.loads(FRONT.read_text())["rods"]


def chosen(table: dict[str, Any], fitting: Callable[[int], int]) -> dict[str, Any]:
    """A scene's table with mesh, sampling and what to expect in place of its accuracy, budget or preset.

    Args:
        table: the scene as it was written.
        fitting: the fewest cells across, from a number on, that fit this finger.

    Raises:
        ValueError: name, rule, value.
    """
    asked = [key for key in KEYS if table.get(key) is not None]
    if not asked:
        return table
    if len(asked) > 1:
        raise ValueError(f"{asked[1]} must be left out where {asked[0]} is given, got {table[asked[1]]!r}")
    pressed = bool(table.get("load"))
    parts = {"mesh": OF_MESH} | (OF_LINES if pressed else {})
    if not all(isinstance(table.get(part, {}), dict) for part in parts):
        return table  # its check reports it
    _check_left_out(table, parts, asked[0])
    try:
        segments, tensions = table["geometry"]["segments"], len(table["tendons"])
        longest, bodies = max(segments) / table["geometry"]["side"] / SLENDERNESS, len(segments)
    except (KeyError, TypeError, ValueError, ZeroDivisionError):
        longest = math.nan
    if not 0 < longest < LONGEST:
        return table | {"mesh": PLAIN}  # their checks report what is wrong with finger or tendons
    quantity = "contact_force" if pressed or table.get("obstacle") else "displacement"
    choices = [_fitted(one, longest, fitting, bodies, tensions, quantity) for one in front()]
    unmeasured = _unmeasured(table, tensions)
    if asked[0] == "accuracy" and unmeasured:
        raise ValueError(
            f"accuracy must be left out with {unmeasured}, whose errors are not measured "
            f"(preset or budget choose a mesh, rom build estimates the error), got {table['accuracy']!r}"
        )
    one = _choice(asked[0], table[asked[0]], choices)
    if unmeasured:
        one["expected"]["error"] = None
    scene = table | {"mesh": table.get("mesh", {}) | {key: one[key] for key in OF_MESH}}
    if not pressed:
        return scene | {"expected": {key: one["expected"][key] for key in ("quantity", "error")}}
    return (
        scene
        | {"sampling": table.get("sampling", {}) | {"lines": one["lines"]}, "expected": one["expected"]}
        | ({"coarse": one["coarse"]} if one["coarse"] else {})
    )


def _unmeasured(table: dict[str, Any], tensions: int) -> str:
    """Part of a scene that the front was not measured with; empty if its error is promised."""
    material = table.get("material")
    law = material.get("law", LAW) if isinstance(material, dict) else LAW
    if tensions > len(ERRORS):
        return f"more than {len(ERRORS)} tendons"
    if table.get("gravity"):
        return "gravity"
    return "" if law == LAW else f'material.law = "{law}"'


def _check_left_out(table: dict[str, Any], parts: dict[str, tuple[str, ...]], by: str) -> None:
    """Refuse keys, by part of a scene, that its accuracy, budget or preset chooses."""
    for part, keys in parts.items():
        for key in keys:
            if key in table.get(part, {}):
                raise ValueError(f"{part}.{key} must be left out where {by} chooses it, got {table[part][key]}")


def _lines(per_tension: float, tensions: int) -> int:
    """Lines of states for a number of tensions, from those per tension with two."""
    growth = GROWTH[tensions - 1] if tensions <= len(GROWTH) else GROWTH[-1] * tensions / len(GROWTH)
    return max(LINES, round(per_tension * growth))


def _fitted(
    one: dict[str, Any], longest: float, fitting: Callable[[int], int], bodies: int, tensions: int, quantity: str
) -> dict[str, Any]:
    """A measured choice on another finger, with what to expect of it."""
    cells, coarse = _cells(one, longest, fitting), one["coarse"]
    lines = _lines(one["lines"], tensions)
    more_lines = lines / (one["lines"] * TENSIONS)
    more_cells = cells[0] * bodies / one["cells"][0] * (cells[1] / one["cells"][1]) ** 2
    return {
        "cells": cells,
        "order": one["order"],
        "lines": lines,
        "coarse": coarse and {"cells": _cells(coarse, longest, fitting), "order": coarse["order"]},
        "preset": one["preset"],
        "expected": {
            "quantity": quantity,
            "error": one[quantity] * (ERRORS[tensions - 1] if tensions <= len(ERRORS) else 1.0),
            "core_seconds": one["core_seconds"] * more_lines * more_cells,
            "states": round(one["states"] * more_lines),
        },
    }


def _cells(one: dict[str, Any], longest: float, fitting: Callable[[int], int]) -> list[int]:
    """Cells along and across another finger, of the shape of those measured."""
    along, across = one["cells"]
    # A cell of the front may be as long as is accepted.
    return [max(math.ceil(along * longest - 1e-9), 3), fitting(across)]


def _choice(key: str, value: Any, choices: list[dict[str, Any]]) -> dict[str, Any]:
    """The cheapest of an accuracy, the best of a budget, or the one of that name."""
    if key == "preset":
        named = {one["preset"]: one for one in choices if one["preset"]}
        if not isinstance(value, str) or value not in named:
            raise ValueError(f"preset must be one of {', '.join(named)}, got {value!r}")
        return named[value]
    errors, costs = ([one["expected"][what] for one in choices] for what in ("error", "core_seconds"))
    if key == "accuracy":
        wanted = percentage("accuracy", value)
        fitting = [one for one, error in zip(choices, errors, strict=True) if error <= wanted]
        if not fitting:
            raise ValueError(f'accuracy must be at least "{100 * min(errors):.2g} %", the best measured, got "{value}"')
        return min(fitting, key=lambda one: one["expected"]["core_seconds"])
    budget = seconds("budget", value)
    fitting = [one for one, cost in zip(choices, costs, strict=True) if cost <= budget]
    if not fitting:
        raise ValueError(f'budget must be at least "{min(costs):.0f}s" of core time for this finger, got "{value}"')
    return min(fitting, key=lambda one: one["expected"]["error"])
