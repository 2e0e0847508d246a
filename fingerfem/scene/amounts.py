"""Times and shares as people write them: 30min, 1 %."""

import re
from typing import Any

UNITS = {"s": 1.0, "min": 60.0, "h": 3600.0}


def seconds(name: str, text: Any) -> float:
    """A time such as 90s, 30min or 2h [s].

    Raises:
        ValueError: it is none; the line begins with `name`.
    """
    match = re.fullmatch(r"([0-9]*\.?[0-9]+)\s*(s|min|h)", text) if isinstance(text, str) else None
    if match is None or float(match[1]) == 0:
        raise ValueError(f"{name} must be a time such as 90s, 30min or 2h, got {text!r}")
    return float(match[1]) * UNITS[match[2]]


def percentage(name: str, text: Any) -> float:
    """A share such as "1 %" [-].

    Raises:
        ValueError: it is none; the line begins with `name`.
    """
    match = re.fullmatch(r"\s*([0-9]*\.?[0-9]+)\s*%\s*", text) if isinstance(text, str) else None
    if match is None or not 0 < float(match[1]) < 100:
        raise ValueError(f'{name} must be a share such as "1 %", above 0 and below 100 %, got {text!r}')
    return float(match[1]) / 100


def share(name: str, text: str) -> float:
    """A share as a number, or as in `percentage` [-].

    Raises:
        ValueError: it is none; the line begins with `name`.
    """
    try:
        return float(text)
    except ValueError:
        return percentage(name, text)
