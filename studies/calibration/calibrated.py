"""The bundled finger, calibrated on logs of full-order states of another law and mesh, with noise."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

from control import Calibration, CalibrationOptions, calibrate
from control.calibration.fit import information
from control.finger import NORMAL_95
from control.log import write_log
from rom import TouchedSegment
from studies.calibration.states import LAWS
from studies.parts import Run

LOGS, POSES, SEED = 30, (20, 40), 3  # logs, and the number of poses of each
STIFFNESS = (0.85, 1.1)  # modulus of a log's rubber over that of the states: similarity is exact [-]
NOISE = {"tension": 0.02, "position": 5e-4, "orientation": np.deg2rad(1.0), "contact_force": 0.02}  # [-, m, rad, -]
BASE = np.array([5e-3] * 3 + [0.1] * 3)  # largest offsets of the base [m, rad]
NONE = {name: 1e-3 * size for name, size in NOISE.items()}  # of logs without noise
LEAST, CLOSE = 0.1, 0.03  # contact force that is compared [N], and a small error of it [-]
States = dict[str, np.ndarray]


def arrays(states: list[dict[str, Any]]) -> States:
    """The states by quantity; infinite distances are those of free ones."""
    found = {name: np.array([one[name] for one in states], float) for name in states[0] if name != "distance"}
    return found | {"distance": np.array([np.inf if one["distance"] is None else one["distance"] for one in states])}


def columns(states: States, rows: np.ndarray, modulus: float, base: np.ndarray, random: Any) -> dict[str, np.ndarray]:
    """A log of some states, with noise if there is a random generator; contact only where it is among the states."""
    n, own = len(rows), {name: one[rows] for name, one in states.items()}

    def noise(name: str, *shape: int) -> np.ndarray:
        return np.zeros(shape) if random is None else NOISE[name] * random.normal(size=shape)

    turn, rest = Rotation.from_rotvec(base[3:]), TouchedSegment.load().rod.rest
    tensions = modulus * own["tensions"] * (1 + noise("tension", n, 2))
    places = base[:3] + turn.apply(own["tip"] + rest) + noise("position", n, 3)
    turned = turn * Rotation.from_matrix(own["rotation"]) * Rotation.from_rotvec(noise("orientation", n, 3))
    found = {f"F{k + 1} [N]": tensions[:, k] for k in range(2)}
    found |= {f"{axis} [mm]": 1e3 * places[:, k] for k, axis in enumerate("xyz")}
    found |= {f"q{axis} [-]": turned.as_quat()[:, k - 1] for k, axis in enumerate("wxyz")}
    if np.isfinite(own["distance"]).any():
        touched = np.isfinite(own["distance"])
        found["contact force [N]"] = modulus * own["force"] * (1 + noise("contact_force", n))
        found["d [mm]"] = np.where(touched, 1e3 * np.where(touched, own["distance"], 0.0), np.nan)
    return found


def without_noise(folder: Path, states: States, rows: np.ndarray) -> Calibration:
    """A log of states without noise, calibrated: with this modulus the model's law acts like the states' own."""
    file = write_log(folder / "effective.csv", columns(states, rows, 1.0, np.zeros(6), None))
    return calibrate(TouchedSegment.load(), file, CalibrationOptions(noise=NONE))


def modulus_of(found: Calibration) -> float:
    """The modulus over the small-strain one."""
    return found.value("modulus") / found.parameters[0].start


def least_deviation(found: Calibration) -> float:
    """The bound of Cramer and Rao for the standard deviation of the modulus with the noise of the logs [-]."""
    given = information(found.measured, NOISE, found.fit.unknowns, found.fit.tensions)
    return float(np.sqrt(np.linalg.inv(given)[0, 0]))


def one_log(folder: Path, states: States, pool: np.ndarray, truth: float, seed: int) -> dict[str, Any]:
    """A log of random states of a pool, and what its calibration returns."""
    random = np.random.default_rng((SEED, seed))
    rows = random.choice(pool, min(int(random.integers(POSES[0], POSES[1] + 1)), len(pool)), replace=False)
    stiff, base = random.uniform(*STIFFNESS), BASE * random.uniform(-1, 1, 6)
    file = write_log(folder / f"log-{seed}.csv", columns(states, rows, stiff, base, random))
    found = calibrate(TouchedSegment.load(), file)
    values = [stiff * truth * found.parameters[0].start, *base.tolist()]
    covered = [
        bool(one.interval and one.interval[0] <= value <= one.interval[1])
        for one, value in zip(found.parameters, values, strict=True)
    ]
    modulus = modulus_of(found)
    return {
        "poses": found.poses,
        "bound": least_deviation(found),
        "modulus": modulus / (stiff * truth) - 1,
        "small_strain": modulus / stiff - 1,
        "covered": covered,
        "warnings": list(found.warnings),
        "forces": force_errors(found, states, rows, stiff),
    }


def force_errors(found: Calibration, states: States, logged: np.ndarray, stiff: float) -> list[float]:
    """Relative errors of the calibrated finger's contact forces in states that are not in the log."""
    others = np.setdiff1d(np.flatnonzero(np.isfinite(states["distance"])), logged)
    others = others[stiff * states["force"][others] > LEAST]
    found.rod.save(Path(found.measured.log.path).with_suffix(".h5"))
    finger = TouchedSegment.load(Path(found.measured.log.path).with_suffix(".h5"))
    pulled = stiff * states["tensions"][others]
    inside = (pulled <= finger.limits[1][:2]).all(axis=1)
    answer = finger.evaluate(pulled[inside], states["distance"][others][inside])
    return (answer.contact_force / (stiff * states["force"][others][inside]) - 1).tolist()


