"""The controllers: docs/speed.md."""
