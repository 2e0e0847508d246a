"""The models that the controllers are measured with, from the sets of the surrogate's study."""

from __future__ import annotations

from rom import Surrogate
from rom.build import train
from rom.error_model import calibrated
from rom.separation.alternating_directions import EnrichmentOptions
from studies.runner import Run
from studies.surrogate import accuracy

TARGET = 1.0  # [N]
# Mean solve of Chenevier et al., PLoS ONE 2018, table 1 [us].
PAPER_US = {
    "one segment": 7160.0,
    "two segments": 30000.0,
}


def names(run: Run) -> list[str]:
    """One segment alone in the short form."""
    return list(PAPER_US)[: 1 if run.quick else None]


def model(run: Run, name: str) -> Surrogate:
    """A trained and calibrated model, from its file if it is there."""
    file = run.folder / f"{name.replace(', ', '-').replace(' ', '-')}.h5"
    if not file.exists():
        training, held_out = accuracy.sets_of(run, {"one segment": "draft"}.get(name, name))
        calibrated(train(training, EnrichmentOptions()), held_out).save(file)
    return Surrogate.load(file)
