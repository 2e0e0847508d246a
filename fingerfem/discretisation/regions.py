"""Tags of the mesh's regions: numbers that cells and facets carry."""

import numpy as np

# Cells. A CHANNEL carries a tendon that slides through it, a HOLE holds the end of a straight one. RUBBER and its
# channel are those of the scene's material; the k-th of the other materials has these numbers plus k OF_MATERIAL.
RUBBER, RUBBER_CHANNEL = 1, 2
PLATE, PLATE_CHANNEL, PLATE_HOLE, TIP_PLATE, TIP_HOLE = 3, 4, 5, 6, 7
OF_MATERIAL = 32
TIP = (TIP_PLATE, TIP_HOLE)
PLATES = (PLATE, PLATE_CHANNEL, PLATE_HOLE, *TIP)
# Facets: the clamp, the cut z = 0 of half a finger, and the surface, by what it is made of and whether it is the pad.
# WALL is that of the pressure chambers.
CLAMP, CUT, RUBBER_SURFACE, PLATE_SURFACE, RUBBER_PAD, PLATE_PAD, WALL = 11, 12, 13, 14, 15, 16, 17
RUBBER_FACETS, PLATE_FACETS, PAD = (RUBBER_SURFACE, RUBBER_PAD), (PLATE_SURFACE, PLATE_PAD), (RUBBER_PAD, PLATE_PAD)
SURFACE = (*RUBBER_FACETS, *PLATE_FACETS)


def of_material(k: int) -> tuple[int, int]:
    """Cells of the k-th material, 0 the rubber: without tendons, and its channels."""
    return RUBBER + OF_MATERIAL * k, RUBBER_CHANNEL + OF_MATERIAL * k


def channels(materials: int) -> tuple[int, ...]:
    """Cells of channels in a finger of so many materials."""
    return (*(of_material(k)[1] for k in range(materials)), PLATE_CHANNEL)


def materials(cells: np.ndarray) -> np.ndarray:
    """Number of the material by the cells' regions: 0 the rubber, k the k-th of the others, -1 of plates."""
    return np.where(np.isin(cells, PLATES), -1, cells // OF_MATERIAL).astype(np.int32)
