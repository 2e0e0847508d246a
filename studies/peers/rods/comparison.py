"""Part `rods`: what is taken for soft robots in place of finite elements, asked the same; needs elastica and mujoco.

Two beams that need no package, a Cosserat rod by PyElastica, and MuJoCo as a chain of joints and as a flex. SOFA, which
would be the nearest, comes from conda or its own site, not from PyPI or Debian as the others here do.
"""

from __future__ import annotations

from studies.peers.rods import constant_curvature, cosserat_rod, mujoco_chain, mujoco_flex
from studies.runner import Run, say

METHODS = {
    "constant curvature": constant_curvature.measure,
    "Cosserat rod": cosserat_rod.measure,
    "MuJoCo chain": mujoco_chain.measure,
    "MuJoCo flex": mujoco_flex.measure,
}


def measure(run: Run) -> list[dict]:
    """Everybody's answers, as `question.Answers` has them."""
    found = []
    for name, measured in METHODS.items():
        told = run.once(name, lambda ask=measured: [one.as_json() for one in ask(run.quick)])
        for one in told:
            say(one)
        found += told
    return found
