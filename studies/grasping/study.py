"""The parts of docs/grasping.md."""

from studies.grasping import full_order

# By the Python that has MuJoCo, before the full-order part: python -m studies.grasping.simulated
SIMULATED = ("grasps", "physics", "learning", "pictures")
PARTS = {**dict.fromkeys(SIMULATED), "full_order": full_order.measure}
FULL_ONLY = tuple(PARTS)
