"""The lines of states a set holds: its first ones, then round by round those that are added to them.

A round is `rounds/NNNN.json`: the error estimated from the states of all rounds before, and the lines to solve next.
It has no lines where that error was small enough, or no more may be added.
"""

import json
from dataclasses import asdict, astuple, dataclass
from pathlib import Path

from rom.brief import brief
from rom.dataset.description import Description, Line
from rom.files.atomic_file import write_whole


@brief
@dataclass(frozen=True, kw_only=True)
class Round:
    """Lines of states that are added to a set next.

    Attributes:
        error: estimated relative error of a model of all states before [-].
        threshold: indicator above which lines were taken [-]; 0 if there is none.
        lines: by the names of their tasks.
        finest: whether the sequence of lines has no more.
        stalled: whether more states no longer make the error smaller.
    """

    error: float
    threshold: float
    lines: dict[str, Line]
    finest: bool = False
    stalled: bool = False


class PlanError(ValueError):
    """A round that is not whole: one line naming its file."""


def round_file(path: str | Path, number: int) -> Path:
    """File of a round; it need not exist yet."""
    return Path(path) / "rounds" / f"{number:04d}.json"


def read_round(file: Path) -> Round:
    """A round from its file.

    Raises:
        PlanError: the file is no round's.
    """
    try:
        table = json.loads(file.read_text())
        lines = {task: Line(line[0], *map(tuple, line[1:])) for task, line in table["lines"].items()}
        return Round(**table | {"lines": lines})
    except (ValueError, TypeError, KeyError, AttributeError):
        raise PlanError(f"{file}: is not a round of a set; run snapshots again, which plans it again") from None


class Plan:
    """A set's lines and rounds, read as they appear."""

    def __init__(self, path: str | Path, description: Description):
        self._path, self._description = Path(path), description
        self.lines: dict[str, Line] = dict(description.lines)
        self.rounds: list[Round] = []
        self.refresh()

    def refresh(self) -> None:
        """Read the rounds that are new."""
        while (file := round_file(self._path, len(self.rounds))).exists():
            new = read_round(file)
            if not all(self._description.has(line) for line in new.lines.values()):
                raise PlanError(f"{file}: must hold lines of its set; run snapshots again, which plans it again")
            self.rounds.append(new)
            self.lines |= new.lines

    def add(self, found: Round) -> None:
        """Write the next round; of several who do, one has written it."""
        file = round_file(self._path, len(self.rounds))
        file.parent.mkdir(exist_ok=True)
        table = asdict(found) | {"lines": {task: list(astuple(line)) for task, line in found.lines.items()}}
        write_whole(file, lambda stream: stream.write(json.dumps(table).encode()), once=True)
        self.refresh()

    def reopen(self) -> None:
        """Forget that the last round found nothing left to do: states will be solved again."""
        if self.rounds and not self.rounds[-1].lines:
            self.rounds.pop()
            round_file(self._path, len(self.rounds)).unlink(missing_ok=True)

    def ended(self, error: float) -> bool:
        """True if no round is to follow for a relative error [-]."""
        last = self.rounds[-1] if self.rounds else None
        return last is not None and not last.lines and (last.finest or last.stalled or last.error <= error)

    def missing(self) -> list[str]:
        """Tasks without a file."""
        present = {file.stem for file in (self._path / "tasks").glob("*.npz")}
        return [task for task in self.lines if task not in present]
