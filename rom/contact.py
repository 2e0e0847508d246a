"""The finger in contact: regime by regime, what contact adds to the free tip, the contact force, and where it ends."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from scipy.spatial import cKDTree

from rom import chart, regimes
from rom.enrichment import EnrichmentOptions
from rom.free import Free, box
from rom.parts import Regime
from rom.polynomials import Fitted, Polynomial, Samples, fit
from rom.regimes import Code
from rom.separation import separated
from rom.snapshots import SnapshotSet

MOST = 64  # regimes; those of the fewest states beyond are left out
NEIGHBOURS = 24  # states nearby whose regimes are possible
MAP = 4000  # cells of the map of regimes, about
SHORT = 0.1  # share of the longest way past a corner that is short
SMALL = 0.02  # share of a regime's largest force below which errors count as of that force
QUANTITIES = ("tip", "contact_force", *regimes.QUANTITIES)


@dataclass(frozen=True, kw_only=True)
class Place:
    """Where the states of a regime lie in its coordinates.

    Attributes:
        parameters: shape (n, p).
        height: of the regime's corner in free space at their tensions [m], shape (n,).
        rising: its derivatives by the tensions, shape (n, p - 1).
        begins: whether the regime begins at touch.
        way: of the coordinates.
        blank: the samples without values.
    """

    parameters: np.ndarray
    height: np.ndarray
    rising: np.ndarray
    begins: bool
    way: chart.Way
    blank: Samples

    @property
    def past(self) -> np.ndarray:
        """By which quantities that grow from touch on are divided: the way past the corner [m], or 1; shape (n,)."""
        return self.height - self.parameters[:, -1] if self.begins else np.ones(len(self.height))

    def fit(self, values: np.ndarray, slopes: np.ndarray, grows: bool = True, field: bool = False) -> Fitted:
        """Fit quantities, shape (n, m), with derivatives by the parameters, shape (n, m, p).

        Those that grow from touch on are fitted by their ways past the corner where the regime begins at touch. For
        those of a field, which count alike, ways so small that they magnify what its basis leaves out count little.
        """
        samples = self.blank
        if self.begins and grows:
            past = self.past
            growing = np.column_stack([self.rising, np.full(len(past), -1.0)])
            values = values / past[:, None]
            slopes = (slopes - values[..., None] * growing[:, None]) / past[:, None, None]
            if field:
                samples = replace(samples, weights=past / (past + SHORT * past.max()))
        aligned = self.way.slopes(self.parameters, self.height, self.rising, slopes)
        return fit(replace(samples, values=values, slopes=aligned), alike=field)


@dataclass(frozen=True, kw_only=True)
class Part:
    """The contact states of one regime.

    Attributes:
        code: of the regime.
        rows: of its states among all contact states.
        corner: which height of the free states is that of its corner.
        place: where they lie.
        outputs: tip added and contact force.
        signs: conditions, and the fit of their values.
    """

    code: Code
    rows: np.ndarray
    corner: int
    place: Place
    outputs: Fitted
    signs: list[regimes.Sign]
    conditions: Fitted | None

    @property
    def points(self) -> np.ndarray:
        """Contact-aligned coordinates of the states, shape (n, p)."""
        return self.place.blank.points

    def separated(self, options: EnrichmentOptions) -> Regime:
        """The regime as the surrogate has it."""
        both = [self.outputs.polynomial] + ([self.conditions.polynomial] if self.conditions else [])
        values = self.conditions.polynomial.value(self.points) if self.conditions else np.zeros((1, 0))
        return Regime(
            code=self.code,
            corner=self.corner,
            begins=self.place.begins,
            states=len(self.rows),
            sizes=np.maximum(np.abs(values).max(axis=0), np.finfo(float).tiny).tolist(),
            form=separated(f"regime {self.code}", Polynomial.together(both), self.points, options),
        )


@dataclass(frozen=True, kw_only=True)
class Contact:
    """The contact states of a set, by regime.

    Attributes:
        parameters: of all states in contact, shape (n, p).
        force: of contact [N], shape (n,).
        touch_distance: at their tensions [m], shape (n,).
        regime: of each, shape (n,).
        touching: which of the set's contact states these are.
        box: lower and upper end of the parameters.
    """

    parameters: np.ndarray
    force: np.ndarray
    touch_distance: np.ndarray
    regime: np.ndarray
    touching: np.ndarray
    parts: list[Part]
    way: chart.Way
    box: tuple[np.ndarray, np.ndarray]

    @staticmethod
    def of(snapshots: SnapshotSet, free: Free) -> Contact:
        """Fit a set's contact states."""
        names = ["parameters", "touch_distance", "regime", *QUANTITIES, *(f"{name}_jacobian" for name in QUANTITIES)]
        states = {name: snapshots.states_of("contact", name) for name in names}
        touching = states["contact_force"] > 0
        states = {name: values[touching] for name, values in states.items()}
        codes = [tuple(int(sign) for sign in code) for code in states["regime"]]
        counts = Counter(codes)
        listed = [code for code, _ in counts.most_common(MOST)]
        kept = np.array([code in listed for code in codes])
        states, codes = {name: values[kept] for name, values in states.items()}, [c for c in codes if c in listed]
        touching[touching] = kept
        ends = box(snapshots)
        heights = free.polynomial.value(states["parameters"][:, :-1])[:, 3:]
        regime = np.array([listed.index(code) for code in codes])
        geometry, half = snapshots.description.scene["geometry"], bool(snapshots.nodes[:, 2].min() > -1e-9)
        sizes = np.array([geometry["plate"], geometry["side"], geometry["side"]]) / 2
        leading = _corners(listed, counts, half)
        signs = regimes.signs(listed, counts)
        corners = [
            _height(snapshots, free, regimes.corner(code, half) or regimes.nearest_corner(code, leading), geometry)
            for code in listed
        ]
        way = chart.Way.over(
            ends[0][-1], ends[1][-1], np.take_along_axis(heights, np.array(corners)[regime][:, None], 1)
        )
        parts = []
        for r, (code, height) in enumerate(zip(listed, corners, strict=True)):
            rows, corner = np.flatnonzero(regime == r), regimes.corner(code, half)
            own = {name: values[rows] for name, values in states.items()}
            parts.append(_part(code, rows, own, free, height, corner is not None, way, signs[r], sizes))
        return Contact(
            parameters=states["parameters"],
            force=states["contact_force"],
            touch_distance=states["touch_distance"],
            regime=regime,
            touching=touching,
            parts=parts,
            way=way,
            box=ends,
        )

    def with_its_corners(self, free: Free) -> tuple[Free, Contact]:
        """Both with only the heights that lead somewhere or are of a regime's corner."""
        wanted = np.union1d(np.flatnonzero(free.leads), [part.corner for part in self.parts]).astype(int)
        parts = [replace(part, corner=int(np.searchsorted(wanted, part.corner))) for part in self.parts]
        return free.of_heights(wanted), replace(self, parts=parts)

    @cached_property
    def around(self) -> np.ndarray:
        """States nearest to the middle of every cell, see rom.kernel.cell, nearest first; shape (cells, states)."""
        lower, upper = self.box
        p = len(lower)
        cells = max(int(MAP ** (1 / p)), 2)
        scaled = (self.parameters - lower) / (upper - lower)
        reach = self.touch_distance
        scaled[:, -1] = (reach - self.parameters[:, -1]) / (reach - self.way.nearest + self.way.soft)
        middles = (np.stack(np.meshgrid(*[np.arange(cells)] * p, indexing="ij"), axis=-1).reshape(-1, p) + 0.5) / cells
        found = cKDTree(scaled).query(middles, k=min(NEIGHBOURS, len(scaled)))[1]
        return np.asarray(found.reshape(len(middles), -1))

    def map(self) -> tuple[np.ndarray, np.ndarray]:
        """Regimes by cell, flat: that of the state nearest to its middle; and bits of those nearby."""
        bits = np.uint64(1) << self.regime.astype(np.uint64)
        return self.regime[self.around[:, 0]], np.bitwise_or.reduce(bits[self.around], axis=1)


