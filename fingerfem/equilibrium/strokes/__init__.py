"""Strokes of actuators: lengths of channels, volumes of chambers."""
