"""The studies: the page of each, and the module that measures each part.

Each module has a function `measure(run: parts.Run)`, which returns what JSON can hold.
"""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Study:
    """A section of a page: modules, or MODULE:FUNCTION, by part; parts `elsewhere` need MuJoCo, see the Makefile."""

    page: str
    parts: dict[str, str]
    elsewhere: tuple[str, ...] = ()


def _same(*names: str) -> dict[str, str]:
    return {name: name for name in names}


OTHER_NAMES = {"reference": "full_order", "ours": "reduced", "finite_elements": "felupe.comparison"}
FIFTIES = "first second third fourth fifth sixth seventh eighth ninth tenth"
GRASPS = {fifty: f"grasps:{fifty}" for fifty in FIFTIES.split()}
SIMULATED = _same("pictures", "real_time")
# In this order: later studies use the snapshot sets of earlier ones.
STUDIES = {
    "training": Study("appendix", _same("farm")),
    "control": Study("speed", _same("campaigns", "loop")),
    "tradeoff": Study("speed", _same("fingers")),
    "separated": Study("accuracy", {"rod": "separated:of_the_rod", "grid": "separated:of_states"}),
    "rods": Study("accuracy", _same("accuracy", "objects")),
    "rubber": Study("accuracy", _same("indentation", "random_objects", "robustness")),
    "several": Study("accuracy", _same("several", "histories")),
    "guides": Study("accuracy", _same("histories", "friction")),
    "motion": Study("accuracy", _same("frequencies", "motion")),
    "tracking": Study("accuracy", _same("tracking")),
    "feeling": Study("accuracy", {"states": "full_order:states", "feeling": "feeling"}),
    "assembled": Study("accuracy", _same("four", "fingers")),
    "calibration": Study("accuracy", _same("states", "calibrated")),
    "tapered": Study("accuracy", _same("tapered")),
    "shapes": Study("accuracy", _same("shapes")),
    "grasping": Study("grasping", GRASPS | SIMULATED, elsewhere=(*GRASPS, *SIMULATED)),
    "engine": Study("accuracy", _same("full_order", "finer", "simulated"), elsewhere=("simulated",)),
    "coverage": Study("accuracy", _same("coverage")),
    "extremes": Study("appendix", _same("extremes", "locking")),
    "random_fingers": Study("appendix", _same("random_fingers")),
    "required": Study("appendix", _same("required")),
    "figures": Study("appendix", _same("figures")),
    "peers": Study("peers", _same("beams") | OTHER_NAMES),
}
