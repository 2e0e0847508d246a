"""States of a finger without contact that are outside the trained domain, as weight or a longer finger brings about."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from rom.rod.compiled import reports

if TYPE_CHECKING:
    from rom.rod.rod import Rod

COMPONENTS = (("fx", "N"), ("fy", "N"), ("fz", "N"), ("mx", "N m"), ("my", "N m"), ("mz", "N m"))


def outside_without_contact(rod: Rod) -> str | None:
    """Return a line that names such states and the wrench that is farthest beyond its limits; None if all are inside.

    The states are that of all lowest loads, and those of one load at its highest.
    """
    lowest = np.array([one.lower for one in rod.parameters])
    states = {"lowest loads": lowest}
    for k, one in enumerate(rod.parameters):
        states[f"{one.name} = {one.upper:g} {one.unit}"] = np.where(np.arange(len(lowest)) == k, one.upper, lowest)
    outside = {name: loads for name, loads in states.items() if not rod.place(loads).inside}
    if not outside:
        return None
    ratio, wrench = max(_farthest(rod, loads) for loads in outside.values())
    why = "loads or poses are beyond it" if ratio <= 1 else f"{wrench}: train with a larger load.force or load.moment"
    return f"outside the trained domain without contact at {', '.join(outside)}; {why}"


def _farthest(rod: Rod, loads: np.ndarray) -> tuple[float, str]:
    """The largest ratio of a transmitted wrench's component to its trained limit, and its name with both values."""
    found = (0.0, "")
    wrenches = reports.elements(rod.struct, loads, np.zeros((len(rod.segments), len(COMPONENTS))))
    for number, (segment, (_, _, transmitted)) in enumerate(zip(rod.segments, wrenches, strict=True), 1):
        for element, own in zip(segment.elements, transmitted, strict=True):
            limits = np.where(own < 0, element.polynomial.lower[-6:], element.polynomial.upper[-6:])
            ratios = own / limits
            k = int(np.argmax(ratios))
            name, unit = COMPONENTS[k]
            words = f"segment {number} transmits {name} = {own[k]:.3g} {unit}, trained to {limits[k]:.3g} {unit}"
            found = max(found, (float(ratios[k]), words))
    return found
