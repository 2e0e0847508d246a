"""Models for those without Python: a C header, a page in a browser."""
