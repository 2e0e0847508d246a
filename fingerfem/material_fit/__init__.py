"""Fits laws of the rubber to measured tests: reads tests, fits and compares laws, writes a scene's `[material]`."""
