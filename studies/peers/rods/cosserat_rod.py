"""A Cosserat rod by PyElastica, pulled by a tendon in a channel of its own and damped to rest.

Its elements are rubber with the square's own second moments; two more lie in the clamp and are the plate, so that
bending begins at the clamp's face and ends at the plate. Mass and damping are only there to come to rest soon.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from importlib.metadata import version

import elastica
import numpy as np

from studies.peers.question import FREE, Answers, Finger, finger
from studies.peers.rods.asking import Rubber, answers, tip
from studies.peers.rods.cosserat_forces import Loads, Plane, Tendon

ELEMENTS = 60  # of rubber
PLANE = 500.0  # stiffness of the plane's spring over that of the finger at its tip, 3 E I/L^3
DENSITY = 1000.0  # [kg/m^3]
FIRST_MODE = 3.516  # of a clamped beam: its angular frequency is this times sqrt(E I/(rho A L^4))
DAMPING = 2.0  # over that frequency: critical
# Time step over an element's length and the speed of sound; times the frequency of the plate's end on the plane's
# spring. A little more and a touched rod never comes quite to rest.
STABLE = 0.3
STABLE_SPRING = 0.3
REST = 1e-6  # error left when a rod is taken to be at rest, over its length: speed over the first frequency [-]
CHECK = 50  # steps between two looks whether it is at rest
COMING = 4.0  # time in which the plane comes to its place, in 1/frequency
LONGEST = 200.0  # time after which a state is given up, in 1/frequency
CLAMP = 0.1  # length of the element in the clamp over that of the others: what is not stretched weighs little
SHEAR_FACTOR = 5 / 6  # of a rectangle


class Simulator(elastica.BaseSystemCollection, elastica.Constraints, elastica.Forcing, elastica.Damping):
    """What a rod with a clamp, forces and damping needs of PyElastica."""


@dataclass(frozen=True)
class Rest:
    """Where a rod was before anything pulled."""

    position: np.ndarray
    directors: np.ndarray


class Rod:
    """The finger as a rod of PyElastica."""

    def __init__(self, finger: Finger, elements: int, stiffness: float) -> None:
        rubber = Rubber(finger)
        self.finger, self.element = finger, rubber.length / elements
        self.frequency = FIRST_MODE * math.sqrt(rubber.bending / (DENSITY * finger.side**2 * rubber.length**4))
        self.rod = _rod(finger, elements)
        spring = stiffness * 3 * rubber.bending / rubber.length**3
        self.loads = Loads(offset=finger.offset, half=finger.side / 2, stiffness=spring)
        turning = self.loads.half**2 * self.rod.inv_mass_second_moment_of_inertia[1, 1, -1]
        bouncing = math.sqrt(spring * (1 / self.rod.mass[-1] + turning))
        self.step = min(STABLE * self.element / math.sqrt(finger.young / DENSITY), STABLE_SPRING / bouncing)
        self.simulator, self.stepper = self._assembled(), elastica.PositionVerlet()
        self.rest = Rest(self.rod.position_collection.copy(), self.rod.director_collection.copy())

    def _assembled(self) -> Simulator:
        simulator = Simulator()
        simulator.append(self.rod)
        fixed = {"constrained_position_idx": (0, 1), "constrained_director_idx": (0,)}
        simulator.constrain(self.rod).using(elastica.FixedConstraint, **fixed)
        simulator.add_forcing_to(self.rod).using(Tendon, loads=self.loads)
        simulator.add_forcing_to(self.rod).using(Plane, loads=self.loads)
        damping = {"uniform_damping_constant": DAMPING * self.frequency, "time_step": self.step}
        simulator.dampen(self.rod).using(elastica.AnalyticalLinearDamper, **damping)
        simulator.finalize()
        return simulator

    def solve(self, tension: float, distance: float | None) -> tuple[list[float] | None, float | None]:
        """Tip [m] and contact force [N]: pulled in free space until at rest, then the plane comes from touch."""
        self.rod.position_collection[:], self.rod.director_collection[:] = self.rest.position, self.rest.directors
        self.rod.velocity_collection[:], self.rod.omega_collection[:] = 0.0, 0.0
        self.loads.tension, self.loads.height = tension, math.inf
        if not self._settled():
            return None, None
        if distance is not None and self._reach() > self.finger.side / 2 + distance:
            steps = math.ceil(COMING / self.frequency / self.step)
            for height in np.linspace(self._reach(), self.finger.side / 2 + distance, steps):
                self.loads.height = height
                self._forward()
            if not self._settled():
                return None, None
        end, along = self.rod.position_collection[:, -2], self.rod.director_collection[2, :, -1]
        return tip(self.finger, end[0], end[1], math.atan2(along[1], along[0])), self.loads.force

    def _forward(self) -> None:
        self.stepper.step(self.simulator, 0.0, self.step)

    def _settled(self) -> bool:
        """Steps until it is at rest; False if it does not come to rest."""
        slow = REST * self.finger.length * self.frequency
        for _ in range(math.ceil(LONGEST / self.frequency / self.step / CHECK)):
            for _ in range(CHECK):
                self._forward()
            if np.abs(self.rod.velocity_collection).max() < slow:
                return True
        return False

    def _reach(self) -> float:
        half = self.finger.side / 2 * abs(self.rod.director_collection[0, 1, -1])
        return float(self.rod.position_collection[1, -1] + half)


def _rod(finger: Finger, elements: int) -> elastica.CosseratRod:
    """Straight, along x, its first director along y, with the stiffness of a square section."""
    rubber = Rubber(finger)
    length = rubber.length / elements
    clamp = CLAMP * length
    lengths = np.array([clamp, *[length] * elements, finger.plate])
    along = np.concatenate([[0.0], np.cumsum(lengths)]) - clamp
    radius = finger.side / math.sqrt(math.pi)  # the circle of the square's area, which PyElastica takes
    rod = elastica.CosseratRod.straight_rod(
        len(lengths),
        np.array([-clamp, 0.0, 0.0]),
        np.array([1.0, 0.0, 0.0]),
        np.array([0.0, 1.0, 0.0]),
        float(lengths.sum()),
        radius,
        DENSITY * length / lengths,  # the plate's nodes as heavy as the others, else they ask for shorter steps
        youngs_modulus=finger.young,
        shear_modulus=finger.shear,
        position=np.array([along, 0 * along, 0 * along]),
    )
    for k in range(2):
        rod.shear_matrix[k, k] = SHEAR_FACTOR * finger.shear * finger.side**2
        rod.bend_matrix[k, k] = rubber.bending
        # Only the half of a joint's length that is rubber bends there.
        rod.bend_matrix[k, k, 0] *= (length + clamp) / length
        rod.bend_matrix[k, k, -1] *= (length + finger.plate) / length
    return rod


def closed_form(finger: Finger, tension: float) -> list[float]:
    """Tip in free space [m] of PyElastica's rod with ever more elements: an arc.

    Its force is E A (e - 1)/e and its couple E I curvature/e^3, with stretch e, as its sections keep their volume.
    """
    rubber = Rubber(finger)
    stretch = 1 / (1 + tension / rubber.axial)
    angle = stretch**3 * tension * finger.offset / rubber.bending * rubber.length
    radius = stretch * rubber.length / angle
    return tip(finger, radius * math.sin(angle), radius * (1 - math.cos(angle)), angle)


def measure() -> Answers:
    """The rod's answers; its settings include the difference from the closed form."""
    asked = finger()
    rod = Rod(asked, ELEMENTS, PLANE)
    rod.solve(1.0, None)  # compiles
    found = answers(
        rod.solve,
        name="Cosserat rod, PyElastica",
        settings=(
            f"PyElastica {version('pyelastica')}, {ELEMENTS} elements, shear factor 5/6; a tendon of constant tension "
            f"through an eyelet in every element; the plane is a spring, {PLANE:g} times as stiff as the tip; damped"
        ),
        limits="stresses are linear in strain, and sections keep their volume, as if Poisson's ratio were 1/2",
    )
    pairs = zip(found.free_tips, (closed_form(asked, tension) for tension in FREE), strict=True)
    off = max(math.dist(one, true) / math.hypot(*true) for one, true in pairs if one)
    settings = f"{found.settings}; free tips differ from its closed form by {100 * off:.2g} % at most"
    return replace(found, settings=settings)
