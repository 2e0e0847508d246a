"""Steps of a MuJoCo model with fingers: what their rubber pulls at the plates, implicitly, and what they feel.

With a map's inverse the rubber is a spring of six directions between a plate and what holds it: force f(q), stiffness
K, damping D = relaxation K. A step of MuJoCo's with the inertia M + h D + h^2 K and the force f - (D + h K) v is the
linearly implicit Euler step (Deuflhard, Hairer, Zugck, Numer. Math. 51, 1987). Contacts and friction are solved with
that inertia, too, so that a plate is as stiff before them as it is.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import mujoco
import numpy as np
from numpy.typing import ArrayLike

from control.mujoco.attach import FAST, Attached
from control.mujoco.coulomb import correct
from control.mujoco.rubber import Rubber
from rom.segment.inverse_map import InverseMap

LOOKING = 0.005  # [s], from look to look at the rubber, at least
STICKING = 100.0  # times stiffer than contacts are that which sticks is, at least [-]


@dataclass
class Held:
    """Where a plate was last that its map knew, (7,); its wrench, force and stiffness there, (6,), (6,) and (6, 6)."""

    position: np.ndarray
    wrench: np.ndarray
    force: np.ndarray
    stiffness: np.ndarray


@dataclass(frozen=True)
class Spring:
    """One segment's rubber in a compiled model.

    Attributes:
        inverse: of its map.
        finger, pulled: whose it is, and which of that one's tensions are its own.
        body: of its plate.
        position: where its seven coordinates begin.
        velocity: where its six velocities begin.
        inertia: places of the lower triangle of its block of MuJoCo's inertia, row by row, shape (21,).
        offset: of its plate's centre from what holds it, undeformed, shape (3,) [m], seen from the clamp.
        relaxation: [s].
        held: where it was last that the map knew.
        rubber: what of it may touch something.
    """

    inverse: InverseMap
    finger: int
    pulled: list[int]
    body: int
    position: int
    velocity: int
    inertia: np.ndarray
    offset: np.ndarray
    relaxation: float
    held: Held
    rubber: Rubber


class Simulation:
    """A compiled model with fingers, and its state.

    Attributes:
        model, data: MuJoCo's; controls of anything but the fingers are the user's.
        wanted: tensions that every finger's motors are told, shape (fingers, tensions) [N], see `pull`.
        tensions: that they pull now, which follow at `rate`.
        fingers: as attached.
        left: whether a finger left what its map was trained for since `reset`, shape (fingers,): tensions or wrench
            beyond.
        lost: likewise, whether it was where its map has no pose. Its force is then linear about where it was last
            known; nothing that it touches is to be believed.
        rubbed: likewise, whether its rubber may have touched something, by a look every 5 ms of `advance`: the map
            knows of plates that touch alone.
        unsettled: steps since `reset` in which Coulomb's law was not found, see control.mujoco.coulomb.

    Args:
        model: compiled after all fingers were attached. Its contacts are solved with elliptic cones, an impratio of at
            least 100 and without islands, and nothing resets it by itself.
        fingers: as `attach` returned them, all with the same number of tensions.
        rate: most that a motor changes its tension [N/s].
        coulomb: whether plates slide by Coulomb's law; else by MuJoCo's own relaxation of it, which takes less time.

    Raises:
        ValueError: no fingers, or of different kinds; a solver or an integrator that a step cannot be made with.
    """

    def __init__(self, model: mujoco.MjModel, fingers: Sequence[Attached], rate: float = 500.0, coulomb: bool = True):
        if not fingers or len({len(one.chain.tensions) for one in fingers}) > 1:
            raise ValueError("fingers must be at least one, all with the same number of tensions")
        if model.opt.integrator not in (mujoco.mjtIntegrator.mjINT_EULER, mujoco.mjtIntegrator.mjINT_IMPLICITFAST):
            raise ValueError("integrator must be Euler or implicitfast: others take several stages in a step")
        if model.opt.solver == mujoco.mjtSolver.mjSOL_PGS or model.opt.noslip_iterations:
            raise ValueError("solver must be Newton or CG, without noslip: others keep the inertia without the rubber")
        if not 0 < rate < np.inf:
            raise ValueError(f"rate must be above 0 N/s, got {rate}")
        self.model, self.fingers, self.rate, self._coulomb = model, list(fingers), rate, coulomb
        # Friction is round, and what sticks creeps little: both are for Coulomb's law, see control.mujoco.coulomb.
        model.opt.cone, model.opt.impratio = mujoco.mjtCone.mjCONE_ELLIPTIC, max(model.opt.impratio, STICKING)
        model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_ISLAND  # islands have copies of the inertia
        model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_AUTORESET  # what fails is to be seen
        self.data = mujoco.MjData(model)
        self.wanted = np.zeros((len(fingers), len(fingers[0].chain.tensions)))
        self.tensions = np.zeros_like(self.wanted)
        self.springs = [spring for k, one in enumerate(fingers) for spring in self._springs_of(k, one)]
        self._finger_of = np.full(model.ngeom + 1, -1)  # by geom; the last one for none, as of a flex
        for spring in self.springs:
            first = model.body_geomadr[spring.body]
            self._finger_of[first : first + model.body_geomnum[spring.body]] = spring.finger
        plates = self._finger_of[:-1] >= 0
        model.geom_solref[plates, 0] = FAST * model.opt.timestep
        self.reset()

    def _springs_of(self, finger: int, attached: Attached) -> list[Spring]:
        model, chain = self.model, attached.chain
        found: list[Spring] = []
        own = np.isin(model.geom_bodyid, [model.body(plate).id for plate in attached.plates])
        for segment, plate, joints in zip(chain.segments, attached.plates, attached.joints, strict=True):
            joint = model.joint(joints[0]).id
            body, first = model.body(plate).id, int(model.jnt_dofadr[joint])
            rows = [first + i for i in range(6)]
            last = model.M_rowadr[rows] + model.M_rownnz[rows] - 1  # the diagonal's place ends a row
            inertia = np.array([last[i] - (i - j) for i in range(6) for j in range(i + 1)])
            if not np.array_equal(model.M_colind[inertia], [first + j for i in range(6) for j in range(i + 1)]):
                raise ValueError(f"MuJoCo must keep the inertia of {plate!r} as one block")
            names = segment.names[: segment.tensions]
            found.append(
                Spring(
                    inverse=InverseMap(segment),
                    finger=finger,
                    pulled=[chain.tensions.index(name) for name in names],
                    body=body,
                    position=int(model.jnt_qposadr[joint]),
                    velocity=first,
                    inertia=inertia,
                    offset=segment.rest,
                    relaxation=attached.relaxation,
                    rubber=Rubber(model, segment, plate, own, first=not found),
                    held=Held(np.zeros(7), np.zeros(6), np.zeros(6), np.zeros((6, 6))),
                )
            )
        return found

    @property
    def time(self) -> float:
        """[s]."""
        return float(self.data.time)

    def reset(self) -> None:
        """Fingers at rest without tensions; everything else as the model says."""
        mujoco.mj_resetData(self.model, self.data)
        self.wanted[:], self.tensions[:] = 0.0, 0.0
        self.left = np.zeros(len(self.fingers), bool)
        self.lost = np.zeros(len(self.fingers), bool)
        self.rubbed = np.zeros(len(self.fingers), bool)
        self._looked, self.unsettled = -np.inf, 0
        for spring in self.springs:
            spring.inverse.forget()
            spring.held.wrench[:] = 0.0
            spring.held.position[:] = self.data.qpos[spring.position : spring.position + 7]
        mujoco.mj_forward(self.model, self.data)

    def step(self) -> None:
        """One step of the model.

        Raises:
            FloatingPointError: the model's motion has no bounds any more.
        """
        model, data, h = self.model, self.data, self.model.opt.timestep
        self.tensions += np.clip(self.wanted - self.tensions, -self.rate * h, self.rate * h)
        mujoco.mj_step1(model, data)
        for spring in self.springs:
            force, stiffness = self._pull(spring)
            first, later = spring.velocity, (spring.relaxation + h) * stiffness
            data.qfrc_applied[first : first + 6] = -force - later @ data.qvel[first : first + 6]
            data.M[spring.inertia] += h * later[_LOWER]
        mujoco.mj_factorM(model, data)
        if self._coulomb:
            self.unsettled += not correct(
                model, data, np.flatnonzero((self._finger_of[data.contact.geom] >= 0).any(axis=1))
            )
        mujoco.mj_step2(model, data)
        if data.warning[mujoco.mjtWarning.mjWARN_BADQACC].number or not np.isfinite(data.qpos).all():
            raise FloatingPointError(
                f"the motion has no bounds any more after {data.time:g} s: a shorter step may help"
            )

    def _pull(self, spring: Spring) -> tuple[np.ndarray, np.ndarray]:
        """Force and stiffness of a spring, see `InverseMap.spring`."""
        inverse, at, held = spring.inverse, spring.position, spring.held
        place = self.data.qpos[at : at + 7]
        inverse.find(self.tensions[spring.finger, spring.pulled], spring.offset + place[:3], place[3:])
        self.left[spring.finger] |= not inverse.inside
        if inverse.converged:
            held.position[:], held.wrench[:] = place, inverse.wrench
            held.force, held.stiffness = inverse.spring()
            return held.force, held.stiffness
        self.lost[spring.finger] = True
        inverse.wrench[:] = held.wrench  # from there it tries again
        turn, back, relative = np.zeros(3), np.zeros(4), np.zeros(4)
        mujoco.mju_negQuat(back, held.position[3:])
        mujoco.mju_mulQuat(relative, back, place[3:])
        mujoco.mju_quat2Vel(turn, relative, 1.0)
        moved = np.concatenate([place[:3] - held.position[:3], turn])
        return held.force + held.stiffness @ moved, held.stiffness

    def advance(self, time: float) -> None:
        """Step until a time [s]."""
        half = 0.5 * self.model.opt.timestep
        while self.data.time < time - half:
            self.step()
            if self.data.time > self._looked + LOOKING - half:
                self._looked = self.data.time
                self.rubbed |= self.rubber_gaps() < [one.chain.skin_error for one in self.fingers]

    def rubber_gaps(self) -> np.ndarray:
        """Least distance of every finger's rubber from what is no finger's rubber, shape (fingers,) [m].

        Infinite beyond 3 mm. The finger's own plates are left out.
        """
        found = np.full(len(self.fingers), np.inf)
        for spring in self.springs:
            inputs = np.concatenate([self.tensions[spring.finger, spring.pulled], spring.inverse.wrench])
            gap = spring.rubber.gap(self.model, self.data, inputs)
            found[spring.finger] = min(found[spring.finger], gap)
        return found

    def contact_forces(self) -> np.ndarray:
        """What presses on every finger's plates, normal to where it touches, shape (fingers,) [N].

        Where two fingers touch, both feel it; where two plates of one do, it counts once.
        """
        found, force = np.zeros(len(self.fingers)), np.zeros(6)
        for k, pair in enumerate(self.data.contact.geom):
            fingers = self._finger_of[pair]
            if fingers.max() < 0:
                continue
            mujoco.mj_contactForce(self.model, self.data, k, force)
            for finger in set(fingers[fingers >= 0].tolist()):
                found[finger] += force[0]
        return found

    def wrenches(self) -> list[np.ndarray]:
        """That hold every finger's plates where they are, shape (plates, 6) each, in their frames [N, N m]."""
        return [
            np.array([spring.inverse.wrench for spring in self.springs if spring.finger == k])
            for k in range(len(self.fingers))
        ]

    def pull(self, finger: int, tensions: ArrayLike) -> None:
        """Tell a finger's motors to pull its tendons, shape (tensions,) [N]; at once, but no faster than `rate`.

        Raises:
            ValueError: not one for each, not finite, or beyond what its map was trained for.
        """
        wanted, known = np.asarray(tensions, float), self.fingers[finger].chain.tension_parameters
        lower, upper = (np.array([one[end] for one in known]) for end in ("lower", "upper"))
        if wanted.shape != lower.shape or not np.all((wanted >= lower) & (wanted <= upper)):
            raise ValueError(f"tensions must be from {lower.tolist()} to {upper.tolist()} N, got {wanted.tolist()}")
        self.wanted[finger] = wanted


_LOWER = np.tril_indices(6)
