"""The compiled segment and what touches it (segment.h), called with arrays of NumPy."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from rom.brief import brief
from rom.dataset.sections.section_outline import SectionOutline
from rom.elements.law import ElementMap
from rom.elements.polynomial import Polynomial
from rom.native import LIBRARY, pointer
from rom.rod import limits
from rom.rod.compiled.arrangement import (
    border,
    by_degree,
    free_numbers,
    in_sixes,
    law,
    outline,
    places_between,
    tension_monomials,
    variants,
)
from rom.rod.compiled.indentation import indentations
from rom.rod.compiled.outlines import Outline, knots_of, outline_of

CORNERS = LIBRARY.constants.FINGERFEM_CORNERS
ENDS = LIBRARY.constants.FINGERFEM_FRONTS  # sections of a segment's surface besides its places


__all__ = ["Outline", "outline_of"]  # and all that is defined here


@brief
@dataclass(frozen=True, kw_only=True)
class CondensedSegment:
    """A segment: a rod of elements, and the plate at its end.

    Attributes:
        elements: from the plate to the clamp, of every one the map of tensions and the wrench that its distal section
            carries, in that one's frame [N, N m]: place of its proximal section seen from there [m] and Rodrigues
            vector of that rotation [-], 6 values. Elements that share a law are one and the same object; all have one
            map of the tensions to what their polynomials are of.
        half_lengths: of the plate along its own axes, shape (3,) [m].
        section: outline of the plate's section at rest; None if that is the box of half_lengths.
        depths: sides of squares that bend as the plate's section does towards y and z, (12 I)^(1/4), shape (2,) [m];
            None if these are the sides of its box.
        begins: size of the section where the segment begins over that of the plate's [-].
        moduli: of every element's material over that of the rubber, shape (elements,) [-]; None if all are 1.
        young_modulus: of the rubber [Pa]; 0 where nothing is known of it.
        poisson: Poisson's ratio of the rubber [-].
        ridges: height of the ridge above each tendon, over its tension and the curvature, for faces across y and
            across z; negative for the faces at -y and -z, shape (t, 2) [1/Pa]; None without ridges.
        bulges: height to which the highest pressure lifts the face over its chamber, with signs likewise, 0 of tendons,
            shape (t, 2) [m]; None without chambers.
        corners: how far tensions bend the plate's corners, 24 values of the same [m]; None if it is not known.
        outlines: of every element, shared as its law is; None if nothing is known of the rubber's surface.
        shortenings: of every element, shared as its law is: how much shorter the segment's tendons are in it, in the
            order of its tensions [m], with the powers of its law; None if they are not known.
    """

    elements: Sequence[ElementMap]
    half_lengths: np.ndarray
    section: SectionOutline | None = None
    depths: np.ndarray | None = None
    begins: float = 1.0
    moduli: Sequence[float] | None = None
    young_modulus: float = 0.0
    poisson: float = 0.0
    ridges: np.ndarray | None = None
    bulges: np.ndarray | None = None
    corners: Polynomial | None = None
    outlines: Sequence[Outline] | None = None
    shortenings: Sequence[Polynomial] | None = None


def memory_of(compiled: Any) -> Any:
    """Memory for a function of a struct fingerfem_segment or fingerfem_chain to work in: a call's own."""
    chain = LIBRARY.ffi.typeof(compiled).item is LIBRARY.ffi.typeof("fingerfem_chain")
    size = LIBRARY.functions.fingerfem_chain_memory if chain else LIBRARY.functions.fingerfem_segment_memory
    return pointer(np.empty(size(compiled)))


