"""A finger in MuJoCo that is brought to rest: pulled by a motor on a tendon, then met by a plane.

The model of it names a geom "plane" and a site "tip" in the middle of the plate; its only motors pull tendons. MuJoCo
simulates motion; what is asked is where it ends. So velocities are set to zero whenever the kinetic energy has passed a
maximum (kinetic damping), which leaves equilibrium as it is, whatever the masses are.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import mujoco
import numpy as np

from studies.peers.question import Finger
from studies.peers.rods.asking import UNREACHED

AFAR = 1.0  # where the plane is in free space [m]
HARD = 0.9999  # MuJoCo's largest impedance of a contact: the stiffest it has
UNSTABLE = (mujoco.mjtWarning.mjWARN_BADQPOS, mujoco.mjtWarning.mjWARN_BADQVEL, mujoco.mjtWarning.mjWARN_BADQACC)


@dataclass(frozen=True, kw_only=True)
class Pace:
    """How a finger is brought to rest.

    Attributes:
        step: of time [s].
        ramp: steps in which the tension grows, and in which the plane comes.
        moved: what the tip may still move from one maximum of kinetic energy to the next, twice in a row [m].
        longest: steps after which a state is given up.
    """

    step: float
    ramp: int
    moved: float
    longest: int


class Resting:
    """A finger's model with its state.

    Attributes:
        depth: how deep the plate was in the plane in the last state [m].
        steps: taken for the last state.
    """

    def __init__(self, xml: str, finger: Finger, pace: Pace) -> None:
        mujoco.set_mju_user_warning(lambda words: None)  # they are counted in data.warning; as it is, a file gets them
        self.model = mujoco.MjModel.from_xml_string(xml)
        self.data = mujoco.MjData(self.model)
        self.finger, self.pace, self.depth, self.steps = finger, pace, 0.0, 0
        self._plane, self._tip = self.model.geom("plane").id, self.model.site("tip").id

    def solve(self, tension: float, distance: float | None) -> tuple[list[float] | None, float | None]:
        """Tip [m] and contact force [N]: pulled in free space until at rest, then the plane comes from touch."""
        mujoco.mj_resetData(self.model, self.data)
        self.steps = 0
        self.model.geom_pos[self._plane, 1] = AFAR
        for share in np.arange(1, self.pace.ramp + 1) / self.pace.ramp:
            self.data.ctrl[:] = -tension * share
            self._forward()
        if not self._settled():
            return UNREACHED
        height = math.inf if distance is None else self.finger.side / 2 + distance
        if self._reach() > height:
            for between in np.linspace(self._reach(), height, self.pace.ramp + 1)[1:]:
                self.model.geom_pos[self._plane, 1] = between
                self._forward()
            if not self._settled():
                return UNREACHED
        x, y, z = self.data.site_xpos[self._tip]
        return [x - (self.finger.length - self.finger.plate / 2), float(y), float(z)], self._contact_force()

    def _forward(self) -> None:
        mujoco.mj_step(self.model, self.data)
        self.steps += 1

    def _settled(self) -> bool:
        """Steps until it is at rest; False if it does not come to rest."""
        energy, quiet, before = 0.0, 0, np.full(3, np.inf)
        for _ in range(self.pace.longest):
            self._forward()
            if any(self.data.warning[kind].number for kind in UNSTABLE):
                return False
            mujoco.mj_energyVel(self.model, self.data)
            energy, last = self.data.energy[1], energy
            if energy >= last:
                continue
            self.data.qvel[:], energy = 0.0, 0.0
            mujoco.mj_kinematics(self.model, self.data)
            now = self.data.site_xpos[self._tip].copy()
            quiet = quiet + 1 if np.linalg.norm(now - before) < self.pace.moved else 0
            before = now
            if quiet == 2:
                return True
        return False

    def _reach(self) -> float:
        """How far the plate is towards the plane [m]."""
        turned = np.abs(self.data.site_xmat[self._tip].reshape(3, 3)[1])
        half = np.array([self.finger.plate, self.finger.side, self.finger.side]) / 2
        return float(self.data.site_xpos[self._tip][1] + turned @ half)

    def _contact_force(self) -> float:
        """Sum of the normal forces [N]."""
        found, total = np.zeros(6), 0.0
        for contact in range(self.data.ncon):
            mujoco.mj_contactForce(self.model, self.data, contact, found)
            total += float(found[0])
        self.depth = -min((contact.dist for contact in self.data.contact), default=0.0)
        return total


def plane(pace: Pace, impedance: float) -> str:
    """Of the XML: the frictionless plane, its contact as stiff as the time step lets it be."""
    return (
        f'<geom name="plane" type="plane" pos="0 {AFAR} 0" zaxis="0 -1 0" size="1 1 0.1" condim="1" priority="1" '
        f'solref="{2 * pace.step} 1" solimp="{impedance} {impedance} 0.001"/>'
    )


def options(pace: Pace) -> str:
    """Of the XML: no weight, and the integrator that takes elasticity implicitly."""
    return f'<option timestep="{pace.step}" integrator="discrete" gravity="0 0 0"/>'


def pulled(eyelets: list[str], share: float = 1.0) -> tuple[str, str]:
    """Of the XML: a tendon through sites of these names, and the motor that pulls it by its share of the tension."""
    name = f"through_{eyelets[0]}"
    through = "".join(f'<site site="{eyelet}"/>' for eyelet in eyelets)
    return f'<spatial name="{name}">{through}</spatial>', f'<motor tendon="{name}" gear="{share}"/>'
