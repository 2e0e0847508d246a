"""A C struct and all it points to as C constants: no number of what Python's compiled code reads is written twice."""

from __future__ import annotations

import math
from typing import Any

from rom.export.image import address, owners
from rom.native import SEGMENT

PER_LINE = 8  # numbers
SUFFIXES = {"uint64_t": "ULL", "int64_t": "LL", "float": "f"}


def definitions(struct: Any) -> tuple[list[str], str]:
    """C definitions of a struct made by `rom.native.Library.struct` and of all it points to; and its name there.

    They are exact: doubles and floats are read back as what they are.
    """
    known, names, lines = owners(struct), dict[int, str](), list[str]()
    return lines, _define(address(struct), known, names, lines)


def _define(at: int, known: dict[int, Any], names: dict[int, str], lines: list[str]) -> str:
    """The name of what lies at an address here; what it points to is defined before it."""
    if at not in names:
        owner = known[at]
        kind = SEGMENT.ffi.typeof(owner)
        single, of = kind.kind == "pointer", kind.item
        values = [_value(of, one, known, names, lines) for one in ([owner[0]] if single else owner)] or ["{0}"]
        names[at] = f"part_{len(names)}"
        declared = f"{of.item.cname} *const" if of.kind == "pointer" else of.cname
        rows = [", ".join(values[k : k + PER_LINE]) for k in range(0, len(values), PER_LINE)]
        lines.append(f"static const {declared} {names[at]}[{len(values)}] = {{\n" + ",\n".join(rows) + "};\n")
    return names[at]


def _value(kind: Any, value: Any, known: dict[int, Any], names: dict[int, str], lines: list[str]) -> str:
    """An initialiser."""
    if kind.kind == "struct":
        fields = (_value(of.type, getattr(value, name), known, names, lines) for name, of in kind.fields)
        return "{" + ", ".join(fields) + "}"
    if kind.kind == "array":
        return "{" + ", ".join(_value(kind.item, one, known, names, lines) for one in value) + "}"
    if kind.kind == "pointer":
        return "NULL" if value == SEGMENT.ffi.NULL else _define(address(value), known, names, lines)
    return literal(value, kind.cname)


def literal(value: float, kind: str) -> str:
    """A number of a kind of C."""
    if kind not in ("double", "float"):
        return f"{int(value)}{SUFFIXES.get(kind, '')}"
    if math.isnan(value):
        return "NAN"
    if math.isinf(value):
        return "INFINITY" if value > 0 else "-INFINITY"
    return f"{value!r}{SUFFIXES.get(kind, '')}"
