"""A finger as a Functional Mock-up Unit (FMI 2.0 or 3.0, co-simulation): C sources and a library, no Python."""

from rom.export.fmu.archive import write

__all__ = ["write"]
