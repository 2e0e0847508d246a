"""Contacts of rubber in a MuJoCo model: those of the rod's surface, with their compliance, in place of those of blocks.

The blocks between sections only find the objects that are near. Contacts are those of slices that bend, bulge and yield
(docs/theory/contact.md). Let h be the step and t the relaxation time of the rubber where it is pressed in, else 0. With
the gap g, its rate v, the compliance c and the normal force f, a step ends where

    g + (h + t) v + c f >= 0,    f >= 0,    one of them 0.

So MuJoCo's regularisation is c / (h (h + t)), and its reference acceleration -(g / (h + t) + v) / h. Along the
surface the rubber yields by c times the change of the tangential force. If p is that of the step before, Coulomb's law
has the slip rate v + c (f - p) / h: the regularisation is c / h^2, the reference acceleration -v / h + c p / h^2.
"""

from __future__ import annotations

import copy
from typing import Any, NamedTuple

import mujoco
import numpy as np
from scipy.spatial.transform import Rotation

from control.mujoco.contact.surface import Near, Surface, is_known
from control.mujoco.rubber import Rubber
from control.mujoco.sections import bodies_of
from rom.brief import brief

BURIED = 0.1  # depth in blocks, over half the side, beyond which a geom must have contacts with rubber [-]


@brief
class Pair(NamedTuple):
    """A finger and a geom in contact.

    Attributes:
        near: their contacts.
        chosen: indices of those that take part, shape (n,).
        rubber: of the finger.
        first: index of the first one among all contacts of mjData.
        sign: 1 where MuJoCo's normal points to the finger, else -1.
        axes: 1 without friction, else 3: the normal and two tangents.
    """

    near: Near
    chosen: np.ndarray
    rubber: Rubber
    first: int
    sign: int
    axes: int

    def addresses(self, data: mujoco.MjData) -> np.ndarray:
        """Rows of the normals among the constraints, shape (n,)."""
        return np.asarray(data.contact.efc_address[self.first : self.first + len(self.chosen)])


