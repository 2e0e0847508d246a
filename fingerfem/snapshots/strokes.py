"""The strokes of a finger's actuators: the displacements that their loads do work on.

A tension does work on the shortening of its tendon [m], a pressure on the growth of its chamber [m^3].
"""

import numpy as np

from fingerfem.discretisation.node_order import NodeOrder
from fingerfem.model import FingerModel
from rom.dataset.sections.cross_sections import CrossSections


class Strokes:
    """Strokes between the clamp and every cross-section, of a model whose tendons all run in channels.

    Args:
        model: the model; every rank of it takes part.
        sections: its cross-sections.
        numbering: of the nodes that these are of.
    """

    def __init__(self, model: FingerModel, sections: CrossSections, numbering: NodeOrder):
        self._model = model
        at_rest = sections.quantities(np.zeros_like(numbering.nodes), np.zeros((0, *numbering.nodes.shape)))
        self._rest = at_rest["section_place"], at_rest["section_place_jacobian"]

    def quantities(self, changes: np.ndarray, sections: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
        """Strokes of the model's present state, and their derivatives, as `rom.dataset.schema` names them.

        Args:
            changes: of the displacement by p parameters, this rank's owned values, shape (p, owned values) [m].
            sections: what the cross-sections report of the state; none but on the model's first rank.
        """
        quantities = self._model.channel_lengths.quantities(changes)
        if not self._model.scene.chambers:
            return quantities
        walls = self._model.section_volumes
        integrals = walls.integrals(changes)
        if not sections:
            return quantities
        volumes, by = integrals.volumes(sections["section_place"], sections["section_place_jacobian"])
        grown = volumes - walls.at_rest.volumes(*self._rest)[0]
        return {
            "section_shortening": np.concatenate([quantities["section_shortening"], grown], axis=1),
            "section_shortening_jacobian": np.concatenate([quantities["section_shortening_jacobian"], by], axis=1),
        }
