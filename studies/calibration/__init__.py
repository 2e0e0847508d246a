"""A finger calibrated on logs of the full-order model."""
