"""Polynomials of a set's states: the free finger, contact regime by regime, the displacement."""
