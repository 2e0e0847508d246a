"""A finger compared with pressed states of the full-order model: places, shortenings, and what they mean for forces."""

from typing import Any

import numpy as np

from rom.dataset.description import difference
from rom.dataset.snapshot_set import SnapshotError, SnapshotSet
from rom.elements.fitting.calibration import force_deviations
from rom.elements.fitting.contact_error import relative_force_errors
from rom.elements.march import march
from rom.elements.rotation_vectors import angles
from rom.elements.samples.section_states import read_section_states
from rom.error_statistics import quantiles
from rom.rod.rod import Rod

OF_THE_FINGER = "geometry", "section", "material", "materials", "gravity"


def _finger(scene: dict[str, Any]) -> dict[str, Any]:
    """The finger of a scene; ranges of tensions may differ, as answers outside the trained ones are counted."""
    tendons = [{key: value for key, value in one.items() if key != "tension"} for one in scene["tendons"]]
    chambers = [{key: one[key] for key in ("name", "centre", "size", "x")} for one in scene.get("chambers") or []]
    return {key: scene.get(key) for key in OF_THE_FINGER} | {"tendons": tendons, "chambers": chambers}


def check_pressed(rod: Rod, held_out: SnapshotSet) -> dict[str, Any]:
    """Compare a finger with held-out or its training states, of any mesh.

    Returns:
        numbers of states; errors of the plate's place [m] and turn [rad], of contact forces [-], of shortenings [m] and
        of the growth of chambers [m^3]; the share of states within what was trained, and of contact forces within their
        estimated errors.

    Raises:
        SnapshotError: a set of another finger, or without a load.
    """
    scene = held_out.description.scene
    other = difference(_finger(rod.scene), _finger(scene))
    if other:
        raise SnapshotError(f"{held_out.path}: must hold states of the model's finger: {other}")
    states = read_section_states(held_out)
    t = states.tensions
    plates = [rod.place(row[:t], row[None, t:]) for row in states.inputs]
    centres, rotations = (np.array([getattr(one, name)[0] for one in plates]) for name in ("centres", "rotations"))
    errors = relative_force_errors(states, centres, rotations)
    strokes = np.array([rod.strokes(row[:t], row[None, t:]) for row in states.inputs]) - states.shortenings[:, -1]
    shorter, larger = np.split(np.abs(strokes), [t - states.pressures], axis=1)
    deviations = march(rod.segments[0].elements, states.inputs[:, :t], states.inputs[:, t:]).deviations
    estimates = rod.elements.error_factor("contact_force") * force_deviations(states, deviations, rod.errors.floors)
    known = ~np.isnan(errors)
    return {
        "states": len(states.inputs),
        "failed": len(held_out.failures),
        "training": not held_out.description.random,
        "inside": float(np.mean([one.inside for one in plates])),
        "place_m": quantiles(np.linalg.norm(centres - states.plate.places, axis=1)),
        "contact_force": quantiles(errors),
        "turn_rad": quantiles(angles(rotations, states.plate.rotations)),
        "channel_shortening_m": quantiles(shorter.ravel()),
        **({"chamber_growth_m3": quantiles(larger.ravel())} if larger.size else {}),
        "covered": float(np.mean(errors[known] <= estimates[known])) if known.any() else np.nan,
    }
