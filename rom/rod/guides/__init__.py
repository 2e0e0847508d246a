"""Tendons that rub in their guides."""
