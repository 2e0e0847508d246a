"""README's badges, drawn from pyproject.toml and docker/run: no service is asked."""

from __future__ import annotations

import re
import tomllib
from html import escape
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
LETTER, MARGIN, HEIGHT = 6.6, 7, 20  # of 11 pixels Verdana; [pixels]
SVG = """<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{height}" role="img" aria-label="{name}: {value}">
<rect width="{split}" height="{height}" fill="#444c56"/>
<rect x="{split}" width="{rest}" height="{height}" fill="#1f6feb"/>
<g fill="#fff" font-family="Verdana,DejaVu Sans,sans-serif" font-size="11">
<text x="{margin}" y="14">{name}</text><text x="{begin}" y="14">{value}</text>
</g>
</svg>
"""  # noqa: E501


def values() -> dict[str, str]:
    """What they say."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    first, last = re.findall(r"DOLFINx (\d+\.\d+) to (\d+\.\d+)", (ROOT / "docker" / "run").read_text())[0]
    return {
        "version": project["version"],
        "licence": project["license"]["text"],
        "Python": project["requires-python"].replace(">=", "≥ "),
        "DOLFINx": f"{first} to {last}, optional",
    }


def badge(name: str, value: str) -> str:
    """One of them as SVG."""
    split, rest = (round(len(text) * LETTER) + 2 * MARGIN for text in (name, value))
    return SVG.format(
        width=split + rest,
        height=HEIGHT,
        split=split,
        rest=rest,
        margin=MARGIN,
        begin=split + MARGIN,
        name=escape(name),
        value=escape(value),
    )


def write(folder: Path) -> None:
    """Write all."""
    folder.mkdir(parents=True, exist_ok=True)
    for name, value in values().items():
        (folder / f"{name.lower()}.svg").write_text(badge(name, value))
