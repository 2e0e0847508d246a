"""A robot on a serial line at 1 kHz: simulated motors behind a pseudo terminal, or your own behind a port (pyserial).

python3 examples/serial_robot.py [PORT]
"""

import os
import sys
import threading
import tty
from io import FileIO

import rom
from control import GraspOptions, Gripper, Limits, run
from control.robot import Link, LinkedPlant, SerialBridge, SimulatedMotors

model = rom.load()  # the bundled finger before the plane y = side/2 + d
target, distance = 1.0, 0.012  # [N], [m], which the controller does not have
ended = threading.Event()
serving = []  # a thread repeats this until the loop ends

if sys.argv[1:]:
    import serial

    line = serial.Serial(sys.argv[1], 921600, timeout=0)  # a period of 1 ms has 84 bytes: 840 kbaud
else:
    ends = os.openpty()
    for end in ends:
        tty.setraw(end)
    line, other = (FileIO(end, "r+") for end in ends)
    motors = SimulatedMotors(model, distance)
    robot = SerialBridge(other, motors.address)  # in firmware: frames of control/robot/serial_bridge.py
    serving += [lambda: motors.serve(wait=0.01), lambda: robot.forward(wait=0.01)]
bridge = SerialBridge(line)
serving.append(lambda: bridge.forward(wait=0.01))


def repeat(call) -> None:
    """Call until the loop ends."""
    while not ended.is_set():
        call()


threads = [threading.Thread(target=repeat, args=(call,)) for call in serving]
for thread in threads:
    thread.start()
gripper = Gripper(model, fingers=1, limits=Limits(rate=500.0))  # [N/s]
options = GraspOptions(noise=0.01, approach_step=0.5, tolerance=0.05)
try:
    with Link(bridge.address, tendons=2, patience=100) as link:
        report = run(gripper.grips(target, options), [LinkedPlant(link, wait=0.02)], periods=1000, real_time=True)
finally:
    ended.set()
    for thread in threads:
        thread.join()
counts = link.counts
print(f"{report.status[0]}: measured {report.felt[-1, 0]:.3f} N for {target:g} N")
print(f"readings: {counts.missing} missing, {counts.late} late, {counts.overtaken} overtaken, {counts.refused} refused")
print(f"frames: {bridge.broken} broken")
print(f"events: {report.events}")
assert report.status == ["converged"] and abs(report.felt[-1, 0] - target) < 0.1 and not link.stopped
