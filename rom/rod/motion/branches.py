"""Viscoelastic branches of a finger's rubber, as input of compiled code.

A branch relaxes the shear modulus, not the bulk modulus, as in the full-order model (rom/native/contact/relaxation.c).
"""

from typing import Any

import numpy as np

from rom.files.checked_file import ModelError
from rom.rod.compiled.motion import MOST_BRANCHES
from rom.rod.rod import Rod

LEAST, MOST = 1e-9, 1e9  # modulus over the law's own [-], and relaxation time [s]
WHOLE = "saint-venant-kirchhoff"  # law whose bulk modulus relaxes, too


def branches_of(rod: Rod) -> dict[str, Any] | None:
    """Return moduli [-], times [s], and the shear modulus over three bulk moduli [-]; None for elastic rubber.

    Raises:
        ModelError: `material.prony` of the scene is not a list of branches, or there are several materials.
    """
    given, others = rod.scene["material"].get("prony"), rod.scene.get("materials") or []
    if others and (given is not None or any(one["material"].get("prony") for one in others)):
        raise ModelError(
            "material.prony must be left out with several materials: a rod relaxes as a whole section of one does"
        )
    if given is None:
        return None
    try:
        values = np.array(given, float)
    except (TypeError, ValueError):
        values = np.zeros(0)
    if values.ndim != 2 or values.shape[1] != 2 or not 1 <= len(values) <= MOST_BRANCHES:
        raise ModelError(f"material.prony must be 1 to {MOST_BRANCHES} branches [modulus, time], got {given!r}")
    if not ((values >= LEAST) & (values <= MOST)).all():
        raise ModelError(f"material.prony must have moduli and times from {LEAST:g} to {MOST:g}, got {given!r}")
    poisson = min(rod.segments[0].poisson, 0.5)
    relaxes = rod.scene["material"].get("law") == WHOLE
    bulk = 0.0 if relaxes else (1 - 2 * poisson) / (2 * (1 + poisson))
    return {"moduli": values[:, 0], "times": values[:, 1], "bulk": bulk}
