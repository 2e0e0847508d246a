"""Fingers of other lengths, and one of two segments, assembled from the elements of the bundled finger.

python3 examples/lengths.py [PICTURE.png]
"""

import sys

import numpy as np

import rom

bundled = rom.load().rod
tensions = [30.0, 5.0]  # [N]


def assembled(segments: list[float], plates: tuple[int, int]) -> rom.Rod:
    """A finger with segments of these lengths [m]; its two tendons end at these plates."""
    geometry = bundled.scene["geometry"] | {"segments": segments}
    tendons = [one | {"segment": plate} for one, plate in zip(bundled.scene["tendons"], plates, strict=True)]
    return bundled.assembled(bundled.scene | {"geometry": geometry, "tendons": tendons})


shapes = {}
for segments, plates in (([0.025], (1, 1)), ([0.050], (1, 1)), ([0.080], (1, 1)), ([0.060, 0.035], (1, 2))):
    finger, name = assembled(segments, plates), " + ".join(f"{1000 * length:g}" for length in segments)
    shapes[name] = finger.sections(tensions, at=np.linspace(0.0, sum(segments), 60)).centres
    inside = finger.place(tensions).inside
    print(f"{name} mm: tip at {(1000 * shapes[name][-1]).round(1)} mm; within the trained range: {inside}")
    assert inside

if sys.argv[1:]:
    import matplotlib.pyplot as plt

    figure, axes = plt.subplots(figsize=(5, 4), layout="constrained")
    for k, (name, shape) in enumerate(shapes.items()):
        axes.plot(
            30 * k + 1000 * shape[:, 0], 1000 * shape[:, 1], lw=8, alpha=0.7, solid_capstyle="butt", label=f"{name} mm"
        )
    axes.set(xlabel="x, side by side [mm]", ylabel="y [mm]", aspect="equal")
    axes.legend()
    figure.savefig(sys.argv[1], dpi=120)
