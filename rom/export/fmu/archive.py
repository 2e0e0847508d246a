"""The file of an FMU: its description, its C sources, and the library that they make on this machine."""

import hashlib
import platform
import re
import subprocess
import tempfile
import zipfile
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from rom.brief import brief
from rom.export.fmu import description
from rom.export.fmu.variables import OUTPUTS, Interface, Variable, model_interface
from rom.export.model import errors_of
from rom.export.numbers import definitions, literal
from rom.files.atomic_file import atomic_file
from rom.files.checked_file import ModelError
from rom.native import FLAGS, LIBRARY, compiler
from rom.rod.touched_segment import TouchedSegment
from rom.separated.model import SeparatedModel

VERSIONS = 2, 3  # of FMI
ROOT = Path(__file__).resolve().parents[3]  # rom/ is in it
NATIVE = Path(__file__).parent / "native"
NUMBERS = "numbers.c"
# An FMU's own names stay its own where a tool loads many; -s leaves out what only a debugger reads.
OPTIONS = (*FLAGS, "-fvisibility=hidden", "-s")
# Folder of the library, by FMI's version and the machine.
FOLDERS = {
    2: {"x86_64": "linux64", "aarch64": "linux-aarch64"},
    3: {"x86_64": "x86_64-linux", "aarch64": "aarch64-linux"},
}
STAMP = (1980, 1, 1, 0, 0, 0)  # of files in it: the same model makes the same FMU


@brief
@dataclass(frozen=True, kw_only=True)
class FmuSources:
    """C sources.

    Attributes:
        files: contents by their paths, as they lie in the checkout.
        units: which of them are compiled.
    """

    files: dict[str, bytes]
    units: list[str]


def write(
    model: SeparatedModel | TouchedSegment, path: Path, version: int = 3, interface: Interface | None = None
) -> None:
    """Write the FMU of a model.

    Args:
        model: its numbers are in the FMU.
        path: a file named .fmu; its stem is the model's identifier.
        version: of FMI, 2 or 3.
        interface: of what computes with the model; the model's own if omitted.

    Raises:
        ModelError: no such version, no C identifier, a model that this is not possible for, or no compiler.
    """
    if version not in VERSIONS:
        raise ModelError(f"fmi must be 2 or 3, got {version}")
    name = path.stem
    if path.suffix.lower() != ".fmu" or not re.fullmatch(r"[A-Za-z_]\w*", name, re.ASCII):
        raise ModelError(f"FMU must be a file named .fmu whose name is a C identifier, got {path.name}")
    machine = platform.machine()
    if machine not in FOLDERS[version] or platform.system() != "Linux":
        raise ModelError(f"machine must be Linux on x86_64 or aarch64, got {platform.system()} on {machine}")
    interface = interface or model_interface(model)
    sources = sources_of(model, interface, version)
    token = token_of(sources)
    sources.files[NUMBERS] = f'{sources.files[NUMBERS].decode()}const char fmu_token[] = "{token}";\n'.encode()
    files = {f"sources/{file}": contents for file, contents in sources.files.items()}
    if version == 2:
        files["modelDescription.xml"] = description.fmi2(interface, name, token, sources.units)
    else:
        files["modelDescription.xml"] = description.fmi3(interface, name, token)
        built = description.build_description(name, sources.units, "gcc", " ".join(OPTIONS))
        files["sources/buildDescription.xml"] = built
    files[f"binaries/{FOLDERS[version][machine]}/{name}.so"] = compiled(sources)
    pack(files, path)


def sources_of(model: SeparatedModel | TouchedSegment, interface: Interface, version: int) -> FmuSources:
    """All that is compiled, in the folders it has in the checkout, so that files find each other."""
    units = [NATIVE / "fmu.c", NATIVE / f"fmu{version}.c", *interface.units, *LIBRARY.units]
    contents = {file.relative_to(ROOT).as_posix(): file.read_bytes() for file in with_included(units)}
    contents[NUMBERS] = numbers(model, interface).encode()
    return FmuSources(files=contents, units=[*(unit.relative_to(ROOT).as_posix() for unit in units), NUMBERS])


