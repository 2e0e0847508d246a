"""Logs of a finger with known parameters, as CSV files."""

from pathlib import Path

import numpy as np
from scipy.spatial.transform import Rotation

import rom
from control.calibration.scaled_finger import ScaledFinger, Scales
from control.log import write_log
from rom import TouchedSegment

BASE = (0.002, -0.001, 0.003, 0.05, -0.03, 0.02)  # [m], [rad]
NOISE = {"tension": 0.02, "position": 5e-4, "orientation": np.deg2rad(1.0), "shortening": 2e-4, "contact_force": 0.02}
PULLEY, SOFT = 0.012, Scales(modulus=0.9)  # [m]


def columns(
    seed: int,
    *,
    count: int = 30,
    noise: float = 1.0,
    scales: Scales = SOFT,
    contact: bool = False,
    model: TouchedSegment | None = None,
) -> dict[str, np.ndarray]:
    """Values of all columns by their headings, shape (count,)."""
    random = np.random.default_rng(seed)
    finger = ScaledFinger(model or rom.load(), guides=scales.friction > 0)
    pulled = random.uniform(1, 85, (count, 2)) * scales.force
    distances = random.uniform(0.008, 0.02, count) * scales.size if contact else np.full(count, np.inf)
    outputs = finger.at(scales, pulled, distances)
    base, own = Rotation.from_rotvec(BASE[3:]), Rotation.from_quat(outputs.orientation[:, [1, 2, 3, 0]])

    def normal(name: str, *shape: int) -> np.ndarray:
        return noise * NOISE[name] * random.normal(size=shape)

    tensions = pulled * (1 + normal("tension", count, 2))
    position = np.array(BASE[:3]) + base.apply(outputs.position) + normal("position", count, 3)
    turned = (base * own * Rotation.from_rotvec(normal("orientation", count, 3))).as_quat()
    shortening = outputs.shortening + normal("shortening", count, 2)
    found = {f"F{k + 1} [N]": tensions[:, k] for k in range(2)}
    found |= {f"F{k + 1} [mm]": 1e3 * shortening[:, k] for k in range(2)}
    found |= {f"F{k + 1} [N mm]": 1e3 * PULLEY * tensions[:, k] for k in range(2)}
    found |= {f"F{k + 1} [rad]": shortening[:, k] / PULLEY for k in range(2)}
    found |= {f"{axis} [mm]": 1e3 * position[:, k] for k, axis in enumerate("xyz")}
    found |= {f"q{axis} [-]": turned[:, k - 1] for k, axis in enumerate("wxyz")}
    if contact:
        found["contact force [N]"] = outputs.contact_force * (1 + normal("contact_force", count))
        found["d [mm]"] = 1e3 * distances
    return found


def written(file: Path, values: dict[str, np.ndarray], *names: str) -> Path:
    """A file with the columns whose headings begin with some names, such as "F1 [N]" or "x"; all of them by default."""
    kept = [heading for heading in values if not names or heading in names or heading.split()[0] in names]
    return write_log(file, {heading: values[heading] for heading in kept})
