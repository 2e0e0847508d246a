"""A model as one C header: tip, contact force, touch distance and their derivatives, without allocation.

The same C that Python calls, with the model's numbers as constants: of a separated model here, of a finger in
rom.export.rod_header.
"""

import hashlib
import re
from pathlib import Path

from rom.export.numbers import definitions
from rom.export.rod_header import rod_header
from rom.files.atomic_file import write_whole
from rom.files.checked_file import ModelError
from rom.native import LIBRARY
from rom.rod.touched_segment import TouchedSegment
from rom.separated.model import SeparatedModel

NATIVE = Path(__file__).parent / "native"


def header(model: SeparatedModel | TouchedSegment, name: str = "finger") -> str:
    """The text of a header whose names begin with `name`.

    Raises:
        ModelError: the name is no C identifier.
    """
    if not re.fullmatch(r"[A-Za-z]\w*", name, re.ASCII):
        raise ModelError(f"name must be a C identifier (letters, digits and _, a letter first), got {name}")
    if isinstance(model, TouchedSegment):
        return rod_header(model, name)
    arrays, kernel = definitions(model.kernel, f"{name}_part_")
    parameters = [f"      {one.name} [{one.unit}] from {one.lower:g} to {one.upper:g}" for one in model.parameters]
    shared = "\n".join(_without_includes(LIBRARY.folder / "separated" / file) for file in ("kernel.h", "evaluation.c"))
    tables = model.kernel.tables
    axes, terms, components = tables.most_axes, tables.most_terms, tables.most_components
    texts = {
        "TITLE": re.sub(r"[^\w .,:()-]", " ", str(model.scene["name"])),
        "FINGERPRINT": str(model.provenance.get("fingerprint", "unknown")),
        "PARAMETERS": "\n".join(parameters),
        "COUNT": str(len(parameters)),
        "ROWS": str(6 if model.has_pad else 5),
        "STACK": str(8 * (3 * (1 + axes) * terms + components) // 1000 + 2),  # the memory below, and some
        "SIZES": f"{axes}, {terms}, {components}",
        "VERSION": f"0x{hashlib.sha256(shared.encode()).hexdigest()[:8]}",
        "GUARD": f"{name.upper()}_H",
        "SHARED": shared,
        "ARRAYS": "\n".join(arrays),
        "KERNEL": kernel,
    }
    text = (NATIVE / "exported.h.in").read_text(encoding="utf-8")
    return re.sub(r"@(\w+)@|@", lambda found: texts[found[1]] if found[1] else name, text)


def export(model: SeparatedModel | TouchedSegment, path: Path) -> None:
    """Write the header; its names begin with the file's name."""
    text = header(model, path.stem)
    write_whole(path, lambda stream: stream.write(text.encode()))


def _without_includes(file: Path) -> str:
    return re.sub(r"^#include.*\n", "", file.read_text(encoding="utf-8"), flags=re.MULTILINE)