def _corners(listed: list[Code], counts: Counter[Code], half: bool) -> Counter:
    """The corners that carry alone somewhere, or lead, with the number of their states."""
    found: Counter = Counter()
    for code in listed:
        corner = regimes.corner(code, half)
        if corner is not None:
            found[corner] += counts[code]
    return found


def _part(
    code: Code,
    rows: np.ndarray,
    states: dict[str, np.ndarray],
    free: Free,
    height: int,
    begins: bool,
    way: chart.Way,
    signs: list[regimes.Sign],
    sizes: np.ndarray,
) -> Part:
    parameters, force = states["parameters"], states["contact_force"]
    known, rising = free.polynomial.value_and_gradient(parameters[:, :-1])
    rising = np.concatenate([rising, np.zeros((*rising.shape[:2], 1))], axis=-1)
    points = way.coordinates(parameters, known[:, 3 + height])
    lower, upper = points.min(axis=0), points.max(axis=0)
    blank = Samples(
        points=points,
        values=np.zeros((len(rows), 0)),
        slopes=None,
        weights=np.ones(len(rows)) if begins else SMALL / (force / force.max() + SMALL),
        lower=lower,
        upper=lower + np.maximum(upper - lower, 1e-6 * np.maximum(np.abs(upper), 1e-3)),
    )
    place = Place(
        parameters=parameters,
        height=known[:, 3 + height],
        rising=rising[:, 3 + height, :-1],
        begins=begins,
        way=way,
        blank=blank,
    )
    values = np.column_stack([states["tip"] - known[:, :3], force])
    slopes = np.concatenate([states["tip_jacobian"] - rising[:, :3], states["contact_force_jacobian"][:, None]], axis=1)
    conditions = None
    if signs:
        pairs = [regimes.sign_values(sign, states, sizes) for sign in signs]
        conditions = place.fit(
            np.column_stack([pair[0] for pair in pairs]), np.stack([pair[1] for pair in pairs], axis=1), grows=False
        )
    return Part(
        code=code,
        rows=rows,
        corner=height,
        place=place,
        outputs=place.fit(values, slopes),
        signs=signs,
        conditions=conditions,
    )


def _height(snapshots: SnapshotSet, free: Free, corner: tuple[int, Code], geometry: dict) -> int:
    """Which of the heights is that of a corner."""
    segment, ends = corner
    x = np.cumsum(geometry["segments"])[segment] - (0.0 if ends[0] > 0 else geometry["plate"])
    place = [x, ends[1] * geometry["side"] / 2, (ends[2] or 1) * geometry["side"] / 2]
    away = np.abs(snapshots.nodes[free.edges] - place).max(axis=1)
    return int(away.argmin())
