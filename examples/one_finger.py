"""One finger: reach a point, follow a path, feel a plane, hold a force.

python3 examples/one_finger.py [PICTURE.png]
"""

import sys

import numpy as np

import rom
from control import Finger, Limits

model = rom.load()  # the bundled finger before the plane y = side/2 + d
finger = Finger(model, limits=Limits(upper=90.0, rate=500.0))  # [N], [N/s]

# The tip plate's centre moves to a point below the finger: mirror images of the tendons pull.
goal = finger.rest + model.evaluate([40.0, 30.0, np.inf]).tip * [1, -1, 1]
motion = finger.reach(goal)
print(f"reach: {motion.status}, tendons on sides {motion.sides}, {1e6 * motion.residual:.1f} µm from the point")
assert motion.status == "converged" and motion.sides == (-1, 1) and motion.residual < 1e-4  # [m]

# A point behind a plane: the answer has the nearest tensions that leave the plane untouched.
blocked = finger.reach(finger.rest + model.evaluate([60.0, 0.0, np.inf]).tip, distance=0.010)
print(f"reach behind a plane: {blocked.status}, tensions {blocked.tensions.round(2)} N")
assert blocked.status == "unreachable"

# A path, one point a period; no tension changes faster than its motor.
path = [finger.rest + model.evaluate([f, 20.0, np.inf]).tip for f in np.linspace(20, 40, 50)]
motions = finger.follow(path, period=0.01, start=[20.0, 20.0])
change = np.abs(np.diff([one.tensions for one in motions], axis=0)).max()
print(
    f"follow: {sum(one.converged for one in motions)} of {len(path)} points, tensions change by at most {change:.2f} N"
)
assert all(one.converged for one in motions) and change <= 5.0

# The plane's distance from a measured force; `deviation` combines the sensor's noise and the model's error.
felt = model.evaluate([50.0, 10.0, 0.012]).contact_force
found = finger.locate([50.0, 10.0], felt, noise=0.01)
print(f"locate: d = {1000 * found.distance:.3f} mm, standard deviation {1000 * found.deviation:.3f} mm")
assert abs(found.distance - 0.012) < 1e-6 and 0 < found.deviation < 1e-3

# A contact force; of all tensions that hold it, those nearest to the present ones.
held = finger.hold(contact_force=1.0, distance=found.distance, start=[50.0, 10.0])
print(f"hold: {held.status}, tensions {held.tensions.round(2)} N, estimated error {held.error:.4f} N")
assert held.converged and 0 < held.error < 0.5
for force, distance in ((50.0, 0.012), (1.0, 0.2)):
    print(f"hold {force:g} N at {1000 * distance:g} mm: {finger.hold(force, distance).status}")

if sys.argv[1:]:
    import matplotlib.pyplot as plt

    figure, axes = plt.subplots(figsize=(5, 3.5), layout="constrained")
    along = np.linspace(0.0, sum(model.scene["geometry"]["segments"]), 60)
    for tensions, label in (
        ([0.0, 0.0], "at rest"),
        (motions[-1].tensions, "end of the path"),
        (held.tensions, "holds 1 N"),
    ):
        plane = found.distance if label == "holds 1 N" else np.inf
        axes.plot(*1000 * model.sections([*tensions, plane], along).centres[:, :2].T, lw=8, alpha=0.7, label=label)
    axes.plot(*1000 * np.array(path)[:, :2].T, "k-", lw=2, label="path")
    axes.axhline(1000 * (0.005 + found.distance), color="0.5", label="plane")
    axes.set(xlabel="x [mm]", ylabel="y [mm]", aspect="equal")
    figure.legend(loc="outside upper center", ncols=3)
    figure.savefig(sys.argv[1], dpi=120)
