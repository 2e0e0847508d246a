"""C structs as they lie in memory of WebAssembly, whose addresses have 32 bits and are not known here.

The page's compiled code reads the same structs as Python's: no number is written twice.
"""

from __future__ import annotations

import struct
from dataclasses import dataclass, field
from typing import Any

from rom.brief import brief
from rom.native import LIBRARY, kept_by

POINTER, ALIGNED = 4, 8  # [bytes]
PACKED = {"double": "d", "float": "f", "int32_t": "i", "int64_t": "q", "uint8_t": "B", "uint64_t": "Q"}


@brief
@dataclass
class Image:
    """Memory that begins with a struct; addresses in it count from its own begin.

    Attributes:
        memory: its bytes, little-endian.
        addresses: where in it addresses stand: whoever loads it elsewhere adds where. An address of 0 is none.
    """

    memory: bytearray = field(default_factory=lambda: bytearray(ALIGNED))  # no struct lies at address 0
    addresses: list[int] = field(default_factory=list)

    @classmethod
    def of(cls, root: Any) -> tuple[Image, int]:
        """A struct made by `rom.native.Library.struct`, and all it points to; and where it lies."""
        image, places = cls(), dict[int, int]()
        return image, image._placed(address(root), owners(root), places)

    def _placed(self, at: int, owners: dict[int, Any], places: dict[int, int]) -> int:
        """Address in the image of an object at an address of this process; places it there the first time."""
        if at not in places:
            owner = owners[at]
            kind = LIBRARY.ffi.typeof(owner)
            single = kind.kind == "pointer"
            size, _ = _layout(kind.item)
            self.memory.extend(bytes(-len(self.memory) % ALIGNED))
            begin = places[at] = len(self.memory)
            self.memory.extend(bytes(size * (1 if single else len(owner))))
            if kind.item.kind == "primitive":
                code = PACKED[kind.item.cname]
                self.memory[begin:] = struct.pack(f"<{len(owner)}{code}", *owner)
            else:
                for k, one in enumerate([owner[0]] if single else owner):
                    self._write(begin + size * k, kind.item, one, owners, places)
        return places[at]

    def _write(self, at: int, kind: Any, value: Any, owners: dict[int, Any], places: dict[int, int]) -> None:
        """A value of a kind, at a place."""
        if kind.kind == "struct":
            for name, offset, of in _fields(kind):
                self._write(at + offset, of, getattr(value, name), owners, places)
        elif kind.kind == "array":
            size, _ = _layout(kind.item)
            for k, one in enumerate(value):
                self._write(at + size * k, kind.item, one, owners, places)
        elif kind.kind == "pointer":
            if value != LIBRARY.ffi.NULL:
                self.addresses.append(at)
                struct.pack_into("<I", self.memory, at, self._placed(address(value), owners, places))
        else:
            struct.pack_into(f"<{PACKED[kind.cname]}", self.memory, at, value)


def owners(root: Any) -> dict[int, Any]:
    """A struct, and all that it keeps alive, by their addresses here."""
    structs = {address(root): root}
    for kept in kept_by(root):
        structs |= owners(kept)
    return structs


def address(pointer: Any) -> int:
    """Address that a pointer of this process holds."""
    return int(LIBRARY.ffi.cast("uintptr_t", pointer))


def _fields(kind: Any) -> list[tuple[str, int, Any]]:
    """Name, place and kind of a struct's fields there."""
    fields, offset = [], 0
    for name, one in kind.fields:
        size, aligned = _layout(one.type)
        offset += -offset % aligned
        fields.append((name, offset, one.type))
        offset += size
    return fields


def _layout(kind: Any) -> tuple[int, int]:
    """Size and alignment of a kind there."""
    if kind.kind == "pointer":
        return POINTER, POINTER
    if kind.kind == "array":
        size, aligned = _layout(kind.item)
        return size * kind.length, aligned
    if kind.kind == "struct":
        fields = _fields(kind)
        aligned = max(_layout(of)[1] for _, _, of in fields)
        _, offset, of = fields[-1]
        size = offset + _layout(of)[0]
        return size + -size % aligned, aligned
    size = struct.calcsize(f"<{PACKED[kind.cname]}")
    return size, size
