"""The controllers: docs/control.md."""
