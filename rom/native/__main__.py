"""python3 -m rom.native LIBRARY...: builds libraries beside their sources, for wheels and images.

A library is named by its module and name there, such as rom.native:LIBRARY. Every level of the processor gets one.
"""

import sys
from importlib import import_module

from rom.native import Library, NoCompiler, levels


def main(names: list[str]) -> None:
    """Build what is named."""
    for name in names:
        module, _, attribute = name.partition(":")
        library: Library = getattr(import_module(module), attribute)
        for level in levels():
            print(library.build(library.folder, level))


if __name__ == "__main__":
    try:
        main(sys.argv[1:])
    except NoCompiler as error:
        raise SystemExit(str(error)) from None