def summary(logs: list[dict[str, Any]]) -> dict[str, Any]:
    """Numbers of a table's row."""
    covered = np.array([one["covered"] for one in logs])
    errors, small = (np.abs([one[name] for one in logs]) for name in ("modulus", "small_strain"))
    forces = np.abs(np.concatenate([one["forces"] for one in logs]))
    return {
        "logs": len(logs),
        "poses": [min(one["poses"] for one in logs), max(one["poses"] for one in logs)],
        "modulus": quantiles(errors),
        "bound": float(NORMAL_95 * np.sqrt(np.mean([one["bound"] ** 2 for one in logs]))),
        "small_strain": quantiles(small),
        "modulus_covered": float(covered[:, 0].mean()),
        "base_covered": float(covered[:, 1:].mean()),
        "warned": sum(bool(one["warnings"]) for one in logs),
        "force": force_summary(forces),
    }


def force_summary(errors: np.ndarray) -> dict[str, float]:
    """Quantiles of sizes of errors, and the share of small ones."""
    return quantiles(errors) | {"count": len(errors), "close": float((errors < CLOSE).mean())}


def quantiles(values: np.ndarray) -> dict[str, float]:
    """Median, 95th percentile and largest."""
    return dict(zip(("median", "p95", "max"), map(float, np.percentile(values, [50, 95, 100])), strict=True))


def measure(run: Run) -> dict[str, Any]:
    """30 logs of free poses, and 30 with contact, half of them of each law."""
    pools = json.loads((run.folder / "states.json").read_text())["result"]
    result: dict[str, Any] = {"laws": {}}
    logs: dict[str, list[dict[str, Any]]] = {"free poses": [], "with contact forces": []}
    for k, (law, pool) in enumerate(zip(LAWS, pools, strict=True)):
        states = arrays(pool)
        free = np.flatnonzero(~np.isfinite(states["distance"]))
        every = np.arange(len(states["force"]))
        exact = [without_noise(run.folder, states, rows) for rows in (free, every)]
        truths = [modulus_of(one) for one in exact]
        forces = np.abs(force_errors(exact[1], states, np.array([], int), 1.0))
        result["laws"][law] = {
            "states": len(every),
            "free": truths[0] - 1,
            "contact": truths[1] - 1,
            "force": force_summary(forces),
        }
        for name, rows, truth in zip(logs, (free, every), truths, strict=True):
            first = LOGS // len(LAWS) * k
            logs[name] += [one_log(run.folder, states, rows, truth, first + i) for i in range(LOGS // len(LAWS))]
    return result | {"kinds": {name: summary(those) for name, those in logs.items()}}
