"""How states, terms, bytes and query time grow with the number of parameters.

python3 studies/surrogate/growth.py [OUT] [--quick]    prints rows, writes OUT/growth.json (out/surrogate by default)

The finger of two segments with both pairs of tendons (scenes/four_tendons.toml, on a coarser mesh), pulled by one to
four of them; lines of states at scattered tensions, 40 a tension.
"""

from __future__ import annotations

import argparse
import json
import re
import sys
import time
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT))

from rom.build import train
from rom.held_out import check
from rom.separation.alternating_directions import EnrichmentOptions
from rom.surrogate import Surrogate
from studies.sets import held_out, training, written
from studies.solver.solver import say
from studies.surrogate.surrogate import draw, honesty, timed

PULLED = {2: ["F_l1"], 3: ["F_s1", "F_l1"], 4: ["F_s1", "F_l1", "F_l2"], 5: ["F_s1", "F_s2", "F_l1", "F_l2"]}
CELLS = ("cells = [20, 9]", "cells = [12, 9]")
LINES = 40  # a tension
FRESH = {2: 100, 3: 100, 4: 100, 5: 200}
SEED = 11
ENOUGH = 0.01  # separation error for which terms are counted


def scene(folder: Path, parameters: int, lines: int = LINES) -> Path:
    """The four tendons' scene with the first of them, and so many lines of states a tension."""
    text = (ROOT / "scenes" / "four_tendons.toml").read_text().replace(*CELLS)
    head, *tendons = re.split(r"(?=\[\[tendons\]\])", text.replace('"four tendons"', '"growth"'))
    tendons[-1], rest = tendons[-1].split("[obstacle]", 1)
    named = {re.search(r'name = "(\w+)"', tendon)[1]: tendon for tendon in tendons}  # type: ignore[index]
    pulled = PULLED[parameters]
    sampling = f"\n[sampling]\nlines = {lines * len(pulled)}\nstore = []\n"
    return written(
        folder, f"growth {parameters}", head + "".join(named[name] for name in pulled) + "[obstacle]" + rest + sampling
    )


def terms_for(model: Surrogate, error: float) -> int | None:
    """Terms of the regime of most states for a separation error; None if it has too few."""
    form = max(model.regimes, key=lambda regime: regime.states).form
    good = np.flatnonzero(form.errors <= error)
    return int(good[0]) + 1 if good.size else None


def main(folder: Path, quick: bool) -> None:
    """Measure, print, write."""
    folder.mkdir(parents=True, exist_ok=True)
    rows = []
    for parameters, names in PULLED.items():
        if quick and len(names) > 2:
            continue
        file = scene(folder, parameters, 8 if quick else LINES)
        states = training(file)
        begun = time.perf_counter()
        model = train(states, EnrichmentOptions())
        seconds = time.perf_counter() - begun
        fresh = held_out(file, "fresh", 20 if quick else FRESH[parameters], SEED)
        report = check(model, fresh)
        rows.append(
            {
                "parameters": parameters,
                "tendons": names,
                "states": states.states,
                "grid_states": 9 ** len(names) * 13,
                "regimes": len(model.regimes),
                "terms": terms_for(model, ENOUGH),
                "all_terms": sum(model.terms.values()),
                "bytes": model.bytes,
                "separation_seconds": seconds,
                "query": timed(model.value_and_jacobian, draw(model, 5000)),
                "contact_force": report["contact_force"],
                "tip": report["tip"],
                "said": honesty(model, fresh)["contact_force"],
                "wrong_touch_decisions": report["touch"]["wrong_beyond_margin"],
            }
        )
        say(rows[-1])
    (folder / "growth.json").write_text(json.dumps(rows, indent=1))


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("out", type=Path, nargs="?", help="out/surrogate by default, out/surrogate-quick if quick")
    parser.add_argument("--quick", action="store_true", help="one and two tendons, a fifth of the lines")
    given = parser.parse_args()
    usual = ROOT / "out" / ("surrogate-quick" if given.quick else "surrogate")
    main((given.out or usual).resolve(), given.quick)
