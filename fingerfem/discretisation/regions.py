"""Tags of the mesh's regions: numbers that cells and facets carry."""

# Cells. A CHANNEL carries a tendon that slides through it, a HOLE holds the end of a straight one.
RUBBER, RUBBER_CHANNEL = 1, 2
PLATE, PLATE_CHANNEL, PLATE_HOLE, TIP_PLATE, TIP_HOLE = 3, 4, 5, 6, 7
CHANNELS = (RUBBER_CHANNEL, PLATE_CHANNEL)
RUBBERS, TIP = (RUBBER, RUBBER_CHANNEL), (TIP_PLATE, TIP_HOLE)
PLATES = (PLATE, PLATE_CHANNEL, PLATE_HOLE, *TIP)
# Facets: the clamp, the cut z = 0 of half a finger, and the surface, by what it is made of and whether it is the pad.
# WALL is that of the pressure chambers.
CLAMP, CUT, RUBBER_SURFACE, PLATE_SURFACE, RUBBER_PAD, PLATE_PAD, WALL = 11, 12, 13, 14, 15, 16, 17
RUBBER_FACETS, PLATE_FACETS, PAD = (RUBBER_SURFACE, RUBBER_PAD), (PLATE_SURFACE, PLATE_PAD), (RUBBER_PAD, PLATE_PAD)
SURFACE = (*RUBBER_FACETS, *PLATE_FACETS)
