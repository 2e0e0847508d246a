"""Fingers of the bundled one's elements: in other units, exact by similarity of sizes and forces, and of segments."""

from rom import Rod, TouchedSegment
from rom.rod.objects.shapes import facing_plane
from rom.rod.scene.materials_of_rod import MODULI


def scaled(rod: Rod, length: float = 1.0, modulus: float = 1.0) -> Rod:
    """A finger `length` times as large, of rubber `modulus` times as stiff: forces go with the modulus and an area."""
    force, geometry = modulus * length**2, rod.scene["geometry"]
    sizes = {name: geometry[name] * length for name in ("side", "plate")}
    sizes["segments"] = [length * one for one in geometry["segments"]]
    material = {
        name: value * modulus ** MODULI[name] if name in MODULI else value
        for name, value in rod.scene["material"].items()
    }
    tendons = [
        tendon
        | {"offset": [length * one for one in tendon["offset"]], "tension": [force * one for one in tendon["tension"]]}
        for tendon in rod.scene["tendons"]
    ]
    return rod.assembled(rod.scene | {"geometry": geometry | sizes, "material": material, "tendons": tendons})


def in_series(rod: Rod, count: int) -> Rod:
    """A finger of so many segments, each as long as the whole finger; all its tendons go to the tip."""
    geometry = rod.scene["geometry"]
    tendons = [tendon | {"segment": count} for tendon in rod.scene["tendons"]]
    segments = {"segments": [sum(geometry["segments"])] * count}
    return rod.assembled(rod.scene | {"geometry": geometry | segments, "tendons": tendons})


def two_segments() -> TouchedSegment:
    """The bundled finger, twice, before a plane. It snaps through before some planes: no equilibrium goes on there."""
    return TouchedSegment(rod=in_series(TouchedSegment.load().rod, 2), obstacle=facing_plane(0.01, (0.0, 0.1)))
