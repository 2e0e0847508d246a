"""The site has every public name, key, command and option, and no page or file that it does not have."""

import ast
import re
from collections.abc import Iterator
from functools import cache
from importlib import import_module
from pathlib import Path
from typing import get_args

import pytest
import typer
from pydantic import BaseModel

from fingerfem.scene.laws import REGISTERED, Law
from fingerfem.scene.scene import Scene
from fingerfem.scene.sections import SHAPES, FromFile, Section
from fingerfem.scene.tables import Expected

ROOT = Path(__file__).resolve().parents[2]
DOCS = ROOT / "docs"
REFERENCE = DOCS / "reference"
SAMPLES = REFERENCE / "samples"
PAGES = sorted(DOCS.rglob("*.md"))
GENERATED = "Measured by `make docs`"
BY_HAND = [page for page in PAGES if GENERATED not in page.read_text()]
INCLUDED = re.compile(r'^--8<-- "([^:"]*)[:\d]*"$', re.MULTILINE)  # without the lines that are shown


def named(page: Path) -> str:
    return str(page.relative_to(DOCS))


@pytest.mark.parametrize("package", ["fingerfem", "rom", "control", "control.mujoco"])
def test_every_name_that_a_package_exports_is_in_the_reference(package):
    tree = ast.parse((ROOT / package.replace(".", "/") / "__init__.py").read_text())
    (names,) = (
        ast.literal_eval(node.value) for node in tree.body if isinstance(node, ast.Assign) and is_all(node.targets)
    )
    listed = re.findall(r"^::: (\S+)$", "\n".join(page.read_text() for page in REFERENCE.glob("*.md")), re.MULTILINE)
    assert names and {f"{package}.{name}" for name in names} <= set(listed)
    assert len(listed) == len(set(listed))


def is_all(targets: list[ast.expr]) -> bool:
    return isinstance(targets[0], ast.Name) and targets[0].id == "__all__"


def keys(table: type[BaseModel], prefix: str = "") -> Iterator[str]:
    for name, field in table.model_fields.items():
        # Of further bodies the keys are those of the first one.
        inner = [one for one in tables(field.annotation) if one is not Expected and not issubclass(table, one)]
        if not inner:
            yield prefix + name
        for one in inner:
            yield from keys(one, f"{prefix}{name}.")


def tables(annotation: object) -> Iterator[type[BaseModel]]:
    if annotation is Law:
        yield from REGISTERED.values()
    elif annotation is Section:
        yield from (*SHAPES.values(), FromFile)
    elif isinstance(annotation, type) and issubclass(annotation, BaseModel):
        yield annotation
    for one in get_args(annotation):
        yield from tables(one)


def test_every_key_of_a_scene_is_in_the_reference_and_no_other():
    listed = re.findall(r"^\| `([\w.]+)` \|", (REFERENCE / "scene.md").read_text(), re.MULTILINE)
    written = {key for key in keys(Scene) if not key.startswith("geometry.section.")}  # a table of its own in a scene
    written = {re.sub(r"^materials\.material\..*", "materials.material", key) for key in written}  # keys of material
    assert set(listed) == {*written, "material.shore_A"}  # which stands for a modulus
    assert len(listed) == len(set(listed))


@cache
def command_line() -> str:
    page = (REFERENCE / "command-line.md").read_text()
    return INCLUDED.sub(lambda found: (SAMPLES / found[1]).read_text(), page)


@pytest.mark.parametrize("program", ["fingerfem", "rom", "control"])
def test_every_command_and_option_is_in_the_reference(program):
    commands = typer.main.get_command(import_module(f"{program}.__main__").app).commands
    described = dict(re.findall(r"^### (\w+ [\w-]+)\n(.*?)(?=^##|\Z)", command_line(), re.DOTALL | re.MULTILINE))
    assert {f"{program} {name}" for name in commands} == {one for one in described if one.startswith(f"{program} ")}
    for name, command in commands.items():
        text = described[f"{program} {name}"]
        words = [word for one in command.params for word in (*one.opts, *one.secondary_opts) if word.startswith("-")]
        missing = [word for word in words if not re.search(rf"(?<![\w-]){word}(?![\w-])", text)]
        assert not missing, f"{program} {name}: {missing}; python3 docs/.site/samples.py docs/reference/command-line.md"


def test_the_navigation_has_every_page_once_and_no_other():
    listed = re.findall(r"^ +- [^#\n]*?([\w./-]+\.md)$", (ROOT / "mkdocs.yml").read_text(), re.MULTILINE)
    assert sorted(listed) == sorted(map(named, PAGES)) and len(listed) <= 28


@pytest.mark.parametrize("page", BY_HAND, ids=named)
def test_relative_links_lead_to_files_of_the_site(page):
    text = re.sub(r"^```.*?^```|`[^`\n]*`", "", page.read_text(), flags=re.DOTALL | re.MULTILINE)
    targets = [one.split("#")[0] for one in re.findall(r"\]\(([^)\s]+)\)", text) if "://" not in one]
    missing = [one for one in targets if one and not (page.parent / one).exists()]
    outside = [one for one in targets if one and DOCS not in (page.parent / one).resolve().parents]
    assert not missing and not outside


def test_pages_quote_every_sample_and_no_other_and_each_is_made_once():
    texts = [page.read_text() for page in PAGES]
    assert {name for text in texts for name in INCLUDED.findall(text)} == {file.name for file in SAMPLES.iterdir()}
    made = [name for text in texts for name in re.findall(r'```\n\n```text\n--8<-- "([^:"]*)', text)]
    assert len(made) == len(set(made))


def test_nothing_of_the_machine_that_made_them_is_in_samples():
    for file in SAMPLES.iterdir():
        text = file.read_text()
        assert str(ROOT) not in text and "out/samples" not in text and "Traceback" not in text, file.name
