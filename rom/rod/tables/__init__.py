"""A rod in tables for people."""
