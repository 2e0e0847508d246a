"""Cross-sections of a finger: outlines, nodes, poses."""
