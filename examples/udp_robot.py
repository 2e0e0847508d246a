"""A robot over UDP, without a force sensor: simulated motors on the loopback, a loop at 1 kHz, lost and late readings.

python3 examples/udp_robot.py [PICTURE.png]
"""

import sys
import threading

import rom
from control import GraspOptions, Gripper, Limits, run
from control.feel import Felt, KnownObjects, Noise
from control.robot import Link, LinkedPlant, Losses, SimulatedMotors

model = rom.load()  # the bundled finger before the plane y = side/2 + d
target, distance = 1.0, 0.012  # [N], [m], which the controller does not have
noise = Noise(shortening=5e-6, tension=0.02)  # [m], [N]

# The robot. Of 1500 replies some are lost, and some are two periods late.
losses = Losses(lost=range(400, 406), late=dict.fromkeys(range(700, 760), 2))
motors = SimulatedMotors(
    model, distance, shortening_noise=5e-6, tension_noise=0.02, losses=losses, sensor=False, seed=1
)
ended = threading.Event()


def serve() -> None:
    """Answer commands until the loop ends."""
    while not ended.is_set():
        motors.serve(wait=0.01)


robot = threading.Thread(target=serve)
robot.start()

# The controller. A contact force is felt from tensions and shortenings.
sensed = KnownObjects(model, noise)
last: list[Felt] = []


def felt(reading) -> float:
    """The contact force [N], sought near the last contact."""
    found = sensed.feel(reading.tensions, reading.shortenings, hint=last[-1] if last else None)
    last[:] = [found] if found.converged else []
    return float(found.contact_forces[0])


gripper = Gripper(model, fingers=1, limits=Limits(rate=500.0))  # [N/s]
options = GraspOptions(noise=0.03, feel=0.2, approach_step=0.5, tolerance=0.05, squeeze_steps=100)
with Link(motors.address, tendons=2, patience=20) as link:
    plant = LinkedPlant(link, wait=0.02, felt=felt)  # [s]
    report = run(gripper.grips(target, options), [plant], periods=1500, real_time=True)
ended.set()
robot.join()
motors.close()

counts = link.counts
print(f"{report.status[0]}: {motors.contact_force:.3f} N for {target:g} N, felt {report.felt[-1, 0]:.3f} N")
print(f"readings: {counts.missing} missing, {counts.late} late, {counts.overtaken} overtaken, {counts.refused} refused")
print(f"felt distance {1000 * last[-1].values[0]:.2f} mm, true {1000 * distance:g} mm")
print(f"events: {report.events}")
assert report.status == ["converged"] and abs(motors.contact_force - target) < 0.1 and not link.stopped
assert counts.missing >= 6

if sys.argv[1:]:
    import matplotlib.pyplot as plt

    figure, axis = plt.subplots(figsize=(6, 3), layout="constrained")
    axis.plot(report.felt[:, 0], lw=0.6, label="felt without a sensor")
    axis.axhline(target, color="0.5", lw=0.8, label="target")
    axis.set(xlabel="period of 1 ms", ylabel="contact force [N]")
    axis.legend(frameon=False)
    figure.savefig(sys.argv[1], dpi=120)
