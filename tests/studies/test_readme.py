"""README does what it says."""

import re
import subprocess
import sys
import tomllib
from pathlib import Path

import fingerfem
from studies.readme import BEGIN, END

ROOT = Path(__file__).resolve().parents[2]
README = (ROOT / "README.md").read_text()
SHORT = 120  # lines


def test_it_is_short():
    assert len(README.splitlines()) <= SHORT


def test_its_six_lines_print_what_it_says():
    (example,), (_, _, expected, *_) = re.findall(r"```python\n(.*?)```", README, re.DOTALL), blocks()
    assert len([line for line in example.splitlines() if line]) <= 6
    done = subprocess.run([sys.executable, "-c", example], cwd=ROOT, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert done.stdout == expected


def blocks() -> list[str]:
    return re.findall(r"^```\w*\n(.*?)^```", README, re.DOTALL | re.MULTILINE)


def test_its_commands_run(tmp_path):
    (hold,) = re.findall(r"^python3 -m control hold.*$", README, re.MULTILINE)
    done = subprocess.run([sys.executable, *hold.split()[1:]], cwd=ROOT, capture_output=True, text=True)
    assert done.returncode == 0 and done.stdout.startswith("converged"), done.stderr
    (page,) = re.findall(r"^python3 (-m control export .*?) +#", README, re.MULTILINE)
    words = page.replace("finger.html", str(tmp_path / "finger.html")).split()
    done = subprocess.run([sys.executable, *words], cwd=ROOT, capture_output=True, text=True)
    assert done.returncode == 0 and (tmp_path / "finger.html").exists(), done.stderr


def test_its_links_lead_to_files():
    links = [link for link in re.findall(r"\]\(([^)#]+)", README) if "://" not in link]
    assert len(links) > 30 and [link for link in links if not (ROOT / link).exists()] == []


def test_readme_and_citation_name_the_version():
    version = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["version"]
    assert version == fingerfem.__version__
    assert f"\nversion: {version}\n" in (ROOT / "CITATION.cff").read_text()
    assert f"\n## {version} - " in (ROOT / "CHANGELOG.md").read_text()
    assert f"Version {version}, " in README
    first, last = re.findall(r"DOLFINx (\d+\.\d+) to (\d+\.\d+)", (ROOT / "docker" / "run").read_text())[0]
    assert f"DOLFINx {first} to {last}," in README


def test_the_two_commands_are_those_of_the_makefile_and_of_ci():
    assert "make demo " in README and "make test " in README
    targets = re.findall(r"^(\w+):", (ROOT / "Makefile").read_text(), re.MULTILINE)
    assert {"demo", "test", "clean"} <= set(targets)
    ci = [line.strip() for line in (ROOT / ".ci" / "run").read_text().splitlines() if line and line[0] != "#"]
    assert {"make test", "make test-long"} <= set(ci)
    assert "make test-long" in README


def test_the_measured_blocks_were_written():
    for page in (README, (ROOT / "docs" / "demo.md").read_text()):
        block = page.split(BEGIN)[1].split(END)[0]
        assert "contact force" in block and "%" in block


def test_the_makefile_names_files_that_exist():
    named = set(
        re.findall(
            r"(?<![\w/])(?:tests|scenes|studies|docs)/[\w/.]+\.(?:py|toml|csv|json|txt)\b",
            (ROOT / "Makefile").read_text(),
        )
    )
    assert len(named) >= 10
    assert [one for one in sorted(named) if not (ROOT / one).exists()] == []
