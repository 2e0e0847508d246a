"""Samples of an element as a mirror makes them of others."""

from dataclasses import replace

from rom.elements.samples.element_samples import Samples
from rom.elements.samples.symmetry import Mirror


def image(mirror: Mirror, samples: Samples) -> Samples:
    """The images of samples, in the samples' lines."""
    return replace(
        samples,
        inputs=samples.inputs @ mirror.inputs.T,
        values=samples.values @ mirror.values.T,
        jacobians=mirror.values @ samples.jacobians @ mirror.inputs.T,
    )
