"""Fingers that close around an object, locate it and hold forces that neither drop nor crush it."""
