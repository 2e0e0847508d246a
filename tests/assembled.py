"""The bundled segment in other units: the same polynomial map, exact by similarity of sizes and forces."""

from dataclasses import replace

import numpy as np


def scaled(segment, length=1.0, modulus=1.0):
    """A segment `length` times as large, of rubber `modulus` times as stiff: forces go with the modulus and an area."""
    force = modulus * length**2
    box = np.array([force] * (segment.tensions + 3) + [force * length] * 3)

    def polynomial(one, factors):
        return one and replace(
            one, lower=one.lower * box, upper=one.upper * box, coefficients=one.coefficients * factors
        )

    geometry = segment.scene["geometry"]
    sizes = {name: geometry[name] * length for name in ("side", "plate")}
    sizes["segments"] = [length * one for one in geometry["segments"]]
    parameters = zip(segment.parameters, box, strict=True)
    return replace(
        segment,
        parameters=[one | {end: float(one[end] * factor) for end in ("lower", "upper")} for one, factor in parameters],
        pose=polynomial(segment.pose, np.array([length] * 3 + [1.0] * 4)),
        corners=polynomial(segment.corners, length),
        skin=polynomial(segment.skin, length),
        skin_error=segment.skin_error * length,
        displacements=None,
        shortenings=None,
        scene=segment.scene | {"geometry": geometry | sizes},
    )
