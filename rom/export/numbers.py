"""A C struct and all it points to as C constants: no number of what Python's compiled code reads is written twice."""

import math
from dataclasses import dataclass, field
from typing import Any

from rom.export.wasm_memory import address, owners
from rom.native import LIBRARY

PER_LINE = 8  # numbers
ALIGNED = "__attribute__((aligned(64)))"  # as arrays of `rom.native.Library.struct` are [bytes]
SUFFIXES = {"uint64_t": "ULL", "int64_t": "LL", "float": "f"}


def definitions(struct: Any, prefix: str = "part_", aligned: bool = False) -> tuple[list[str], str]:
    """C definitions of a struct made by `rom.native.Library.struct` and of all it points to; and its name there.

    They are exact: doubles and floats are read back as what they are.

    Args:
        struct: what is defined.
        prefix: of all names, which numbers follow.
        aligned: whether arrays begin with a cache line, for gcc and clang alone.
    """
    parts = _Parts(owners=owners(struct), prefix=prefix, aligned=aligned)
    return parts.lines, parts.define(address(struct))


@dataclass(kw_only=True)
class _Parts:
    """Definitions as they are made: owners of memory, by address; names of what is defined, by that and by contents."""

    owners: dict[int, Any]
    prefix: str
    aligned: bool
    names: dict[int, str] = field(default_factory=dict)
    alike: dict[str, str] = field(default_factory=dict)
    lines: list[str] = field(default_factory=list)

    def define(self, at: int) -> str:
        """The name of what lies at an address here; what it points to is defined before it, and nothing twice."""
        if at not in self.names:
            owner = self.owners[at]
            kind = LIBRARY.ffi.typeof(owner)
            single, of = kind.kind == "pointer", kind.item
            values = [self._value(of, one) for one in ([owner[0]] if single else owner)] or ["0"]
            kind_name = f"{of.item.cname} *const" if of.kind == "pointer" else of.cname
            rows = ",\n".join(", ".join(values[k : k + PER_LINE]) for k in range(0, len(values), PER_LINE))
            contents = f"[{len(values)}] = {{\n{rows}}};\n"
            self.names[at] = self.alike.setdefault(f"{kind_name} {contents}", f"{self.prefix}{len(self.alike)}")
            if len(self.lines) < len(self.alike):
                aligned = f"{ALIGNED} " if self.aligned and of.kind == "primitive" else ""
                self.lines.append(f"{aligned}static const {kind_name} {self.names[at]}{contents}")
        return self.names[at]

    def _value(self, kind: Any, value: Any) -> str:
        """An initialiser."""
        if kind.kind == "struct":
            return "{" + ", ".join(self._value(of.type, getattr(value, name)) for name, of in kind.fields) + "}"
        if kind.kind == "array":
            return "{" + ", ".join(self._value(kind.item, one) for one in value) + "}"
        if kind.kind == "pointer":
            return "NULL" if value == LIBRARY.ffi.NULL else self.define(address(value))
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
