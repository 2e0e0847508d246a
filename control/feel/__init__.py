"""Feel a contact without a sensor: its force and position from the tensions and shortenings of the tendons."""

from control.feel.contacts import KnownObjects, UnknownForce
from control.feel.felt import Felt, Noise

__all__ = ["Felt", "KnownObjects", "Noise", "UnknownForce"]
