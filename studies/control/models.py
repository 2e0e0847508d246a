"""The models that the controllers are measured with."""

from __future__ import annotations

from dataclasses import replace

from control.model import Model
from rom import Surrogate, TouchedSegment
from rom.build import train
from rom.error_model import calibrated
from rom.rod.objects.shapes import facing_plane
from rom.separated.alternating_directions import EnrichmentOptions
from studies.runner import Run
from studies.surrogate import accuracy

TARGET = 1.0  # [N]
DISTANCES = 0.001, 0.031  # [m] of the paper's plane
# Mean solve of Chenevier et al., PLoS ONE 2018, table 1 [us].
PAPER_US = {
    "one segment": 7160.0,
    "two segments": 30000.0,
}


def names(run: Run) -> list[str]:
    """One segment alone in the short form."""
    return list(PAPER_US)[: 1 if run.quick else None]


def model(run: Run, name: str) -> Model:
    """The bundled finger; of two segments, a surrogate of another study's sets."""
    return finger() if name == "one segment" else two_segments(run)


def finger() -> TouchedSegment:
    """The bundled finger, before the paper's plane."""
    touched = TouchedSegment.load()
    return replace(touched, obstacle=facing_plane(touched.scene["geometry"]["side"], DISTANCES))


def two_segments(run: Run) -> Surrogate:
    """A trained and calibrated surrogate, from its file if it is there."""
    file = run.folder / "two-segments.h5"
    if not file.exists():
        training, held_out = accuracy.sets_of(run, "two segments")
        calibrated(train(training, EnrichmentOptions()), held_out).save(file)
    return Surrogate.load(file)
