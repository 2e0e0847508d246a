"""C files as one text in which every name is its own: what some functions need of them, and nothing else.

A file's own names (static functions, constants, types and macros) get its name before them. All functions are static.
SQLite calls such a text an amalgamation.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

from rom.brief import brief
from rom.export.c_text import Declaration, declarations, renamed
from rom.files.checked_file import ModelError

INCLUDE = re.compile(r'^[ \t]*#[ \t]*include[ \t]+(?:"([^"]+)"|<[^>]+>).*\n', re.MULTILINE)
GUARD = re.compile(r"^#ifndef (\w+_H)\n#define \1\n(.*)^#endif\s*\Z", re.MULTILINE | re.DOTALL)


@brief
@dataclass(frozen=True, kw_only=True)
class File:
    """A C file.

    Attributes:
        own: what it declares itself.
        visible: names of the headers that it includes, and of those that they include.
    """

    path: Path
    own: list[Declaration]
    visible: frozenset[str]

    @property
    def names(self) -> frozenset[str]:
        """Names that the file itself declares."""
        return frozenset().union(*(one.names for one in self.own))


@brief
@dataclass(kw_only=True)
class Sources:
    """C files, each after those that it includes."""

    files: dict[Path, File] = field(default_factory=dict)

    @classmethod
    def of(cls, units: Sequence[Path]) -> Sources:
        """The units in their order, and all that they include."""
        sources = cls()
        for unit in units:
            sources._read(unit.resolve())
        return sources

    def _read(self, path: Path) -> File:
        if path not in self.files:
            text = path.read_text(encoding="utf-8")
            included = [self._read((path.parent / name).resolve()) for name in INCLUDE.findall(text) if name]
            text = GUARD.sub(r"\2", INCLUDE.sub("", text))
            visible = frozenset().union(*(one.names | one.visible for one in included))
            self.files[path] = File(path=path, own=declarations(text), visible=visible)
        return self.files[path]

    def taken_out(self, names: Iterable[str]) -> tuple[str, Sources]:
        """The text of the declarations of some names, which are then not renamed; and the sources without them."""
        wanted, text, files = set(names), "", {}
        for path, file in self.files.items():
            text += "".join(one.text for one in file.own if one.names & wanted)
            files[path] = replace(file, own=[one for one in file.own if not one.names & wanted])
        gone = frozenset().union(*(file.names for file in self.files.values())) - frozenset().union(
            *(file.names for file in files.values())
        )
        return text.strip() + "\n", Sources(
            files={path: replace(file, visible=file.visible - gone) for path, file in files.items()}
        )

    def shared(self, prefix: str) -> dict[str, str]:
        """New names of what headers declare.

        Raises:
            ModelError: two headers declare the same.
        """
        renamed: dict[str, str] = {}
        for file in self.files.values():
            for name in file.names if file.path.suffix == ".h" else ():
                if name in renamed:
                    raise ModelError(f"names of headers must differ, got {name} of {file.path.name} twice")
                renamed[name] = f"{prefix}{name}"
        return renamed

    def text(self, needed: str, prefix: str) -> str:
        """Declarations of the sources that a text needs, renamed.

        Args:
            needed: C source text, with the names that headers have now.
            prefix: of all names.

        Raises:
            ModelError: two headers declare the same name.
        """
        shared, parts = self.shared(prefix), list[Declaration]()
        for file in self.files.values():
            names = {name: shared[name] for name in file.visible}
            names |= (
                {name: shared.get(name, "") for name in file.names}
                if file.path.suffix == ".h"
                else {name: f"{prefix}{file.path.stem}_c_{name}" for name in file.names - file.visible}
            )
            parts += [_renamed(one, names) for one in file.own]
        root = Declaration(text=renamed(needed, shared), names=frozenset())
        declared = [_internal(one) for one in _reached(root, parts)]
        return "".join(one if one.startswith("\n") else f"\n{one}" for one in declared)


def _renamed(one: Declaration, names: Mapping[str, str]) -> Declaration:
    return replace(one, text=renamed(one.text, names), names=frozenset(names.get(name, name) for name in one.names))


def _reached(root: Declaration, parts: list[Declaration]) -> list[Declaration]:
    """The declarations that one needs, and that these need, in their order."""
    by_name: dict[str, list[Declaration]] = {}
    for one in parts:
        for name in one.names:
            by_name.setdefault(name, []).append(one)
    reached, left = set[int](), [root]
    while left:
        for name in left.pop().needs():
            more = [one for one in by_name.pop(name, []) if id(one) not in reached]
            reached |= {id(one) for one in more}
            left += more
    return [one for one in parts if id(one) in reached]


def _internal(one: Declaration) -> str:
    """A declaration of a function as static, which its definition then is, too."""
    if not one.prototype or re.search(r"^(?:__attribute__.*)?static\b", one.text, re.MULTILINE):
        return one.text
    return re.sub(r"^(?=[A-Za-z_][^\n]*\()", "static ", one.text, count=1, flags=re.MULTILINE)
