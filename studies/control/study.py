"""The parts of docs/speed.md."""

from studies.control import campaigns, grasps, loop, verification

PARTS = {
    "campaigns": campaigns.measure,
    "loop": loop.measure,
    "grasps": grasps.measure,
    "verification": verification.measure,
}
