"""Ctrl-C, wherever it comes."""

import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from rom.console.interruption import INTERRUPTED, NOTHING_KEPT

ROOT = Path(__file__).resolve().parents[2]
SENT = "os.kill(os.getpid(), signal.SIGINT); time.sleep(5)"
TOLERANT = f"""
import os, signal, time
try:
    {SENT}
except BaseException:
    pass
"""
PLACES = {"while a module is imported that swallows all exceptions": "import tolerant", "elsewhere": SENT}


@pytest.mark.parametrize("place", PLACES)
def test_a_process_ends_in_one_line(tmp_path, place):
    (tmp_path / "tolerant.py").write_text(TOLERANT)
    begun = "import os, signal, time; import rom.console.interruption as i; i.interruptible()"
    program = f"{begun}; {PLACES[place]}; print('on')"
    ended = subprocess.run(
        [sys.executable, "-c", program],
        env=os.environ | {"PYTHONPATH": os.pathsep.join(map(str, [ROOT, tmp_path]))},
        capture_output=True,
        text=True,
    )
    assert ended.returncode == INTERRUPTED == 128 + signal.SIGINT
    assert ended.stdout == "" and ended.stderr.splitlines() == [NOTHING_KEPT]
