"""Findings about a log: outliers, effects that no parameter explains, parameters that it does not determine."""
