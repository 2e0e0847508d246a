"""A hook of mkdocs: formulas become MathML, which browsers draw without a script and without a network."""

from __future__ import annotations

import html
import re
from typing import Any

from latex2mathml.converter import convert

FORMULA = re.compile(r'<(span|div) class="arithmatex">\\[(\[](.*?)\\[)\]]</\1>', re.DOTALL)

GREEK = re.compile(r'<mi(?: mathvariant="([\w-]+)")?>(&#x003[9A-D][0-9A-F];)</mi>')


def on_page_content(text: str, **_: Any) -> str:
    """The page with its formulas as MathML."""
    return FORMULA.sub(lambda found: _mathml(found[1] == "div", html.unescape(found[2])), text)


def _mathml(block: bool, latex: str) -> str:
    found = convert(latex.strip(), display="block" if block else "inline")
    return GREEK.sub(_upright, found)


def _upright(letter: re.Match[str]) -> str:
    """A Greek letter that every font has: few fonts have its italic form."""
    bold = ' style="font-weight: bold"' if "bold" in (letter[1] or "") else ""
    return f'<mi mathvariant="normal"{bold}>{letter[2]}</mi>'
