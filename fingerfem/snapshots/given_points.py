"""Held-out points that somebody chose: a table whose columns are the scene's parameters."""

import csv
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from fingerfem.scene.scene import Scene


@dataclass(frozen=True)
class GivenPoints:
    """Points of a CSV file: a line of the parameters' names (F1,F2,d), then a line of numbers [N, m] for each point.

    Points that follow each other with the same tensions are solved one after the other: cheaper, from far to near.
    """

    file: Path

    def points(self, scene: Scene, box: np.ndarray) -> list[list[float]]:
        """Parameters, shape (count, p), all of them in a box of lower and upper ends, shape (p, 2).

        Raises:
            ValueError: no such file, other columns, no points, or one outside.
        """
        names = [parameter["name"] for parameter in scene.parameters]
        try:
            with self.file.open(newline="", encoding="utf-8-sig") as stream:
                rows = [row for row in csv.reader(stream) if row]
        except UnicodeDecodeError as error:
            raise ValueError(f"{self.file}: must be a text file in UTF-8, got {error}") from None
        if not rows or sorted(word.strip() for word in rows[0]) != sorted(names):
            raise ValueError(f"{self.file}: columns must be {','.join(names)}, got {','.join(rows[0]) if rows else ''}")
        order = [[word.strip() for word in rows[0]].index(name) for name in names]
        points = [self._point(row, order) for row in rows[1:]]
        if not points:
            raise ValueError(f"{self.file}: must have a line for each point, got none")
        for number, point in enumerate(points):
            for one, value, (lower, upper) in zip(scene.parameters, point, box, strict=True):
                if not lower <= value <= upper:
                    allowed = f"[{lower:g}, {upper:g}] {one['unit']}"
                    raise ValueError(
                        f"{self.file}: {one['name']} must lie in {allowed}, got {value:g} in point {number + 1}"
                    )
        return points

    def _point(self, words: list[str], order: list[int]) -> list[float]:
        try:
            return [float(words[k]) for k in order]
        except (ValueError, IndexError):
            raise ValueError(f"{self.file}: points must be numbers, got {','.join(words)}") from None
