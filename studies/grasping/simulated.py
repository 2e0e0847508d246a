"""Measures the parts of docs/grasping.md that need MuJoCo, in a virtual environment that has it.

python -m studies.grasping.simulated [PART ...] [--quick] [--out OUT]    as `make docs` does
"""

from __future__ import annotations

import argparse
import time
from pathlib import Path

from studies.grasping import grasps, learning, physics, pictures
from studies.runner import OUT, finished, place, read

PARTS = {
    "grasps": grasps.measure,
    "physics": physics.measure,
    "learning": learning.measure,
    "pictures": pictures.measure,
}


def main() -> None:
    """Measure what is not there."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("parts", nargs="*", choices=[*PARTS, []], help="all by default")
    parser.add_argument("--out", type=Path, default=OUT)
    parser.add_argument("--quick", action="store_true", help="the short forms")
    options = parser.parse_args()
    for part in options.parts or PARTS:
        name = f"grasping/{part}"
        if read(name, options.out, options.quick):
            print(f"{name}: kept", flush=True)
            continue
        print(name, flush=True)
        run = place(name, options.out.resolve(), options.quick)
        run.folder.mkdir(parents=True, exist_ok=True)
        begun = time.perf_counter()
        finished(run, PARTS[part](run), time.perf_counter() - begun)


if __name__ == "__main__":
    main()
