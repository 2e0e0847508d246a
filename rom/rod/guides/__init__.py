"""Friction of tendons in their guides."""
