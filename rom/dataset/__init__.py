"""The snapshot set: the one owner of its format, its folder and its plan."""
