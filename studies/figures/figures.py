"""Free states, contact states and two segments, drawn as figures 3, 4 and 6 of the paper."""

from __future__ import annotations

import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from functools import partial

from studies.parts import ROOT, Run

# Scene, and what `fingerfem render` is to draw, by picture.
PICTURES = {
    "free": ("one_segment", ("F1=50", "F1=100", "F1=50 F2=50", "F1=100 F2=100")),
    "contact": ("one_segment", ("F1=50 d=0.005", "F1=100 d=0.005", "F1=50 F2=50 d=0.005", "F1=100 F2=50 d=0.015")),
    "two_segments": ("two_segments", ("F_l=40", "F_s=40", "F_s=20 F_l=20 d=0.03", "F_s=40 F_l=40 d=0.03")),
}


CORES = 2


def picture(run: Run, name: str) -> dict:
    """Draw one into the study's folder."""
    scene, cases = PICTURES[name]
    words = [sys.executable, "-m", "fingerfem", "render", f"scenes/{scene}.toml", str(run.folder / f"{name}.png")]
    for case in cases:
        words += ["--case", case]
    subprocess.run(words, cwd=ROOT, stdout=subprocess.DEVNULL, check=True)
    return {"scene": scene, "cases": list(cases)}


def measure(run: Run) -> dict[str, dict]:
    """By picture; the first in the short form."""
    names = list(PICTURES)
    with ThreadPoolExecutor(CORES) as pool:
        return dict(zip(names, pool.map(partial(picture, run), names), strict=True))
