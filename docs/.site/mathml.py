"""A hook of mkdocs: formulas become MathML, which browsers draw without a script and without a network."""

from __future__ import annotations

import html
import re
from typing import Any

from latex2mathml.converter import convert

FORMULA = re.compile(r'<(span|div) class="arithmatex">\\[(\[](.*?)\\[)\]]</\1>', re.DOTALL)


def on_page_content(text: str, **_: Any) -> str:
    """The page with its formulas as MathML."""
    return FORMULA.sub(lambda found: _mathml(found[1] == "div", html.unescape(found[2])), text)


def _mathml(block: bool, latex: str) -> str:
    return convert(latex.strip(), display="block" if block else "inline")
