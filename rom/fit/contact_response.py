"""The finger in contact: regime by regime, what contact adds to the free tip, the contact force, and where it ends."""

from __future__ import annotations

import logging
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from scipy.spatial import cKDTree

from rom.brief import brief
from rom.fit import layout, regime_fit
from rom.fit.contact_coordinates import ContactCoordinates
from rom.fit.free_response import FreeResponse
from rom.fit.regime_fit import FittedRegime
from rom.snapshots import contact_regimes
from rom.snapshots.body import Body
from rom.snapshots.contact_regimes import Code
from rom.snapshots.training_states import TrainingStates

logger = logging.getLogger(__name__)

MOST_REGIMES = 64  # as bits of a machine word; the states of those of the fewest states are then left out
NEIGHBOURS = 24  # states nearby whose regimes are possible
LOOKUP = 4000  # cells of the regime lookup, about


@brief
@dataclass(frozen=True, kw_only=True)
class ContactResponse:
    """The contact states of a set, by regime.

    Attributes:
        parameters: of all states in contact, shape (n, p).
        force: of contact [N], shape (n,).
        touch_distance: at their tensions [m], shape (n,).
        regime: of each, shape (n,).
        kept: which of the training set's states in contact these are.
        parts: of the regimes in which this set or a coarser one has states.
        box: lower and upper end of the parameters.
        coarse: the states on a coarser mesh, if there are any.
    """

    parameters: np.ndarray
    force: np.ndarray
    touch_distance: np.ndarray
    regime: np.ndarray
    kept: np.ndarray
    parts: list[FittedRegime]
    coordinates: ContactCoordinates
    box: tuple[np.ndarray, np.ndarray]
    coarse: ContactResponse | None = None

    @staticmethod
    def of(
        states: TrainingStates,
        free: FreeResponse,
        counts: Counter[Code],
        coarse: ContactResponse | None = None,
    ) -> ContactResponse:
        """Fit a set's contact states, or correct by them what a coarser mesh says.

        Args:
            states: of the set.
            free: the fit of its free states.
            counts: of states by regime, on all meshes: regimes are numbered in the order of these.
            coarse: the contact states on a coarser mesh.
        """
        listed = [code for code, _ in counts.most_common(MOST_REGIMES)]
        if len(counts) > MOST_REGIMES:
            left_out = counts.total() - sum(counts[code] for code in listed)
            logger.warning(
                "done without %d states: contact has %d regimes, and a surrogate holds %d",
                left_out, len(counts), MOST_REGIMES,
            )  # fmt: skip
        kept = np.array([code in listed for code in states.regimes], bool)
        table = {name: values[kept] for name, values in states.contact.items()}
        ends = states.lower, states.upper
        heights = free.polynomial.value(table["parameters"][:, :-1])[:, layout.HEIGHTS]
        regime = np.array([listed.index(code) for code in states.regimes if code in listed], int)
        body, half = states.body, states.body.is_half
        leading = _corners(listed, counts, half)
        signs = contact_regimes.signs(listed, counts)
        corners = [
            _height(free, contact_regimes.corner(code, half) or contact_regimes.nearest_corner(code, leading), body)
            for code in listed
        ]
        own_heights = np.take_along_axis(heights, np.array(corners)[regime][:, None], 1)
        coordinates = coarse.coordinates if coarse else ContactCoordinates.over(ends[0][-1], ends[1][-1], own_heights)
        before = {part.code: part for part in coarse.parts} if coarse else {}
        parts = []
        for r, (code, height) in enumerate(zip(listed, corners, strict=True)):
            rows, corner = np.flatnonzero(regime == r), contact_regimes.corner(code, half)
            if not rows.size and code not in before:
                continue
            own = {name: values[rows] for name, values in table.items()}
            domain = regime_fit.fit_domain(own, free, height, corner is not None, coordinates, before.get(code))
            parts.append(regime_fit.fitted(code, rows, own, free, height, domain, signs[r], body.half_lengths))
        return ContactResponse(
            parameters=table["parameters"],
            force=table["contact_force"],
            touch_distance=table["touch_distance"],
            regime=regime,
            kept=kept,
            parts=parts,
            coordinates=coordinates,
            box=ends,
            coarse=coarse,
        )

    def with_its_corners(self, free: FreeResponse) -> tuple[FreeResponse, ContactResponse]:
        """Both with only the heights that lead somewhere or are of a regime's corner."""
        wanted = np.union1d(np.flatnonzero(free.leads), [part.corner for part in self.parts]).astype(int)
        parts = [replace(part, corner=int(np.searchsorted(wanted, part.corner))) for part in self.parts]
        return free.of_heights(wanted), replace(self, parts=parts)

    @cached_property
    def around(self) -> np.ndarray:
        """States nearest to the middle of every cell, nearest first, shape (cells, states)."""
        return self._around(self.parameters, self.touch_distance)

    def _around(self, parameters: np.ndarray, reach: np.ndarray) -> np.ndarray:
        lower, upper = self.box
        p = len(lower)
        cells = max(int(LOOKUP ** (1 / p)), 2)
        scaled = (parameters - lower) / (upper - lower)
        scaled[:, -1] = (reach - parameters[:, -1]) / (reach - self.coordinates.nearest + self.coordinates.soft)
        middles = (np.stack(np.meshgrid(*[np.arange(cells)] * p, indexing="ij"), axis=-1).reshape(-1, p) + 0.5) / cells
        found = cKDTree(scaled).query(middles, k=min(NEIGHBOURS, len(scaled)))[1]
        return np.asarray(found.reshape(len(middles), -1))

    def regime_lookup(self) -> tuple[np.ndarray, np.ndarray]:
        """Regimes by cell, shapes (cells,): that of the state nearest to its middle; and bits of those near by."""
        regime, around = self.regime, self.around
        if self.coarse:
            both = (self, self.coarse)
            regime = np.concatenate([one.regime for one in both])
            around = self._around(
                np.concatenate([one.parameters for one in both]), np.concatenate([one.touch_distance for one in both])
            )
        bits = np.uint64(1) << regime.astype(np.uint64)
        return regime[around[:, 0]], np.bitwise_or.reduce(bits[around], axis=1)


def count_regimes(sets: Sequence[TrainingStates]) -> Counter[Code]:
    """Number of contact states by regime."""
    return Counter(code for states in sets for code in states.regimes)


def _corners(listed: list[Code], counts: Counter[Code], half: bool) -> Counter:
    """The corners that carry alone somewhere, or lead, with the number of their states."""
    found: Counter = Counter()
    for code in listed:
        corner = contact_regimes.corner(code, half)
        if corner is not None:
            found[corner] += counts[code]
    return found


def _height(free: FreeResponse, corner: tuple[int, Code], body: Body) -> int:
    """Which of the heights is that of a corner."""
    segment, ends = corner
    side = 2 * body.half_lengths[1]
    x = body.plates[segment, 1 if ends[0] > 0 else 0]
    away = np.abs(free.corners - [x, ends[1] * side / 2, (ends[2] or 1) * side / 2]).max(axis=1)
    return int(away.argmin())
