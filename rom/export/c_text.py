"""C source text at file scope: its declarations, the names they declare and those they need."""

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from rom.brief import brief

COMMENT = r"/\*.*?\*/|//[^\n]*"
TOKEN = re.compile(
    rf"(?P<comment>{COMMENT})"
    rf"|(?P<directive>^[ \t]*\#(?:{COMMENT}|\\\n|[^\n])*)"
    r"|(?P<string>\"(?:\\.|[^\"\\])*\"|'(?:\\.|[^'\\])*')"
    r"|(?P<number>\.?\d(?:[eEpP][+-]|[\w.])*)"
    r"|(?P<member>(?:\.|->)\s*[A-Za-z_]\w*)"
    r"|(?P<name>[A-Za-z_]\w*)"
    r"|(?P<other>\S)",
    re.MULTILINE | re.DOTALL,
)
# The same within a directive, which is one token above.
PART = re.compile(TOKEN.pattern.replace(r"|(?P<directive>^[ \t]*\#", r"|(?P<directive>(?!)"), TOKEN.flags)
ATTRIBUTE = "__attribute__"
OPEN, CLOSED = "([{", ")]}"


@brief
@dataclass(frozen=True, kw_only=True)
class Declaration:
    """A declaration, a definition, or a directive and all it encloses.

    Attributes:
        text: with the comment before it.
        names: what it declares, members of structs excepted.
        prototype: whether it declares a function and does not define it.
    """

    text: str
    names: frozenset[str]
    prototype: bool = False

    def needs(self) -> set[str]:
        """All names in it."""
        return {part[0] for part in _parts(self.text) if part.lastgroup == "name"}


def declarations(text: str) -> list[Declaration]:
    """The declarations of C source text, in order; its includes must have been removed."""
    parsed: list[Declaration] = []
    code: list[str] = []
    begin, depth, conditions, names = 0, 0, 0, set[str]()
    for token in TOKEN.finditer(text):
        one, kind, line = token[0], token.lastgroup, False
        if kind == "comment":
            if parsed and not code and not conditions and "\n" not in text[begin : token.start()]:
                parsed[-1], begin = _continued(parsed[-1], text[begin : token.end()]), token.end()
            continue
        if kind == "directive":
            if depth:
                continue
            word = re.match(r"\s*#\s*(\w+)(?:\s+(\w+))?", one)
            assert word is not None
            conditions += word[1].startswith("if") - (word[1] == "endif")
            names |= {word[2]} if word[1] == "define" else set()
            line = not conditions
        else:
            code.append(one)
            depth += (one in OPEN) - (one in CLOSED)
            if not depth and (one == ";" or (one == "}" and _is_function(code))):
                names |= declared(code)
                line = not conditions
                code = code if line else []
        if line:
            text_of = text[begin : token.end()]
            prototype = bool(code) and code[-1] == ";" and _is_function(code)
            parsed.append(Declaration(text=text_of, names=frozenset(names), prototype=prototype))
            begin, names, code = token.end(), set(), []
    return parsed


def declared(code: list[str]) -> set[str]:
    """Names that a statement at file scope declares: constants of an enum, a type, a function, a variable."""
    flat = _flat(code)
    names = {two for one, two, three in zip(flat, flat[1:], flat[2:], strict=False) if one == "struct" and three == "{"}
    if "enum" in flat[:2]:
        inner = code[code.index("{") + 1 : code.index("}")]
        names |= {one for before, one in zip([",", *inner], inner, strict=False) if before == ","}
    if "(" in flat and flat[0] != "typedef":
        return names | {flat[flat.index("(") - 1]}
    for one in " ".join(flat[:-1]).split(" , "):
        before = re.split(r" [\[=]", one)[0].split()
        names |= {before[-1]} - {"}"}
    return names


def renamed(text: str, names: Mapping[str, str]) -> str:
    """C source text with other names, but for members of structs, comments and strings."""
    return "".join(names.get(part[0], part[0]) if part.lastgroup == "name" else part[0] for part in _all_parts(text))


def _continued(one: Declaration, more: str) -> Declaration:
    return Declaration(text=one.text + more, names=one.names, prototype=one.prototype)


def _is_function(code: list[str]) -> bool:
    flat = _flat(code)
    return "(" in flat and flat[0] != "typedef" and "=" not in flat


def _flat(code: list[str]) -> list[str]:
    """Tokens outside of all brackets, which remain themselves; attributes are left out."""
    outside, depth = list[str](), 0
    for one in code:
        depth -= one in CLOSED
        if not depth:
            outside.append(one)
        depth += one in OPEN
        if outside[-3:] == [ATTRIBUTE, "(", ")"]:
            del outside[-3:]
    return outside


def _parts(text: str) -> Iterator[re.Match[str]]:
    """Tokens of a text, directives taken apart."""
    return PART.finditer(text)


def _all_parts(text: str) -> Iterator[re.Match[str]]:
    """The same with the space between them."""
    return re.finditer(f"{PART.pattern}|(?P<space>\\s+)", text, PART.flags)
