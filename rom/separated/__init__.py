"""A fitted polynomial into the separated form of the paper."""
