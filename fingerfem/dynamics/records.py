"""A motion's folder: a row for every state, and what the next step needs, so that an interrupted motion goes on."""

import csv
import time
import zipfile
from dataclasses import astuple, fields
from pathlib import Path
from typing import Self

import numpy as np

from fingerfem.dynamics.energy_balance import Balance
from fingerfem.dynamics.generalised_alpha import MovingState
from fingerfem.dynamics.simulation import Moment
from rom.files.atomic_file import write_whole

ROWS, LAST = "motion.csv", "last.npz"
FIELDS = [one.name for one in fields(MovingState) if one.name != "time"]
KEPT = [*FIELDS, "time", "balance", "step", "repeated", "digest"]
ENERGIES = [one.name for one in fields(Balance)]
EVERY = 5.0  # between times at which what the next step needs is kept [s]


class Records:
    """The records of one motion; a context, and a call for every state.

    Attributes:
        rows: reported until now.
        moment: from which the motion goes on; None of a new one.

    Args:
        folder: made if it is not there.
        digest: of scene and motion.

    Raises:
        ValueError: the folder has another motion.
    """

    def __init__(self, folder: Path, digest: str):
        self._folder, self._digest, self._kept = folder, digest, time.monotonic()
        folder.mkdir(parents=True, exist_ok=True)
        self.moment = self._read_moment()
        self.rows = [] if self.moment is None else self._read_rows(self.moment.state.time)
        self._stream = (folder / ROWS).open("w", newline="")
        self._writer: csv.DictWriter | None = None
        for row in self.rows:
            self._write(row)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_) -> None:
        self._keep()
        self._stream.close()

    def __call__(self, row: dict[str, float], moment: Moment) -> None:
        """Record a state."""
        self.rows.append(row)
        self._write(row)
        self.moment = moment
        if time.monotonic() - self._kept > EVERY:
            self._keep()

    def _write(self, row: dict[str, float]) -> None:
        if self._writer is None:
            self._writer = csv.DictWriter(self._stream, list(row))
            self._writer.writeheader()
        self._writer.writerow(row)

    def _keep(self) -> None:
        """Keep what the next step needs, and all rows until then."""
        self._stream.flush()
        self._kept = time.monotonic()
        if self.moment is None:
            return
        state, moment = self.moment.state, self.moment
        whole = {"time": state.time} | {name: getattr(state, name) for name in FIELDS}
        whole |= {"balance": astuple(moment.balance), "step": moment.step, "repeated": moment.repeated}
        write_whole(self._folder / LAST, lambda stream: np.savez(stream, digest=self._digest, **whole))

    def _read_moment(self) -> Moment | None:
        file = self._folder / LAST
        if not file.exists():
            return None
        try:
            with np.load(file) as found:
                whole = {name: found[name] for name in KEPT}
        except (OSError, KeyError, ValueError, zipfile.BadZipFile):
            raise ValueError(f"{file} must be what this command keeps; remove it to begin anew, got another") from None
        if str(whole["digest"]) != self._digest:
            raise ValueError(f"{self._folder} must have this motion of this scene; name a new folder, got another's")
        time, balance = float(whole["time"]), dict(zip(ENERGIES, whole["balance"].tolist(), strict=True))
        state = MovingState(time=time, **{name: whole[name] for name in FIELDS} | {"impact": float(whole["impact"])})
        return Moment(state, Balance(**balance), float(whole["step"]), int(whole["repeated"]))

    def _read_rows(self, until: float) -> list[dict[str, float]]:
        """Rows up to a time [s]."""
        with (self._folder / ROWS).open(newline="") as stream:
            rows = [{name: float(value) for name, value in row.items()} for row in csv.DictReader(stream)]
        return [row for row in rows if row["time"] <= until]
