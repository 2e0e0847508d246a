"""Fingers of real robots as plants: readings of a log, and motors that answer over UDP or a serial line."""

from control.robot.link import Link, Sample
from control.robot.messages import Reading
from control.robot.motors import Losses, SimulatedMotors
from control.robot.plants import LinkedPlant, ReplayedPlant
from control.robot.serial_bridge import SerialBridge

__all__ = ["Link", "LinkedPlant", "Losses", "Reading", "ReplayedPlant", "Sample", "SerialBridge", "SimulatedMotors"]
