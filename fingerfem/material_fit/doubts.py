"""Doubts about tests of a rubber: signs of a wrong unit or column, a preload, unloading or a break."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from fingerfem.material_fit.measurements import Measurement
from rom.console.table import number, percent

if TYPE_CHECKING:
    from fingerfem.material_fit.fit import Fit

POOR = 0.05  # error on points left out, over the peak stress [-]
YOUNG = (1e4, 5e7)  # Young's modulus of rubbers, from gels to 95 Shore A [Pa]
FARTHEST, LEAST = 0.5, 0.02  # strains: the smallest of a test, and its largest [-]
NEAR, FEWEST = 0.3, 5  # strain up to which stress is extrapolated to rest, by so many points or more [-]
PRELOAD = 0.05  # stress at rest over the peak [-]


def doubts(measurements: Sequence[Measurement], chosen: Fit | None) -> list[str]:
    """Return what is unlikely in tests and in the law that fits them best, one line each.

    Args:
        measurements: the tests.
        chosen: the best law.
    """
    found = [line for one in measurements for line in _of_test(one)]
    if chosen is None or chosen.law is None or chosen.left_out is None:
        return found
    young, (low, high) = chosen.law.young_modulus, YOUNG
    if not low <= young <= high:
        found.append(
            f"check the unit of stress: rubbers have E from {low / 1e3:g} to {high / 1e3:g} kPa, "
            f"this has {number(young, 'Pa')} kPa"
        )
    if chosen.left_out.rms > POOR:
        found.append(
            f"check test, units and points: no law is nearer than {percent(chosen.left_out.rms)} of the peak stress to "
            "points left out; unloading, and points after a break, are no part of a test"
        )
    return found


def _of_test(one: Measurement) -> list[str]:
    """Doubts about one test."""
    strain, found = one.stretch - 1, []
    smallest, largest = float(np.abs(strain).min()), float(np.abs(strain).max())
    if smallest > FARTHEST:
        found.append(
            f"check whether the column is stretch or strain: {one.mode} data begin at a strain of {smallest:.3g}"
        )
    if largest < LEAST:
        found.append(f"check the unit of strain: the largest of {one.mode} data is {percent(largest)}")
    for own in (np.flatnonzero((strain >= 0) & (strain < NEAR)), np.flatnonzero((strain <= 0) & (strain > -NEAR))):
        if len(np.unique(strain[own])) < FEWEST:
            continue
        rest = float(np.polyfit(strain[own], one.stress[own], 2)[2])
        if rest * strain[own].sum() > 0 and abs(rest) > PRELOAD * one.peak:
            found.append(
                f"check for a preload: the {one.mode} stress at rest, by a parabola through points near it, is "
                f"{number(rest, 'Pa')} kPa"
            )
    return found