def struct(segment: CondensedSegment) -> Any:
    """A segment as a struct fingerfem_segment.

    Raises:
        ModelError: a segment beyond what compiled code holds.
    """
    limits.check_rod(segment)
    plate, corners = segment.elements[0], segment.corners
    tension_map = plate.tension_map
    combinations, t = tension_map.shape
    corner_powers, corner_coefficients = np.zeros((0, combinations + 6), int), np.zeros((0, CORNERS))
    if corners is not None:
        order = sorted(range(len(corners.powers)), key=lambda k: by_degree(corners.powers[k].tolist()))
        corner_powers, corner_coefficients = corners.powers[order], corners.coefficients[order]
    laws = list({id(one): one for one in segment.elements}.values())
    law_of = [next(k for k, one in enumerate(laws) if one is element) for element in segment.elements]
    first = [law_of.index(k) for k in range(len(laws))]
    outlines = [] if segment.outlines is None else [segment.outlines[k] for k in first]
    powers = [corner_powers, *(one.polynomial.powers for one in laws), *(one.polynomial.powers for one in outlines)]
    deviations = [one.deviations for one in laws if one.deviations is not None]
    monomials = tension_monomials(combinations, powers + [one.powers for one in deviations])
    bent = free_numbers(monomials, corner_powers, corner_coefficients)
    structs = [LIBRARY.struct("fingerfem_law", **law(one.polynomial, monomials)) for one in laws]
    known: dict[str, Any] = {}  # of the rubber's surface, the tendons and errors
    if segment.outlines is not None:
        corners_of = [LIBRARY.struct("fingerfem_outline", **outline(one.polynomial, monomials)) for one in outlines]
        lengths = np.array([one.length for one in segment.outlines])
        knots = knots_of(segment.outlines, segment.half_lengths[0])
        known = places_between(knots, lengths)
        slices = known["places"] - 1
        pitch = np.ptp(knots) / slices
        half, section = segment.half_lengths[1:].mean() * (1 + segment.begins) / 2, segment.section
        rubber, filled = (segment.young_modulus, segment.poisson), None
        if section is not None and not section.is_rectangle:
            filled = section.area / float(np.prod(2 * section.box))
        known |= indentations(rubber, half, pitch, slices, filled)
        known["outline"] = LIBRARY.pointers("fingerfem_outline", corners_of)
    if segment.shortenings is not None:
        sixes = [six for k in first for six in in_sixes(segment.shortenings[k])]
        tendons = [LIBRARY.struct("fingerfem_law", **law(one, monomials)) for one in sixes]
        known |= {"sixes": len(sixes) // len(laws), "shortening": LIBRARY.pointers("fingerfem_law", tendons)}
    if deviations:
        structs_of = [LIBRARY.struct("fingerfem_variants", **variants(one, monomials)) for one in deviations]
        known |= {"variants": LIBRARY.pointers("fingerfem_variants", structs_of), "deviating": structs_of[0].count}
    return LIBRARY.struct(
        "fingerfem_segment",
        tensions=t,
        combinations=combinations,
        monomials=len(monomials),
        lower=np.append(plate.tensions[0], plate.polynomial.lower[combinations:]),
        upper=np.append(plate.tensions[1], plate.polynomial.upper[combinations:]),
        tension_map=tension_map,
        combined_lower=plate.polynomial.lower[:combinations],
        combined_upper=plate.polynomial.upper[:combinations],
        most_powers=monomials.max(axis=0),
        tension_powers=monomials,
        elements=len(segment.elements),
        laws=len(laws),
        law=LIBRARY.pointers("fingerfem_law", structs),
        law_of=law_of,
        element_moduli=np.ones(len(law_of)) if segment.moduli is None else np.array(segment.moduli, float),
        **known,
        half_lengths=segment.half_lengths.tolist(),
        **border(segment.section),
        depths=(2 * segment.half_lengths[1:] if segment.depths is None else segment.depths).tolist(),
        young_modulus=segment.young_modulus,
        poisson=segment.poisson,
        begins=segment.begins,
        ridges=np.zeros((t, 2)) if segment.ridges is None else segment.ridges,
        bulges=np.zeros((t, 2)) if segment.bulges is None else segment.bulges,
        corner_monomials=len(bent),
        corner_coefficients=bent,
    )


def place(compiled: Any, inputs: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray, bool]:
    """Centre, shape (3,), and rotation, shape (3, 3), of a segment's plate, seen from its clamp.

    Args:
        compiled: a struct fingerfem_segment.
        inputs: tensions and the plate's wrench, shape (t + 6,) [N, N m].

    Returns:
        both, the plate's motion by the inputs, shape (6, t + 6), and whether these are inside.
    """
    t, given = len(inputs) - 6, np.array(inputs, float)
    centre, rotation, motion = np.empty(3), np.empty((3, 3)), np.empty((6, len(inputs)))
    parts = given[:t].copy(), given[t:].copy()
    inside = LIBRARY.functions.fingerfem_place(
        compiled, *map(pointer, parts), memory_of(compiled), *map(pointer, (centre, rotation, motion))
    )
    return centre, rotation, motion, bool(inside)


def chain_struct(
    segments: Sequence[Any],
    own: np.ndarray,
    rest: np.ndarray,
    surface_error: float,
    errors: Mapping[str, float],
    weight: Mapping[str, np.ndarray] | None = None,
) -> Any:
    """Segments as a struct fingerfem_chain.

    Args:
        segments: structs, from clamp to tip.
        own: which of the t tensions are a segment's, shape (segments, t).
        rest: the tip plate's centre in the undeformed finger, shape (3,) [m].
        surface_error: of the rubber's surface [m].
        errors: what estimated errors are made of, by the names in segment.h.
        weight: acceleration, masses and lengths of rubber, by the names in segment.h; none if nothing weighs.
    """
    weighs = dict(weight or {})
    if weighs:
        weighs["gravity"] = weighs["gravity"].tolist()
    lower, upper = np.full(own.shape[1], -np.inf), np.full(own.shape[1], np.inf)
    for segment, which in zip(segments, own, strict=True):
        for k, j in enumerate(which[: segment.tensions]):
            lower[j], upper[j] = max(lower[j], segment.lower[k]), min(upper[j], segment.upper[k])
    return LIBRARY.struct(
        "fingerfem_chain",
        plates=len(segments),
        tensions=own.shape[1],
        segments=LIBRARY.pointers("fingerfem_segment", segments),
        own=own,
        lower=lower,
        upper=upper,
        rest=rest.tolist(),
        surface_error=surface_error,
        **errors,
        **weighs,
    )


def loads(compiled: Any, wrenches: np.ndarray) -> np.ndarray:
    """Loads of a struct fingerfem_chain, shape (m,): wrenches on its plates, then on the sections between elements.

    Args:
        compiled: the struct.
        wrenches: such loads, or on the plates alone, shape (n, 6) [N, N m].
    """
    values = np.zeros(LIBRARY.functions.fingerfem_chain_loads(compiled))
    values[: wrenches.size] = wrenches.ravel()
    return values


def place_chain(
    compiled: Any, tensions: np.ndarray, wrenches: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray, bool]:
    """Centres, rotations and motions of n plates, shapes (n, 3), (n, 3, 3), (n, 6, t + 6 n); whether all is inside."""
    n, t = compiled.plates, len(tensions)
    centres, rotations, motions = np.empty((n, 3)), np.empty((n, 3, 3)), np.empty((n, 6, t + 6 * n))
    inside = LIBRARY.functions.fingerfem_chain_place(
        compiled,
        *map(pointer, (tensions, loads(compiled, wrenches))),
        memory_of(compiled),
        *map(pointer, (centres, rotations, motions)),
    )
    return centres, rotations, motions, bool(inside)
