"""Measures the parts of docs/peers.md that need other packages, in a virtual environment that has them.

python -m studies.peers.others [PART ...] [--quick] [--out OUT]    as `make docs` does
"""

from __future__ import annotations

import argparse
import time
from importlib import import_module
from pathlib import Path

from studies.runner import OUT, finished, place, read

# Module that measures, by part; each is imported where it is measured alone.
PARTS = {"rods": "rods.comparison", "calculix": "calculix.comparison"}


def main() -> None:
    """Measure what is not there."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("parts", nargs="*", choices=[*PARTS, []], help="all by default")
    parser.add_argument("--out", type=Path, default=OUT)
    parser.add_argument("--quick", action="store_true", help="the short forms")
    options = parser.parse_args()
    out = options.out.resolve()
    for part in options.parts or PARTS:
        name = f"peers/{part}"
        if read(name, out, options.quick):
            print(f"{name}: kept", flush=True)
            continue
        print(name, flush=True)
        run = place(name, out, options.quick)
        run.folder.mkdir(parents=True, exist_ok=True)
        begun = time.perf_counter()
        finished(run, import_module(f"studies.peers.{PARTS[part]}").measure(run), time.perf_counter() - begun)


if __name__ == "__main__":
    main()
