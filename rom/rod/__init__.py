"""Fingers as rods of elements, short pieces whose laws are trained once."""