def with_included(units: Sequence[Path]) -> list[Path]:
    """C files and all that they include."""
    files, left = set[Path](), list(units)
    while left:
        file = left.pop()
        if file not in files:
            files.add(file)
            names = re.findall(r'^#include "(.*)"', file.read_text(encoding="utf-8"), re.MULTILINE)
            left += [(file.parent / name).resolve() for name in names]
    return sorted(files)


def numbers(model: SeparatedModel | TouchedSegment, interface: Interface) -> str:
    """C of a model's numbers, without the shape that only a picture needs; all but the token."""
    lines, name = definitions(model_struct(model))
    starts = [one.start for one in interface.variables if one.start is not None]
    outputs = [one for one in interface.of("output") if one.kind == "Real"]
    smooth = [one for one in outputs if interface.differentiable and not one.discrete]
    return "\n".join(
        [
            "/* Generated: a trained model's numbers, see rom/export/fmu/native/fmu.h. */",
            "#include <math.h>",
            '#include "rom/export/fmu/native/fmu.h"',
            *lines,
            f"const fingerfem_model *const fmu_model = {name};",
            f"const int fmu_inputs = {len(starts)}, fmu_parameters = {len(interface.of('parameter'))};",
            f"const uint32_t fmu_outputs = {mask(outputs)}, fmu_differentiable = {mask(smooth)};",
            f"const double fmu_starts[] = {{{', '.join(literal(float(start), 'double') for start in starts)}}};",
            "",
        ]
    )


def mask(outputs: list[Variable]) -> int:
    """Bits of outputs, by their value references."""
    return sum(1 << (one.reference - OUTPUTS) for one in outputs)


def model_struct(model: SeparatedModel | TouchedSegment) -> Any:
    """A struct fingerfem_model without its shape."""
    p = len(model.parameters)
    if isinstance(model, TouchedSegment):
        return LIBRARY.struct("fingerfem_model", parameters=p, touching=model.touching)
    return LIBRARY.struct("fingerfem_model", parameters=p, kernel=model.kernel, errors=errors_of(model))


def token_of(sources: FmuSources) -> str:
    """Identifies this FMU: 32 digits of the hash of all that it is made from, as a GUID."""
    digest = hashlib.sha256()
    for file, contents in sorted(sources.files.items()):
        digest.update(file.encode() + contents)
    digits = digest.hexdigest()
    return f"{{{digits[:8]}-{digits[8:12]}-{digits[12:16]}-{digits[16:20]}-{digits[20:32]}}}"


def compiled(sources: FmuSources) -> bytes:
    """The library, for every processor of this machine's kind.

    Raises:
        ModelError: no C compiler, or one that fails.
    """
    command = compiler()
    if not command:
        raise ModelError("a C compiler must be there to make an FMU, got none (Debian: apt-get install gcc libc6-dev)")
    with tempfile.TemporaryDirectory(prefix="fingerfem-") as folder:
        for file, contents in sources.files.items():
            (Path(folder) / file).parent.mkdir(parents=True, exist_ok=True)
            (Path(folder) / file).write_bytes(contents)
        line = [*command.split(), *OPTIONS, "-o", "finger.so", *sources.units, "-lm"]
        try:
            done = subprocess.run(line, cwd=folder, capture_output=True, text=True)
        except OSError as error:
            raise ModelError(f"the C compiler must be there, got {command} ({error.strerror})") from None
        if done.returncode:
            said = (done.stderr.strip() or f"exit code {done.returncode}").splitlines()[-1]
            raise ModelError(f"the C compiler must build the FMU, got: {said} (from {command})")
        return (Path(folder) / "finger.so").read_bytes()


def pack(files: dict[str, bytes], path: Path) -> None:
    """Write a zip file: it is whole or absent."""
    with atomic_file(path) as beside, zipfile.ZipFile(beside, "w", zipfile.ZIP_DEFLATED) as archive:
        for name in sorted(files, key=lambda name: (name != "modelDescription.xml", name)):
            archive.writestr(zipfile.ZipInfo(name, STAMP), files[name], zipfile.ZIP_DEFLATED)
