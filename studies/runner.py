"""The one runner of all studies: measures part by part, then writes each study's section of a page of docs/.

python3 -m studies.runner [NAME ...] [--out OUT]      writes OUT (out/docs by default) and docs/
python3 -m studies.runner --part NAME/PART                      measures one part, with this Python

`declared.py` names the parts of a study. Its folder has `page.md.j2`, the section, and perhaps `page.py`, which draws
pictures and prepares tables.
"""

from __future__ import annotations

import argparse
from pathlib import Path

from studies.declared import STUDIES
from studies.parts import ROOT, Unmeasured, complete, measure, parts
from studies.sections import write_page

OUT = ROOT / "out" / "docs"


def main() -> None:
    """Measure, write the pages."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("studies", nargs="*", choices=[*STUDIES, []], help="all by default")
    parser.add_argument("--out", type=Path, default=OUT)
    every = [name for study in STUDIES for name in parts(study)]
    one = "measure this one alone, in this process"
    parser.add_argument("--part", action="append", metavar="NAME/PART", choices=every, help=one)
    options = parser.parse_args()
    out = options.out.resolve()
    for name in options.part or ():
        measure(name, out)
    for study in () if options.part else options.studies or STUDIES:
        complete(study, out)
        try:
            write_page(study, out)
        except Unmeasured as missing:
            print(missing, flush=True)


if __name__ == "__main__":
    main()
