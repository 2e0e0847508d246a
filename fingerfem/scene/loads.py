"""Loads of a scene, read from words."""

from collections.abc import Mapping
from typing import Any

from fingerfem.scene.scene import Scene


def read_loads(scene: Scene, settings: list[str]) -> dict[str, Any]:
    """Arguments of `FingerModel.solve` from words like F1=50: what is left out is zero, or no plane.

    Raises:
        ValueError: name, rule, value.
    """
    names = [parameter["name"] for parameter in scene.parameters]
    values: dict[str, float] = {}
    for setting in settings:
        name, equals, text = setting.partition("=")
        if not equals or name not in names or name in values:
            raise ValueError(f"loads must be NAME=VALUE, once each, with NAME one of {', '.join(names)}, got {setting}")
        try:
            values[name] = float(text)
        except ValueError:
            raise ValueError(f"{name} must be a number, got {text!r}") from None
    check_limits(scene, {name: value for name, value in values.items() if name in (*scene.actuators, "d")})
    count = len(scene.actuators)
    pulled = [values.get(name, 0.0) for name in names[:count]]
    if scene.load is None:
        return {"tensions": pulled, "distance": values.get("d")}
    pressed = [values.get(name, 0.0) for name in names[count:]]
    return {"tensions": pulled, "wrenches": [pressed[k : k + 6] for k in range(0, len(pressed), 6)]}


def check_limits(scene: Scene, values: Mapping[str, float]) -> None:
    """Refuse loads that a scene does not allow.

    Args:
        scene: with lowest and highest loads.
        values: by the names of its parameters, in their units.

    Raises:
        ValueError: name, rule, value.
    """
    for parameter in scene.parameters:
        name, lower, upper, unit = (parameter[key] for key in ("name", "lower", "upper", "unit"))
        if name in values and not lower <= values[name] <= upper:
            raise ValueError(f"{name} must lie in [{lower:g}, {upper:g}] {unit}, got {values[name]:g}")
