"""A gripper: forces that neither drop nor crush an egg, a grasp with flawed sensors, and faults in the loop.

python3 examples/gripper.py [PICTURE.png]
"""

import sys

import numpy as np

import rom
from control import Flaws, Gripper, Limits, Object, SimulatedPlant, run
from control.plant import Dead, Slipping

model = rom.load()
gripper = Gripper(model, fingers=3, radius=0.025, limits=Limits(rate=500.0))

egg = Object(mass=0.06, friction=0.5, admissible_force=3.0, down=(1.0, 0.0, 0.0))  # hanging down
targets = gripper.targets(egg)
print(
    f"egg: {targets.least:.2f} N carry it, {targets.most:.2f} N crush it, targets {targets.contact_forces.round(2)} N"
)
assert targets.exist and targets.least < targets.contact_forces[0] < targets.most
stone = Object(mass=2.0, friction=0.3, admissible_force=5.0)
print(f"stone: {gripper.targets(stone).reason}")

# The fingers close, feel, find, squeeze and hold; the egg's position and size are unknown to them.
flaws = Flaws(noise=0.01, resolution=0.005, delay=3, force_error=0.05)  # of sensors and model
options = gripper.options(targets.contact_forces.min(), noise=0.01, delay=3)
plants = [SimulatedPlant(model, d, flaws, seed=i) for i, d in enumerate(gripper.distances([0.002, -0.001], 0.012))]
grasp = gripper.grasp(targets.contact_forces, plants, options)
print(f"grasp: {grasp.status}, centre {(1000 * grasp.centre).round(2)} mm, radius {1000 * grasp.radius:.2f} mm")
assert grasp.converged and np.allclose(grasp.contact_forces, targets.contact_forces, rtol=0.03)

# Faults in a loop of 900 periods: a tendon slips, a sensor dies.
broken = [Slipping(plants[0], tendon=0, share=0.8, begin=500), Dead(plants[1], begin=600), plants[2]]
report = run(gripper.grips(1.0, options), broken, periods=900)
print(f"loop: {report.status}; events {report.events[-1]}")
assert report.status == ["converged", "sensor_failed", "converged"]  # the finger without sensor keeps its tensions
assert 608 < report.events[-1][0] < 650 and report.events[-1][2] == "blind"

if sys.argv[1:]:
    import matplotlib.pyplot as plt

    figure, axes = plt.subplots(figsize=(5, 4), layout="constrained")
    for finger in range(len(plants)):
        pulls = [pull for pull in grasp.history if pull.finger == finger]
        axes.plot([pull.time for pull in pulls], [pull.contact_force for pull in pulls], label=f"finger {finger + 1}")
    axes.axhline(targets.contact_forces[0], color="0.5", ls="--", label="target")
    axes.set(xlabel="control period", ylabel="contact force [N]")
    axes.legend()
    figure.savefig(sys.argv[1], dpi=120)
