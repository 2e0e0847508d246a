"""A motion, read from a TOML file: loads as functions of time, the base's motion, and steps."""

import csv
import hashlib
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

import numpy as np
from pydantic import Field, ValidationError

from fingerfem.dynamics.signals import Signal, Sine, piecewise, read_signal
from fingerfem.scene.scene import Scene
from fingerfem.scene.scene_table import SceneTable
from fingerfem.scene.toml_file import one_line, read_toml
from rom.dataset.rigid_motion import BaseMotion

BASE = ("ax", "ay", "az", "wx", "wy", "wz")  # acceleration of the clamp [m/s^2], its angular velocity [rad/s]
OUT_OF_PLANE = ("az", "wx", "wy")  # signals that half a finger cannot follow


class Time(SceneTable):
    """Steps of a motion.

    Attributes:
        end: of the motion, which begins at 0 [s].
        step: of every step [s]; with a tolerance, the largest.
        tolerance: of a step's error over the finger's length [-]; steps are then as short as that needs.
        spectral_radius: of the method at high frequencies [-]; 1 damps none, 0 removes them in a step.
    """

    end: Annotated[float, Field(gt=0, le=1e9)]
    step: Annotated[float, Field(gt=0, le=1e9)]
    tolerance: Annotated[float, Field(gt=0, le=0.1)] | None = None
    spectral_radius: Annotated[float, Field(ge=0, le=1)] = 0.8


class MotionFile(SceneTable):
    """The tables of a motion's file; `table` is a CSV file with a column `time` and further loads."""

    time: Time
    loads: dict[str, Any] = {}
    base: dict[str, Any] = {}
    table: str | None = None


@dataclass(frozen=True, kw_only=True)
class Motion:
    """A motion of one scene's finger.

    Attributes:
        time: its steps.
        signals: of loads and base, by name.
        names: of the scene's actuators.
        digest: of all this, and of the scene.
    """

    time: Time
    signals: dict[str, Signal | Sine]
    names: list[str]
    digest: str

    def loads(self, time: float, after: bool) -> tuple[np.ndarray, float | None]:
        """Tensions [N], then pressures [Pa], shape (actuators,), and d [m], None if the obstacle stays away."""
        values = [self._value(name, time, after) for name in self.names]
        return np.array(values), self._value("d", time, after) if "d" in self.signals else None

    @property
    def base_moves(self) -> bool:
        """True if the motion has signals of the base."""
        return any(name in self.signals for name in BASE)

    def base(self, time: float, after: bool) -> BaseMotion:
        """Motion of the base at a time [s]."""
        values = [self._value(name, time, after) for name in BASE]
        rates = [self.signals[name].slope(time, after) if name in self.signals else 0.0 for name in BASE[3:]]
        return BaseMotion(np.array(values[:3]), np.array(values[3:]), np.array(rates))

    def jumps(self, time: float) -> bool:
        """True if a load or the base's acceleration jumps at a time [s]."""
        before, now = (
            np.concatenate([self.loads(time, after)[0], [self._value("d", time, after)], *self.base(time, after)])
            for after in (False, True)
        )
        return not np.array_equal(before, now)

    @property
    def breaks(self) -> np.ndarray:
        """Times at which steps end: those of points, and the motion's end [s]."""
        times = np.concatenate([[self.time.end], *(one.times for one in self.signals.values())])
        return np.unique(times[(times > 0) & (times <= self.time.end)])

    def _value(self, name: str, time: float, after: bool) -> float:
        return self.signals[name].value(time, after) if name in self.signals else 0.0


def read_motion(path: str | Path, scene: Scene) -> Motion:
    """Read a motion of a scene's finger.

    Raises:
        ValueError: one line naming file, field, rule and value.
    """
    try:
        return motion_of(read_toml(path), scene, Path(path).parent)
    except ValidationError as error:
        raise ValueError(f"{path}: {one_line(error)}") from None
    except ValueError as error:
        raise ValueError(str(error) if str(error).startswith(str(path)) else f"{path}: {error}") from None


def motion_of(tables: dict[str, Any], scene: Scene, folder: Path = Path()) -> Motion:
    """The motion that these tables describe, see `read_motion`."""
    file = MotionFile.model_validate(tables)
    signals = {name: read_signal(f"loads.{name}", given) for name, given in file.loads.items()}
    signals |= {name: read_signal(f"base.{name}", given) for name, given in file.base.items()}
    if file.table is not None:
        columns = _columns(folder / file.table)
        if twice := sorted(columns.keys() & signals.keys()):
            raise ValueError(f"table must not have the column {twice[0]}, which loads or base have, got {file.table}")
        signals |= columns
    limits = {one["name"]: one for one in scene.parameters if one["name"] in (*scene.actuators, "d")}
    for name in file.base.keys() - set(BASE):
        raise ValueError(f"base must have the keys {', '.join(BASE)}, got {name}")
    for name in signals.keys() - limits.keys() - set(BASE):
        raise ValueError(f"loads must be of {', '.join(limits)}, got {name}")
    for name, signal in signals.items():
        _check(name, signal, limits.get(name), scene)
    numbers = {name: [np.ravel(value).tolist() for value in vars(one).values()] for name, one in signals.items()}
    described = f"{scene.fingerprint()} {sorted(numbers.items())} {file.time!r}"
    digest = hashlib.sha256(described.encode()).hexdigest()[:16]
    return Motion(time=file.time, signals=signals, names=scene.actuators, digest=digest)


def _check(name: str, signal: Signal | Sine, limits: dict[str, Any] | None, scene: Scene) -> None:
    if limits is not None:
        for value in signal.limits:
            if not limits["lower"] <= value <= limits["upper"]:
                allowed = f"[{limits['lower']:g}, {limits['upper']:g}] {limits['unit']}"
                raise ValueError(f"loads.{name} must lie in {allowed}, got {value:g}")
    if name in BASE[3:] and signal.has_jumps:
        raise ValueError(f"base.{name} must not jump, which would take infinite forces; give it a ramp, got a jump")
    if scene.is_half and name in OUT_OF_PLANE:
        raise ValueError(
            f"base.{name} must be left out where half a finger is modelled; set mesh.symmetry = false, got a signal"
        )


def _columns(path: Path) -> dict[str, Signal]:
    """Signals of a CSV file by its columns."""
    try:
        with path.open(newline="", encoding="utf-8-sig") as stream:
            header, *rows = [row for row in csv.reader(stream) if row]
        values = np.array(rows, float).T
    except OSError as error:
        raise ValueError(f"table must be a file, got {path}: {error.strerror}") from None
    except ValueError as error:
        raise ValueError(f"table must be a CSV file of numbers under a header, got {path}: {error}") from None
    names = [name.strip() for name in header]
    if "time" not in names or len(values) != len(names) or not values.size:
        raise ValueError(f"table must have a column time, and a value in every column, got {path}")
    times = values[names.index("time")]
    return {name: piecewise(name, times, own) for name, own in zip(names, values, strict=True) if name != "time"}
