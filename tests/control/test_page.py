"""docs/speed.md's examples run."""

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]


def test_every_example_runs(monkeypatch, capsys):
    pytest.importorskip("gymnasium", reason="the optional extra [gymnasium], which the page shows too")
    page = (ROOT / "docs" / "speed.md").read_text()
    blocks = re.findall(r"```python\n(.*?)```", page, re.DOTALL)
    assert len(blocks) >= 8
    names: dict = {}
    monkeypatch.chdir(ROOT)
    for block in blocks:
        exec(compile(block.replace("out/demo/", "rom/"), "docs/speed.md", "exec"), names)
    assert "2 kg at a friction of 0.3 drop below" in capsys.readouterr().out
