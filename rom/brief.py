"""One line for what holds many numbers: what repr shows of models, their answers and their parts."""

from collections.abc import Collection, Mapping
from dataclasses import fields, is_dataclass
from typing import Any, TypeVar

import numpy as np

T = TypeVar("T")
FEW, SHORT = 6, 60  # numbers of an array, and characters of a value, that are shown


def brief(of: type[T]) -> type[T]:
    """A class decorator: repr is one line, whatever a dataclass or named tuple holds."""
    of.__repr__ = _line  # type: ignore[method-assign]
    return of


def _line(self: Any) -> str:
    """The name of its class, and its fields but those that are None; of a model its scene's name and its parameters."""
    scene = getattr(self, "scene", None)
    if isinstance(scene, Mapping):
        parameters = getattr(self, "parameters", None) or getattr(self, "tension_parameters", [])
        ranges = (f"{one.name} {one.lower:g} to {one.upper:g} {one.unit}" for one in parameters)
        return f"{type(self).__name__}({str(scene.get('name', ''))!r}: {', '.join(ranges)})"
    names = [one.name for one in fields(self) if one.repr] if is_dataclass(self) else self._fields
    shown = ((name, value) for name in names if (value := getattr(self, name)) is not None)
    return f"{type(self).__name__}({', '.join(f'{name}={_value(value)}' for name, value in shown)})"


def _value(value: Any) -> str:
    """A value in few characters: an array's numbers if they are few, else its shape; a collection's size."""
    if isinstance(value, np.ndarray):
        if value.size > FEW or value.dtype == object:
            return f"{value.dtype} of shape {value.shape}"
        return np.array2string(value, precision=6, separator=", ").replace("\n", "")
    text = repr(value)
    if len(text) <= SHORT and "\n" not in text:
        return text
    if isinstance(value, Collection) and not isinstance(value, str | bytes):
        return f"{type(value).__name__} of {len(value)}"
    return f"{type(value).__name__}(...)" if not isinstance(value, str) else f"{text[:SHORT]}...'"
