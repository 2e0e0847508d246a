"""Loads of the finger: actuators, weight, and wrenches on its plates."""
