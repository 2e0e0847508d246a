"""Times as people write them."""

from __future__ import annotations

import re
from typing import Any

UNITS = {"s": 1.0, "min": 60.0, "h": 3600.0}


def seconds(name: str, text: Any) -> float:
    """A time such as 90s, 30min or 2h [s].

    Raises:
        ValueError: it is none; the line begins with `name`.
    """
    found = re.fullmatch(r"([0-9]*\.?[0-9]+)\s*(s|min|h)", text) if isinstance(text, str) else None
    if found is None or float(found[1]) == 0:
        raise ValueError(f"{name} must be a time such as 90s, 30min or 2h, got {text!r}")
    return float(found[1]) * UNITS[found[2]]
