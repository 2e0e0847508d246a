"""Rules for the scene of a finger that trains elements: checked before states are solved, and when they are read."""

from collections.abc import Mapping
from typing import Any

from rom.dataset.actuators import count_of
from rom.dataset.geometry import is_all_along
from rom.dataset.snapshot_set import SnapshotError

FEWEST = 4  # lines
MOST_ACTUATORS = 8  # of a rod, FINGERFEM_MOST_TENSIONS of compiled code
ALTERNATIVE = "train without, then rom assemble takes it from a scene"


def check_trainable(scene: Mapping[str, Any]) -> None:
    """Refuse a finger of several segments, of too many actuators, or whose sections differ along the axis.

    Args:
        scene: of the states, as plain data.

    Raises:
        SnapshotError: one line with name, rule, value and alternative.
    """
    geometry = scene["geometry"]
    if (count := len(geometry["segments"])) > 1:
        raise SnapshotError(
            f"geometry.segments must be one to train elements, got {count}; train one, then rom assemble takes "
            "several from a scene"
        )
    if geometry.get("taper"):
        raise SnapshotError(
            f"geometry.taper must be left out to train elements, got {geometry['taper']}; {ALTERNATIVE}"
        )
    for one in scene.get("materials") or []:
        if not is_all_along(geometry, one.get("x")):
            raise SnapshotError(
                f"materials.{one['name']}.x must be left out to train elements: they have one section all along the "
                f"axis, got {one['x']}; {ALTERNATIVE}"
            )
    if (count := count_of(scene)) > MOST_ACTUATORS:
        raise SnapshotError(f"tendons and chambers must be at most {MOST_ACTUATORS} to train elements, got {count}")


def check_lines(lines: int) -> None:
    """Refuse too few lines to leave some out.

    Raises:
        SnapshotError: below FEWEST.
    """
    if lines < FEWEST:
        raise SnapshotError(f"lines with an answer must be at least {FEWEST} to train elements, got {lines}")
