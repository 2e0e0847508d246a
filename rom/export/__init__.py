"""Models for those without Python: a C header, an FMU, a page in a browser."""
