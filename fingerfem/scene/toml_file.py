"""The scene as a TOML file: read, and refused in one line."""

import tomllib
from collections.abc import Iterator, Sequence
from difflib import get_close_matches
from pathlib import Path
from typing import Any, get_args

from pydantic import BaseModel, ValidationError

from fingerfem.scene.scene import Scene, SceneError
from rom.files.file_kinds import uses_of

UNITS = {
    "side": "m",
    "height": "m",
    "diameter": "m",
    "bore": "m",
    "segments": "m",
    "plate": "m",
    "channel": "m",
    "offset": "m",
    "distance": "m",
    "x": "m",
    "width": "m",
    "C1": "Pa",
    "C2": "Pa",
    "C3": "Pa",
    "mu": "Pa",
    "C10": "Pa",
    "C01": "Pa",
    "E": "Pa",
    "D1": "1/Pa",
    "tension": "N",
    "force": "N",
    "moment": "N m",
    "pressure": "Pa",
    "density": "kg/m^3",
    "acceleration": "m/s^2",
}


def load_scene(path: str | Path) -> Scene:
    """Read a scene.

    Raises:
        SceneError: one line naming file, field, rule and value.
    """
    table = read_toml(path)
    try:
        return Scene.model_validate(table, context={"folder": Path(path).parent})
    except ValidationError as error:
        raise SceneError(f"{path}: {one_line(error)}") from None


def read_toml(path: str | Path) -> dict[str, Any]:
    """The tables of a TOML file.

    Raises:
        SceneError: one line naming file and reason.
    """
    try:
        return tomllib.loads(Path(path).read_text("utf-8-sig"))
    except OSError as error:
        raise SceneError(f"{path}: {error.strerror or error}{uses_of(path)}") from None
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        other = uses_of(path) if Path(path).suffix.lower() != ".toml" else ""
        raise SceneError(f"{path}: not a TOML file: {error}{other}") from None


def one_line(error: ValidationError) -> str:
    """The first broken rule as `field rule, got value`."""
    # A misspelt key is also a missing one: name what was written.
    first = min(error.errors(), key=lambda broken: broken["type"] != "extra_forbidden")
    where = [str(part) for part in first["loc"]]
    field = ".".join(where)
    unit = next((UNITS[part] for part in reversed(where) if part in UNITS), None)
    of_unit = f" {unit}" if unit else ""
    kind, context = first["type"], first.get("ctx", {})
    if kind == "missing":
        return f"{field} is required and missing"
    if kind == "extra_forbidden":
        value = "a table" if isinstance(first["input"], dict) else repr(first["input"])
        return f"{field} is not a known key{_meant(where)}, got {value}"
    if kind == "value_error" and isinstance(context["error"], ValidationError):  # of a law
        return f"{field}.{one_line(context['error'])}"
    if kind == "value_error":
        rule = str(context["error"])
        parting = " " if rule.startswith("must ") else "."  # the rule may begin with a key of the field
        return f"{field}{parting}{rule}" if where else rule
    rules = {
        "greater_than": ("must be above {}", "gt"),
        "greater_than_equal": ("must be at least {}", "ge"),
        "less_than": ("must be below {}", "lt"),
        "less_than_equal": ("must be at most {}", "le"),
    }
    if kind in rules:
        text, key = rules[kind]
        rule = text.format(f"{context[key]:g}") + of_unit
    elif kind == "string_pattern_mismatch":
        rule = "must be a letter, then letters, digits and _ alone"
    elif kind == "literal_error":
        rule = f"must be {context['expected']}"
    elif kind in ("list_type", "tuple_type"):
        rule = "must be a list"
    elif kind in ("too_short", "too_long"):
        bound, key = ("at least", "min_length") if kind == "too_short" else ("at most", "max_length")
        rule = f"must have {bound} {context[key]} entries"
    elif kind in ("float_type", "int_type"):
        rule = f"must be a {'number' if kind == 'float_type' else 'whole number'}{f' in {unit}' if unit else ''}"
    else:
        rule = first["msg"][0].lower() + first["msg"][1:]
    return f"{field} {rule}, got {first['input']!r}"


def _meant(where: Sequence[str]) -> str:
    """The key of a scene's table that a misspelt one resembles, as a question."""
    tables: list[type[BaseModel]] = [Scene]
    for name in where[:-1]:
        if not name.isdigit():
            fields = [one.model_fields[name] for one in tables if name in one.model_fields]
            tables = [table for field in fields for table in _tables(field.annotation)]
    keys = {name for one in tables for name in one.model_fields}
    alike = get_close_matches(where[-1], keys, 1, cutoff=0.7)
    return f" (did you mean {alike[0]}?)" if alike else ""


def _tables(annotation: Any) -> Iterator[type[BaseModel]]:
    """The tables that an annotation names."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        yield annotation
    for one in get_args(annotation):
        yield from _tables(one)
