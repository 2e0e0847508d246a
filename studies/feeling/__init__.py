"""Contacts felt without a sensor: docs/accuracy.md."""
