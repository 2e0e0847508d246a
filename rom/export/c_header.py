"""A model as one C99 header: tip, contact force, touch distance and their derivatives, without allocation.

The same C that Python calls (rom/native), with the model's numbers as constants.
"""

from __future__ import annotations

import hashlib
import re
from pathlib import Path
from typing import Any

import numpy as np

from rom.checked_file import ModelError
from rom.native import EVALUATION, HERE, KINDS
from rom.surrogate import Surrogate
from rom.whole_file import write_whole

PER_LINE = 4  # numbers


def header(model: Surrogate, name: str = "finger") -> str:
    """The text of a header whose names begin with `name`.

    Raises:
        ModelError: the name is no C identifier.
    """
    if not re.fullmatch(r"[A-Za-z]\w*", name):
        raise ModelError(f"name must be a C identifier, got {name}")
    arrays: list[str] = []
    numbers = model.kernel_numbers()
    kernel = _initialiser("fingerfem_kernel", numbers, name, arrays)
    parameters = [
        f"      {one['name']} [{one['unit']}] from {one['lower']:g} to {one['upper']:g}" for one in model.parameters
    ]
    shared = "\n".join(_without_includes(HERE / file) for file in ("kernel.h", "evaluation.c"))
    axes, terms, components = (int(numbers["tables"][f"most_{of}"]) for of in ("axes", "terms", "components"))
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
    text = (HERE / "exported.h.in").read_text(encoding="utf-8")
    return re.sub(r"@(\w+)@|@", lambda found: texts[found[1]] if found[1] else name, text)


def export(model: Surrogate, path: Path) -> None:
    """Write the header; its names begin with the file's name."""
    text = header(model, path.stem)
    write_whole(path, lambda stream: stream.write(text.encode()))


def _without_includes(file: Path) -> str:
    return re.sub(r"^#include.*\n", "", file.read_text(encoding="utf-8"), flags=re.MULTILINE)


def _initialiser(kind: str, values: dict[str, Any], name: str, arrays: list[str]) -> str:
    """The values of a struct in braces; arrays they point to are added to `arrays`."""
    found = []
    for field, of in EVALUATION.ffi.typeof(kind).fields:
        value = values[field]
        if of.type.kind == "struct":
            found.append(_initialiser(of.type.cname, value, name, arrays))
        elif of.type.kind == "pointer":
            cname = of.type.item.cname
            flat = [_literal(number, cname) for number in np.ravel(np.asarray(value, KINDS[cname]))] or ["0"]
            lines = [", ".join(flat[k : k + PER_LINE]) for k in range(0, len(flat), PER_LINE)]
            arrays.append(f"static const {cname} {name}_{field}[{len(flat)}] = {{\n" + ",\n".join(lines) + "};")
            found.append(f"{name}_{field}")
        else:
            found.append(_literal(value, of.type.cname))
    return "{" + ", ".join(found) + "}"


def _literal(number: Any, cname: str) -> str:
    return repr(float(number)) if cname == "double" else f"{int(number)}{'ULL' if cname == 'uint64_t' else ''}"
