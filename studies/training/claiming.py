"""A process that claims and writes lines of states: python3 -m studies.training.claiming OURS THEIRS.

It solves none. It waits for a file OURS/go, and prints the number of its claims.
"""

from __future__ import annotations

import sys
import time
from pathlib import Path

from fingerfem.snapshots.task_queue import Queue
from rom.dataset.snapshot_set import read_description, read_task


def main(ours: Path, theirs: Path) -> None:
    """Write the arrays of a line of another set until no line is left."""
    description, arrays, claims = read_description(ours), read_task(theirs, "contact-0-0"), 0
    while not (ours / "go").exists():
        time.sleep(0.01)
    with Queue(description, ours, lambda task: True, lambda: None) as queue:
        while queue.claim() is not None:
            queue.finish(arrays)
            claims += 1
    print(claims)


if __name__ == "__main__":
    main(*map(Path, sys.argv[1:]))
