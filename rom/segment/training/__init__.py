"""Sets of pressed states -> the map of a segment: fits, what they miss in lines left out, and a finer mesh's say."""
