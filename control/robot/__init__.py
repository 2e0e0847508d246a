"""Fingers of real robots as plants: readings of a log, and motors that answer over UDP."""

from control.robot.link import Link, Sample
from control.robot.messages import Reading
from control.robot.motors import Losses, SimulatedMotors
from control.robot.plants import LinkedPlant, ReplayedPlant

__all__ = ["Link", "LinkedPlant", "Losses", "Reading", "ReplayedPlant", "Sample", "SimulatedMotors"]
