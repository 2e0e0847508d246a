"""Steps of a MuJoCo model with fingers: implicit forces of their rubber, and contact forces.

With the inverse of its law an element is a spring of six directions between neighbouring sections: force f(q),
stiffness K, damping D = relaxation K, in the coordinates of the joints between them. A step of MuJoCo's with the
inertia M + h D + h^2 K and the force f - (D + h K) v is the linearly implicit Euler step (Deuflhard, Hairer, Zugck,
Numer. Math. 51, 1987). Contacts and friction are solved with the same inertia, which includes the stiffness.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import mujoco
import numpy as np
from numpy.typing import ArrayLike

from control.motion import for_each
from control.mujoco.attach import FAST, Attached
from control.mujoco.contact.coulomb import solve
from control.mujoco.contact.engine import Engine
from control.mujoco.contact.rubber_contacts import RubberContacts
from control.mujoco.contact.sticking import Sticking
from control.mujoco.rubber import Rubber, weigh

INTEGRATORS = {  # which MuJoCo offers alone
    int(mujoco.mjtIntegrator.mjINT_EULER): mujoco.mj_Euler,
    int(mujoco.mjtIntegrator.mjINT_IMPLICITFAST): mujoco.mj_implicit,
}
# Smallest impratio: stiffness of sticking friction over that of contacts [-]. By its inverse yields what sticks.
STICKING = 1000.0
# Least evaluations along a line and largest tolerance of MuJoCo's solver; acceleration that may be left [m/s^2].
SEARCHED, PRECISE, SETTLED = 500, 1e-12, 1e-2


class SimulationStopped(FloatingPointError):
    """A simulation that cannot go on; the message has the reason.

    Attributes:
        time: of the simulation [s].
        finger: name of the finger that left its domain; None if the motion diverged.
        distance: of a section from its last position within the trained domain [m]; nan without a finger.
    """

    def __init__(self, reason: str, time: float, finger: str | None = None, distance: float = np.nan):
        super().__init__(reason)
        self.time, self.finger, self.distance = time, finger, distance

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (str(self), self.time, self.finger, self.distance)


class Simulation:
    """A compiled model with fingers, and its state.

    Attributes:
        model, data: MuJoCo's; the user sets other controls than those of fingers.
        wanted: target loads of every finger's actuators, shape (fingers, loads) [N, Pa], see `pull`.
        tensions: current loads, which approach the targets at `rate`, shape (fingers, loads) [N, Pa].
        fingers: as attached.
        left: whether a finger left its trained domain of tensions and wrenches since `reset`, shape (fingers,).
        lost: likewise, whether an element's law did not reach its pose, about which its force is then linear; or an
            object entered the rubber without contact. The finger's contact forces are not valid.
        unsettled: number of steps since `reset` without convergence to Coulomb's law (control.mujoco.contact.coulomb),
            or of MuJoCo's solver.

    Args:
        model: compiled after all fingers were attached. It gets elliptic cones, an impratio of at least 1000, a
            solver that converges, and no islands, automatic reset, multiccd and midphase.
        fingers: returned by `attach`, all with the same number of tensions.
        rate: largest rate of a tension [N/s]; with chambers one for each load [N/s, Pa/s].
        coulomb: whether fingers slide by Coulomb's law; else by MuJoCo's own relaxation, which takes less time.

    Raises:
        ValueError: no fingers, fingers of different kinds, or one twice; a part of a finger is missing in the model; a
            solver or an integrator that is not supported.
    """

    def __init__(
        self, model: mujoco.MjModel, fingers: Sequence[Attached], rate: ArrayLike = 500.0, coulomb: bool = True
    ):
        if not fingers or len({len(one.rod.names) for one in fingers}) > 1:
            raise ValueError("fingers must be at least one, all with the same number of tensions")
        if len({one.clamp for one in fingers}) < len(fingers):
            raise ValueError(f"fingers must differ in their names, got {', '.join(one.name for one in fingers)}")
        if model.opt.integrator not in INTEGRATORS:
            raise ValueError("integrator must be Euler or implicitfast: others have several stages in a step")
        if model.opt.solver == mujoco.mjtSolver.mjSOL_PGS or model.opt.noslip_iterations:
            raise ValueError("solver must be Newton or CG, without noslip: others keep the inertia without the rubber")
        self.rate = for_each("rate", rate, fingers[0].rod.parameters)
        self.model, self.fingers, self._coulomb = model, list(fingers), coulomb
        # Coulomb's law needs a circular friction cone, and little yields, see control.mujoco.contact.coulomb.
        model.opt.cone, model.opt.impratio = mujoco.mjtCone.mjCONE_ELLIPTIC, max(model.opt.impratio, STICKING)
        model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_ISLAND  # islands have copies of the inertia
        model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_AUTORESET  # failures must stay visible
        # Several points of one contact may have wrong depths: a cylinder then stays 1 mm inside a plate (MuJoCo 4.0).
        model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_MULTICCD
        # MuJoCo bounds planes by boxes of 1e10 m, whose round-off loses contacts of micrometres: a corner then bounces.
        model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_MIDPHASE
        # Stiff friction needs up to 60 evaluations along a line. MuJoCo's 50 left forces of 15 N in place of 5 N.
        model.opt.ls_iterations = max(model.opt.ls_iterations, SEARCHED)
        model.opt.tolerance = min(model.opt.tolerance, PRECISE)
        self.data = mujoco.MjData(model)
        self.wanted = np.zeros((len(fingers), len(fingers[0].rod.names)))
        self.tensions = np.zeros_like(self.wanted)
        self.rubber = [Rubber(model, self.data, one) for one in fingers]
        self._finger_of = np.full(model.ngeom + 1, -1)  # by geom; the last one for none, as of a flex
        for k, one in enumerate(self.rubber):
            self._finger_of[:-1][np.isin(model.geom_bodyid, one.bodies)] = k
        self._own, self._residual = self._finger_of[:-1] >= 0, np.zeros(model.nv)
        self._engine = Engine(model, self.data)
        self._contacts = RubberContacts(self._engine, self.rubber)
        self._sticking = Sticking(self._engine, self._own)
        model.geom_solref[self._own, 0] = FAST * model.opt.timestep
        weigh(model, self.data, self.rubber, self.tensions.shape[1])
        self.reset()

    @property
    def time(self) -> float:
        """Simulated time [s]."""
        return float(self.data.time)

    def reset(self, keyframe: str | None = None) -> None:
        """Reset fingers to rest without tensions, and the rest of the model to its initial state or a keyframe.

        Raises:
            ValueError: no such keyframe.
        """
        key = -1 if keyframe is None else mujoco.mj_name2id(self.model, mujoco.mjtObj.mjOBJ_KEY, keyframe)
        if keyframe is not None and key < 0:
            names = [self.model.key(k).name for k in range(self.model.nkey)]
            raise ValueError(f"keyframe must be one of {names}, got {keyframe!r}")
        mujoco.mj_resetDataKeyframe(self.model, self.data, key)  # -1: none
        self.wanted[:], self.tensions[:] = 0.0, 0.0
        self.left = np.zeros(len(self.fingers), bool)
        self.lost = np.zeros(len(self.fingers), bool)
        self.unsettled = 0
        self._contacts.reset()
        self._sticking.reset()
        for one in self.rubber:
            one.reset()
        mujoco.mj_forward(self.model, self.data)

    def step(self) -> None:
        """Advance the model by one step.

        Raises:
            SimulationStopped: a finger is its own length beyond its trained domain, or the motion diverges.
        """
        model, data, h = self.model, self.data, self.model.opt.timestep
        self.tensions += np.clip(self.wanted - self.tensions, -self.rate * h, self.rate * h)
        mujoco.mj_step1(model, data)
        for k, rubber in enumerate(self.rubber):
            if not rubber.pull(self.tensions[k], h):
                self.left[k], self.lost[k] = True, self.lost[k] or not rubber.inside[:, 1].all()
                self._check(self.fingers[k], rubber.away)
        found = data.ncon
        self._contacts.replace()
        self.lost |= self._contacts.buried
        self._sticking.recall(found)  # those of rubber, which follow, stick by themselves
        # mj_step2, but for the inertia of a step and Coulomb's law
        mujoco.mj_factorM(model, data)
        mujoco.mj_fwdActuation(model, data)
        mujoco.mj_fwdAcceleration(model, data)
        is_solved = True
        if self._coulomb:
            is_solved = solve(self._engine, self._own)
        else:
            mujoco.mj_fwdConstraint(model, data)
        mujoco.mj_mulM(model, data, self._residual, data.qacc)
        self._residual -= data.qfrc_smooth + data.qfrc_constraint
        left = np.linalg.norm(self._residual) / (model.stat.meaninertia * model.nv)
        self.unsettled += not (is_solved and left <= SETTLED)
        self._contacts.note()
        self._sticking.note()
        mujoco.mj_sensorAcc(model, data)
        mujoco.mj_checkAcc(model, data)
        INTEGRATORS[model.opt.integrator](model, data)
        if data.warning[mujoco.mjtWarning.mjWARN_BADQACC].number or not np.isfinite(data.qpos).all():
            raise SimulationStopped(
                f"motion must be finite, got a divergence after {data.time:g} s: use a shorter step", data.time
            )

    def _check(self, finger: Attached, away: float) -> None:
        """Stop where a section is a finger's length from its last position within the trained domain."""
        length = sum(finger.rod.scene["geometry"]["segments"])
        if away > length:
            raise SimulationStopped(
                f"{finger.name!r} must stay within {length:g} m of its trained domain, got {away:g} m after "
                f"{self.time:g} s: reduce the load or the acceleration of its base, or train larger loads",
                *(self.time, finger.name, away),
            )

    def advance(self, time: float) -> None:
        """Step until a time [s].

        Raises:
            SimulationStopped: see `step`.
        """
        half = 0.5 * self.model.opt.timestep
        while self.data.time < time - half:
            self.step()

    def contact_forces(self) -> np.ndarray:
        """Sums of normal contact forces on every finger, shape (fingers,) [N].

        A contact of two fingers counts for both, one of two sections of a finger once. `Attached.sensors` are MuJoCo's
        sensors of every section.
        """
        found, contact = np.zeros(len(self.fingers) + 1), self.data.contact  # the last one of none
        is_loaded = contact.efc_address >= 0
        first, second = self._finger_of[contact.geom[is_loaded]].T
        normal = self.data.efc_force[contact.efc_address[is_loaded]]  # of an elliptic cone
        np.add.at(found, first, normal)
        np.add.at(found, second, np.where(second == first, 0.0, normal))
        return found[:-1]

    def finger_of(self, geom: int) -> int:
        """Index of the finger that a geom, given by its index, belongs to; -1 if none."""
        return int(self._finger_of[geom])

    def wrenches(self) -> list[np.ndarray]:
        """Wrenches of the elements on every finger's sections, in their frames, shape (sections, 6) each [N, N m]."""
        return [one.wrenches.copy() for one in self.rubber]

    def pull(self, finger: int, tensions: ArrayLike) -> None:
        """Set a finger's target tensions [N] and pressures [Pa], shape (loads,), which it approaches at `rate`.

        Raises:
            ValueError: another number of loads, or loads that are not finite or outside the trained domain.
        """
        wanted, parameters = np.asarray(tensions, float), self.fingers[finger].rod.parameters
        lower, upper = (np.array([getattr(one, end) for one in parameters]) for end in ("lower", "upper"))
        if wanted.shape != lower.shape or not np.all((wanted >= lower) & (wanted <= upper)):
            units = ", ".join(dict.fromkeys(one.unit for one in parameters))
            ends = f"{lower.tolist()} to {upper.tolist()} {units}"
            raise ValueError(f"tensions must be from {ends}, got {wanted.tolist()}")
        self.wanted[finger] = wanted
