"""The answer of every model at tensions and a distance."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from rom.brief import brief
from rom.console.table import COVERED, Table, as_html, components, number, quantities, row, shown
from rom.native import LIBRARY

# Rows of an answer; the pad's only where a model has it.
TIP, FORCE, TOUCH, PAD = (getattr(LIBRARY.constants, f"FINGERFEM_{name}") for name in ("TIP", "FORCE", "TOUCH", "PAD"))
FEW = 10  # points of many that a table shows
INSIDE = "inside what was trained; errors cover 95 of 100 states"
OUTSIDE = "not inside what was trained: nothing says how far this is from the truth"


@brief
@dataclass(frozen=True, kw_only=True)
class Answer:
    """A model's answer at one point, shapes without n, or at n points.

    Attributes:
        tip: displacement of the tip plate's centre, shape (3,) or (n, 3) [m].
        contact_force: [N], shape () or (n,); zero before touch and in scenes without an obstacle. Among m objects, of
            each: shape (m,) or (n, m); so are the touch distance and both errors.
        touch_distance: of the object, where the free finger touches it [m], shape () or (n,); nan without one.
        pad_pressure: mean contact pressure on the tactile pad [Pa], as the contact force; None if the model does not
            have it.
        error: the estimated one, at most exceeded by 5 % of states, by quantity in its unit, shapes as the quantities
            without components.
        inside: whether the point lies in the model's domain; d = inf is no object, and inside. Outside, the answer is
            that of the nearest point inside, with an error that nothing bounds.
        orientation: of the tip plate's frame, as a unit quaternion w, x, y, z with w >= 0, shape (4,) or (n, 4) [-];
            its sign changes where the tip has turned by half a turn. None of a separated model.
        orientation_error: estimated, an angle [rad], shape () or (n,).
        shortenings: how much shorter every tendon is between the clamp and its plate, shape (t,) or (n, t) [m]: how
            far a position-driven motor has pulled it in. None of a separated model.
        shortening_error: estimated, of each [m], shape () or (n,).
        growths: how much larger every chamber is, shape (chambers,) or (n, chambers) [m^3]. None without chambers.
        growth_error: estimated, of each [m^3], shape () or (n,).
    """

    tip: np.ndarray
    contact_force: Any
    touch_distance: Any
    pad_pressure: Any
    error: Mapping[str, Any]
    inside: Any
    orientation: np.ndarray | None = None
    orientation_error: Any = None
    shortenings: np.ndarray | None = None
    shortening_error: Any = None
    growths: np.ndarray | None = None
    growth_error: Any = None

    def mirrored(self, sides: Sequence[int]) -> Answer:
        """The same of the finger's mirror image: along y and z, 1 as it is, -1 the other side."""
        y, z = sides
        turned = None if self.orientation is None else self.orientation * [1, y * z, z, y]
        return replace(self, tip=self.tip * [1, y, z], orientation=turned)

    def as_json(self, actuators: Sequence[str]) -> dict[str, Any]:
        """Plain numbers at one point, units in names; what the model does not have is left out.

        Args:
            actuators: names of the tendons, then of the chambers.
        """
        numbers: dict[str, Any] = {"tip_m": self.tip.tolist(), "tip_error_m": float(self.error["tip"])}
        for name, unit, value in (
            ("contact_force", "N", self.contact_force),
            ("touch_distance", "m", self.touch_distance),
            ("pad_pressure", "Pa", self.pad_pressure),
        ):
            if value is not None and name in self.error:
                numbers |= {f"{name}_{unit}": _plain(value), f"{name}_error_{unit}": _plain(self.error[name])}
        if self.orientation is not None:
            numbers |= {
                "orientation_wxyz": self.orientation.tolist(),
                "orientation_error_rad": float(self.orientation_error),
            }
        if self.shortenings is not None:
            by_name = dict(zip(actuators[: len(self.shortenings)], self.shortenings.tolist(), strict=True))
            numbers |= {"shortenings_m": by_name, "shortening_error_m": float(self.shortening_error)}
        if self.shortenings is not None and self.growths is not None:
            by_name = dict(zip(actuators[len(self.shortenings) :], self.growths.tolist(), strict=True))
            numbers |= {"growths_m3": by_name, "growth_error_m3": float(self.growth_error)}
        return numbers | {"inside": bool(self.inside)}

    def tables(self, actuators: Sequence[str] = ()) -> list[Table | str]:
        """Tables for people: the first ones of many points, without the tip.

        Args:
            actuators: names of the tendons, then of the chambers; numbers if omitted.
        """
        by_name = {"contact_force": (self.contact_force, "N"), "touch_distance": (self.touch_distance, "m")}
        if self.pad_pressure is not None:
            by_name["pad_pressure"] = self.pad_pressure, "Pa"
        named = [part for name, one in by_name.items() for part in self._by_object(name, *one)]
        if np.ndim(self.tip) > 1:
            return self._many(named)
        rows = components("tip", self.tip, "m", self.error["tip"])
        if self.orientation is not None:
            off = self.orientation_error / 2  # a turn by an angle changes the quaternion by half as much
            rows += [row(f"tip orientation {c}", q, "-", off) for c, q in zip("wxyz", self.orientation, strict=True)]
        rows += self._strokes(actuators)
        rows += [row(*one) for one in named if not np.isnan(one[1])]
        return [quantities(rows), INSIDE if self.inside else OUTSIDE]

    def _strokes(self, actuators: Sequence[str]) -> list[list[str]]:
        """Rows of the shortenings and growths at one point."""
        parts = (
            ("shortening", self.shortenings, "m", self.shortening_error),
            ("growth", self.growths, "m^3", self.growth_error),
        )
        every = [(word, one, unit, off) for word, values, unit, off in parts if values is not None for one in values]
        names = actuators[: len(every)] or range(1, 1 + len(every))
        return [
            row(f"{word} {name}", one, unit, off) for name, (word, one, unit, off) in zip(names, every, strict=True)
        ]

    def _by_object(self, name: str, value: Any, unit: str) -> list[tuple[str, Any, str, Any]]:
        """A quantity with its words, unit and error; of several objects, each one's."""
        words, error = name.replace("_", " "), self.error.get(name)
        if np.ndim(value) < np.ndim(self.tip):
            return [(words, value, unit, error)]
        errors = np.full_like(value, np.nan) if error is None else error
        return [(f"{words} {k + 1}", value[..., k], unit, errors[..., k]) for k in range(value.shape[-1])]

    def _many(self, named: list[tuple[str, Any, str, Any]]) -> list[Table | str]:
        units = [(name, values, shown(unit)[1], errors, unit) for name, values, unit, errors in named]
        header = [word for name, _, unit, _, _ in units for word in (f"{name} [{unit}]", COVERED)]
        rows = []
        for k in range(min(len(self.tip), FEW)):
            words = [number(one, unit, d) for _, v, _, e, unit in units for one, d in ((v[k], 4), (e[k], 2))]
            rows.append([str(k), *words, "yes" if self.inside[k] else "no"])
        title = f"{len(rows)} of {len(self.tip)} points"
        return [Table(title=title, header=["point", *header, "inside"], rows=rows)]

    def _repr_html_(self) -> str:
        return as_html(self.tables())


def _plain(value: Any) -> Any:
    """A number, or a list of one for each object."""
    return np.asarray(value, float).tolist()
