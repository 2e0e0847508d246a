"""A state of the full-order model for people: quantities with units, sensitivities, what it took."""

from collections.abc import Container, Mapping
from typing import Any

from rom.console.table import Table, components, number, quantities, row, shown

UNITS = {
    "touch_distance": "m",
    "contact_force": "N",
    "pad_pressure": "Pa",
    "penetration": "m",
    "complementarity": "-",
    "energy": "J",
    "smallest_volume_ratio": "-",
}
CHANGES = {
    "tip": "m",
    "contact_force": "N",
    "channel_shortening": "m",
    "chamber_volumes": "m^3",
}  # that have sensitivities


def tables(found: Mapping[str, Any]) -> list[Table | str]:
    """Tables of a state in plain data, see State.as_json."""
    names = [name for name in found["parameters"] if name != "d"]
    chambers = found.get("chamber_volumes", {})
    loads = [row(name, value, unit_of(name, chambers)) for name, value in found["parameters"].items()]
    answer = components("tip", found["tip"], "m")
    answer += [row(name.replace("_", " "), found[name], unit) for name, unit in UNITS.items() if name in found]
    answer += [
        row(f"{name} principal stretch", value, "-")
        for name, value in zip(("least", "largest"), found.get("stretches", ()), strict=False)
    ]
    answer += components("clamp reaction", found["clamp_reaction"], "N")
    answer += [row(f"{name} shortened by", value, "m") for name, value in found["channel_shortening"].items()]
    answer += [row(f"volume of {name}", value, "m^3") for name, value in chambers.items()]
    parts: list[Table | str] = [quantities(loads, "loads"), quantities(answer, "equilibrium")]
    if found.get("sensitivities"):
        parts.append(sensitivities(found["sensitivities"], [*names, *(["d"] if "d" in found["parameters"] else [])]))
    yes = {True: "yes", False: "no", None: "not known"}
    parts.append(f"stable: {yes[found.get('stable')]}; passes through itself: {yes[found['self_intersecting']]}")
    iterations, steps = found["newton_iterations"], found["steps"]
    if found.get("beyond_data"):
        parts.append("stretched beyond the data of the law")
    return [*parts, f"{iterations} Newton iterations in {steps} steps, {found['unknowns']:,} unknowns"]


def sensitivities(found: Mapping[str, Any], parameters: list[str]) -> Table:
    """Derivatives of every quantity by the parameters that have any."""
    known = [name for name in parameters if name in found["tip"]]
    chambers: Mapping[str, float] = next(iter(found.get("chamber_volumes", {}).values()), {})
    units = {name: shown(unit_of(name, chambers)) for name in known}
    rows = []
    for quantity, unit in CHANGES.items():
        for own, values in _scalars(quantity, found.get(quantity, {})).items():
            changes = (number(values[name] / units[name][0], unit, 3) for name in known)
            rows.append([own, shown(unit)[1], *changes])
    header = ["derivative of", "unit", *(f"by {name} [{units[name][1]}]" for name in known)]
    return Table(title="sensitivities", header=header, rows=rows)


def _scalars(quantity: str, by_parameter: Mapping[str, Any]) -> dict[str, dict[str, float]]:
    """A quantity's components by their names: each by the parameters."""
    components: dict[str, dict[str, float]] = {}
    for parameter, value in by_parameter.items():
        named = value if isinstance(value, Mapping) else {"": value}
        if isinstance(value, list):
            named = dict(zip("xyz", value, strict=True))
        for name, one in named.items():
            title = f"{quantity.replace('_', ' ')} {name}".strip()
            if isinstance(value, Mapping):
                title = f"volume of {name}" if quantity == "chamber_volumes" else f"{name} shortened by"
            components.setdefault(title, {})[parameter] = float(one)
    return components


def unit_of(name: str, chambers: Container[str] = ()) -> str:
    """Unit of a parameter: the pressure of a chamber, d, a component of a moment, or a tension or force."""
    if name in chambers:
        return "Pa"
    if name == "d":
        return "m"
    return "N m" if name[:1] == "m" else "N"
