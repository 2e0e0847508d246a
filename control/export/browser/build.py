"""Make control/export/viewer.html: the page without a model. `make page` calls this.

Needs what `npm ci` installs, and ziglang (PyPI), whose clang compiles C to WebAssembly and brings a C library for it.
"""

import base64
import hashlib
import subprocess
import sys
import tempfile
import zlib
from pathlib import Path

from control.export import NATIVE, UNITS
from control.export.page import VIEWER
from control.native import CONTROL
from rom.native import LIBRARY

HERE = Path(__file__).parent
ROOT = HERE.parents[2]
EXPORTED = (
    "fingerfem_model_memory",
    "fingerfem_model_evaluate",
    "fingerfem_model_sections",
    "control_standalone_size",
    "control_standalone",
    "control_standalone_memory",
    "control_standalone_hold",
    "control_standalone_finger_size",
    "__heap_base",
)
# As rom.native.FLAGS, of which WebAssembly has no fused operations; nothing but what is exported is kept.
FLAGS = ("-std=c99", "-O2", "-s", "-fno-math-errno", "-fno-trapping-math", "-fno-signed-zeros", "-Wl,--gc-sections")


def sources() -> str:
    """Hash of all that the page without a model is made from."""
    folders = LIBRARY.folder, CONTROL.folder, NATIVE
    files = [file for folder in folders for file in folder.rglob("*.[ch]")]
    files += [*(HERE / "src").iterdir(), *HERE.glob("package*.json"), HERE / "build.py"]
    found = hashlib.sha256()
    for file in sorted(files, key=lambda one: one.relative_to(ROOT).as_posix()):
        found.update(file.relative_to(ROOT).as_posix().encode() + file.read_bytes())
    return found.hexdigest()[:16]


def webassembly() -> bytes:
    """The model's C and the controllers', compiled."""
    units = [*UNITS, *LIBRARY.units]
    with tempfile.TemporaryDirectory() as folder:
        made = Path(folder) / "model.wasm"
        command = [sys.executable, "-m", "ziglang", "cc", "-target", "wasm32-wasi", "-mexec-model=reactor", *FLAGS]
        command += [f"-Wl,--export={name}" for name in EXPORTED]
        subprocess.run([*command, "-o", str(made), *map(str, units)], check=True)
        return made.read_bytes()


def script() -> str:
    """The page's modules and three.js as one."""
    command = ["node_modules/.bin/esbuild", "src/main.js", "--bundle", "--minify", "--format=iife", "--charset=utf8"]
    made = subprocess.run([*command, "--legal-comments=none"], cwd=HERE, check=True, capture_output=True, text=True)
    return made.stdout.replace("</script", "<\\/script")


def main() -> None:
    """Write it."""
    texts = {
        "SOURCES": sources(),
        "STYLE": (HERE / "src" / "style.css").read_text(),
        "CODE": base64.b64encode(zlib.compress(webassembly(), 9)).decode(),
        "SCRIPT": script(),
    }
    page = (HERE / "src" / "page.html").read_text()
    for name, text in texts.items():
        page = page.replace(f"@{name}@", text)
    VIEWER.write_text(page)
    print(f"{VIEWER}: {VIEWER.stat().st_size:,} bytes")


if __name__ == "__main__":
    main()