class RubberContacts:
    """Contacts of all fingers' rubber with geoms that are not of fingers.

    Args:
        model: compiled.
        data: its state.
        rubber: of every finger.

    Attributes:
        buried: whether a geom was in the rubber without contact since `reset`, as if it were deeper than it is large,
            shape (fingers,).
    """

    def __init__(self, model: mujoco.MjModel, data: mujoco.MjData, rubber: list[Rubber]):
        self._model, self._data, self._rubber = model, data, rubber
        self._surfaces = [Surface(model, data, one) for one in rubber]
        self._pairs, self.buried = list[Pair](), np.zeros(len(rubber), bool)
        self._finger_of = np.full(model.ngeom + 1, -1)  # of blocks of rubber; the last one for none, as of a flex
        self._object = np.append([is_known(model, geom) for geom in range(model.ngeom)], False)
        for k, one in enumerate(rubber):
            rod = one.attached.rod
            self._object[:-1][np.isin(model.geom_bodyid, one.bodies)] = False
            blocks = [body.blocks for body in bodies_of(rod)] if all(s.outlines for s in rod.segments) else []
            for body, own in zip(one.bodies, blocks, strict=False):
                first = model.body_geomadr[body]
                self._finger_of[[first + j for j, block in enumerate(own) if not block.is_plate]] = k

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickled and copied by its parameters and the contacts of the last step, without addresses."""
        return type(self), (self._model, self._data, self._rubber), [one.contacts for one in self._surfaces]

    def __setstate__(self, contacts: list[dict[int, bytes]]) -> None:
        for surface, own in zip(self._surfaces, contacts, strict=True):
            surface.contacts = own

    def reset(self) -> None:
        """Forget all contacts."""
        self._pairs, self.buried = [], np.zeros_like(self.buried)
        for one in self._surfaces:
            one.reset()

    def replace(self, tensions: np.ndarray) -> None:
        """Replace contacts of blocks, after mj_step1 and `Rubber.pull`, at tensions of shape (fingers, t) [N]."""
        model, data, templates = self._model, self._data, dict[tuple[int, int], Any]()
        deepest = dict[tuple[int, int], float]()  # by how far a geom is in the blocks [m]
        self._pairs, geoms = [], data.contact.geom.copy()
        fingers = self._finger_of[geoms]
        (met_by,) = ((fingers >= 0).any(axis=1) & self._object[geoms].any(axis=1)).nonzero()
        for k in met_by.tolist():
            side = int(fingers[k, 1] >= 0)
            met = int(fingers[k, side]), int(geoms[k, 1 - side])
            templates.setdefault(met, copy.copy(data.contact[k]))
            deepest[met] = max(deepest.get(met, 0.0), -data.contact[k].dist)
            data.contact[k].exclude, data.contact[k].efc_address = 1, -1
        for finger, surface in enumerate(self._surfaces):
            rubber = self._rubber[finger]
            near = surface.find([geom for one, geom in templates if one == finger], tensions[finger])
            pairs = [self._add(templates[finger, geom], one, rubber) for geom, one in near]
            self._pairs += [pair for pair in pairs if len(pair.chosen)]
            most = BURIED * float(rubber.attached.rod.half_lengths[1:].min())
            for (geom, _), pair in zip(near, pairs, strict=True):
                self.buried[finger] |= not len(pair.chosen) and deepest[finger, geom] > most
        if not templates:
            return
        mujoco.mj_makeConstraint(model, data)
        for pair in self._pairs:
            self._set_arms(pair)
        mujoco.mj_referenceConstraint(model, data)
        for pair in self._pairs:
            self._set_compliance(pair)

    def _add(self, contact: Any, near: Near, rubber: Rubber) -> Pair:
        """Add the contacts of a finger with a geom to mjData, each with the distal section of an element."""
        model, data, first = self._model, self._data, self._data.ncon
        clamp, is_near = rubber.bodies[0], near.gaps[: near.found.count] < contact.includemargin
        (chosen,), origin, axes = is_near.nonzero(), data.xpos[clamp], data.xmat[clamp].reshape(3, 3)
        near.forces[: near.found.count][~is_near] = 0.0
        own, contact.dim = int(self._finger_of[contact.geom[1]] >= 0), min(contact.dim, 3)
        sign = 2 * own - 1
        places = origin + near.places[chosen] @ axes.T
        frames = near.axes[chosen] @ axes.T * np.array([[sign], [1], [sign]])
        geoms = model.body_geomadr[rubber.bodies[1 + near.sections[chosen]]]
        for place, frame, gap, geom in zip(places, frames, near.gaps[chosen], geoms, strict=True):
            contact.geom[own] = geom
            contact.geom1, contact.geom2 = contact.geom
            contact.pos, contact.frame, contact.dist, contact.exclude = place, frame.ravel(), gap, 0
            mujoco.mj_addContact(model, data, contact)
        return Pair(near, chosen, rubber, first, sign, contact.dim)

    def _set_arms(self, pair: Pair) -> None:
        """Share forces between both sections of an element as the rod does: rows of the Jacobian by the distal one."""
        model, data, near, chosen = self._model, self._data, pair.near, pair.chosen
        sections = near.sections[chosen]
        positions, dofs = pair.rubber.positions[sections], pair.rubber.velocities[sections]
        turns = Rotation.from_quat(data.qpos[positions[:, None] + np.arange(3, 7)], scalar_first=True).as_matrix()
        joints = near.arms[chosen]  # slides move along the axes of the section before
        joints[:, :, :3] = np.einsum("kij,kaj->kai", turns, joints[:, :, :3])
        joints[:, 1] *= pair.sign
        rows = pair.addresses(data)[:, None] + np.arange(pair.axes)
        if mujoco.mj_isSparse(model):
            first, count = data.efc_J_rowadr[rows], data.efc_J_rownnz[rows[:, 0]]
            columns = [data.efc_J_colind[i : i + n] for i, n in zip(first[:, 0], count, strict=True)]
            begins = first + np.array([np.searchsorted(*both) for both in zip(columns, dofs, strict=True)])[:, None]
        else:
            begins = rows * model.nv + dofs[:, None]
        data.efc_J.reshape(-1)[begins[:, :, None] + np.arange(6)] = joints[:, : pair.axes]

    def _set_compliance(self, pair: Pair) -> None:
        """Regularisation and reference acceleration along normals and tangents."""
        data, step, rows = self._data, self._model.opt.timestep, pair.addresses(self._data)
        gaps, compliances = pair.near.gaps[pair.chosen], pair.near.compliances[pair.chosen]
        later = step + pair.rubber.attached.relaxation * (gaps < 0)
        data.efc_R[rows] = compliances / (step * later)
        data.efc_aref[rows] = -(gaps / later + data.efc_vel[rows]) / step
        if pair.axes > 1:
            friction = data.contact[pair.first].friction
            before = np.einsum("kai,ki->ka", pair.near.axes[pair.chosen], pair.near.forces[pair.chosen])
            before[:, 1] *= pair.sign
            for axis in (1, 2):
                # MuJoCo asks for the same regularisation times squared friction along both tangents
                along, share = rows + axis, (friction[0] / friction[axis - 1]) ** 2
                data.efc_R[along] = share * compliances / step**2
                data.efc_aref[along] = -data.efc_vel[along] / step + data.efc_R[along] * before[:, axis]
            for k, ratio in enumerate(np.sqrt(data.efc_R[rows + 1] / data.efc_R[rows]).tolist()):
                data.contact[pair.first + k].mu = friction[0] * ratio
        own = rows[:, None] + np.arange(pair.axes)
        data.efc_D[own] = 1 / data.efc_R[own]

    def note(self) -> None:
        """Note the forces of a step, about which contacts of the next one are linearised."""
        for pair in self._pairs:
            forces = np.zeros((len(pair.chosen), 3))
            forces[:, : pair.axes] = self._data.efc_force[pair.addresses(self._data)[:, None] + np.arange(pair.axes)]
            forces[:, 1] *= pair.sign
            pair.near.forces[pair.chosen] = np.einsum("ka,kai->ki", forces, pair.near.axes[pair.chosen])
