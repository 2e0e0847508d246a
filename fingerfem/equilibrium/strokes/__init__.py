"""What actuators do work on: lengths of channels, volumes of chambers."""
