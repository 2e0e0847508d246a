"""Rigid contacts that stick without creep: MuJoCo's friction about the forces of the step before.

MuJoCo regularises friction. With the regularisation R and the reference acceleration -b v, a contact with the force f
along the surface slides at R f / b, as long as it is loaded; it turns under a torsional moment, too. Let p be the force
of the step before. With R p - b v it slides at R (f - p) / b: it yields by a fixed distance, as on rubber
(control.mujoco.contact.rubber_contacts).
"""

from __future__ import annotations

import mujoco
import numpy as np

from rom.brief import brief

FRICTIONLESS = 1e-5  # MuJoCo's least coefficient of friction, mjMINMU [-, m]
DIRECTIONS = np.arange(6)  # of a contact: its normal, two tangents, torsion, two of rolling


@brief
class Sticking:
    """Friction of rigid contacts in the last step.

    Args:
        data: state of the model.
    """

    def __init__(self, data: mujoco.MjData):
        self._data = data
        self.reset()

    def reset(self) -> None:
        """Forget all contacts."""
        self._chosen, self._rows = np.zeros(0, int), np.zeros((0, 6), int)  # -1: a contact has no such friction
        self._geoms, self._places = np.zeros((0, 2), int), np.zeros((0, 3))
        self._forces = np.zeros((0, 2, 3))  # along the surface and moments, along the world's axes [N, N m]

    def recall(self, contacts: np.ndarray) -> None:
        """Begin a step about the last forces of contacts, given by index: each about that of its geoms' nearest one."""
        data, all_ = self._data, self._data.contact
        dimensions, addresses = all_.dim[contacts], all_.efc_address[contacts]
        own = (dimensions > 1) & (addresses >= 0)
        has = (DIRECTIONS > 0) & (dimensions[own, None] > DIRECTIONS)
        has[:, 1:] &= all_.friction[contacts][own] > FRICTIONLESS
        self._chosen, self._rows = contacts[own], np.where(has, addresses[own, None] + DIRECTIONS, -1)
        geoms, places = all_.geom[self._chosen], all_.pos[self._chosen]
        if len(geoms) and len(self._geoms):
            distances = ((places[:, None] - self._places) ** 2).sum(axis=2)
            distances[(geoms[:, None] != self._geoms).any(axis=2)] = np.inf
            before = self._forces[distances.argmin(axis=1)]
            before[np.isinf(distances.min(axis=1))] = 0.0
            along = np.einsum("kai,kbi->kba", self._axes(), before).reshape(-1, 6)
            data.efc_aref[self._rows[has]] += data.efc_R[self._rows[has]] * along[has]
        self._geoms, self._places = geoms, places

    def note(self) -> None:
        """Note the forces of a step."""
        own = np.where(self._rows >= 0, self._data.efc_force[self._rows], 0.0).reshape(-1, 2, 3)
        self._forces = np.einsum("kba,kai->kbi", own, self._axes())

    def _axes(self) -> np.ndarray:
        """Normals and tangents of the contacts, shape (n, 3, 3)."""
        return np.asarray(self._data.contact.frame[self._chosen]).reshape(-1, 3, 3)
