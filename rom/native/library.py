"""C sources that are built once for a machine and called through cffi.

A wheel or an image brings the built library beside its sources (`python3 -m rom.native` builds it there). Elsewhere
the first use builds it with the machine's C compiler, in some seconds, and keeps it in the user's cache. A library's
name has a hash of its sources, flags and processor, so that an old one is never taken for a new one.
"""

from __future__ import annotations

import hashlib
import os
import platform
import re
import shutil
import subprocess
import tempfile
from collections.abc import Sequence
from dataclasses import fields
from functools import cache, cached_property
from pathlib import Path
from typing import Any
from weakref import WeakKeyDictionary

# Sums may be taken in any order, so that they are vectorised; infinities and NaN keep their meaning. -O3 would be no
# faster and take four times as long to compile.
FLAGS = (
    *("-std=c99", "-O2", "-ftree-vectorize", "-fvect-cost-model=dynamic", "-shared", "-fPIC", "-ffp-contract=fast"),
    *("-Werror=implicit-function-declaration", "-Werror=vla"),  # no array whose size a file says lies on the stack
    *("-fno-math-errno", "-fno-trapping-math", "-fno-signed-zeros", "-fassociative-math"),
)
# Processor features that gcc's and clang's -march=x86-64-v3 and -v4 rely on; baseline code runs everywhere.
FEATURES = {
    "x86-64-v4": {"avx512f", "avx512bw", "avx512cd", "avx512dq", "avx512vl"},
    "x86-64-v3": {"avx", "avx2", "bmi1", "bmi2", "f16c", "fma", "abm", "movbe"},
}
LINE = 64  # of the cache [bytes]
KINDS = {"double": "f8", "int32_t": "i4", "int64_t": "i8", "uint8_t": "u1", "uint64_t": "u8"}
_kept: WeakKeyDictionary[Any, list[Any]] = WeakKeyDictionary()


class PickledByFields:
    """A dataclass of which only the fields are pickled: what compiled code needs is made again."""

    def __getstate__(self) -> dict[str, Any]:
        return {one.name: getattr(self, one.name) for one in fields(self)}  # type: ignore[arg-type]


def levels() -> list[str]:
    """Levels of the processor that a library for other machines is built for, see `processor`."""
    return ["", *FEATURES] if platform.machine() == "x86_64" else [""]


def compiler() -> str:
    """The C compiler's command, with its options if CC has any; empty if there is none."""
    return os.environ.get("CC") or next(filter(shutil.which, ("cc", "gcc", "clang")), "")


class NoCompiler(OSError):
    """Neither a built library nor a C compiler that builds it: one line that says what to do."""


@cache
def processor() -> str:
    """Value of the compiler's -march option for this machine's processor; empty for its own baseline."""
    if platform.machine() != "x86_64" or not Path("/proc/cpuinfo").exists():
        return ""
    (flags, *_) = re.findall(r"^flags\s*:(.*)$", Path("/proc/cpuinfo").read_text(), re.MULTILINE) or [""]
    available = set(flags.split())
    level = ""
    for name, features in reversed(FEATURES.items()):
        if not features <= available:
            break
        level = name
    return level


class Library:
    """C sources as functions and structs of Python; nothing is built or loaded before the first use.

    Args:
        name: of the library.
        folder: where its sources are, and where a wheel has it built.
        headers: what Python sees, in order; from cffi's point of view they have no directives.
        units: the files to compile.
        stands_on: a library whose functions and structs these use; it is loaded first.
    """

    def __init__(
        self,
        name: str,
        folder: Path,
        headers: Sequence[str],
        units: Sequence[Path],
        stands_on: Library | None = None,
    ):
        self.name, self.folder, self.units, self._stands_on = name, folder, units, stands_on
        self._headers = [folder / header for header in headers]

    @cached_property
    def ffi(self) -> Any:
        """The headers' types."""
        from cffi import FFI

        types = FFI()
        if self._stands_on is not None:
            types.include(self._stands_on.ffi)
        for header in self._headers:
            types.cdef(re.sub(r"^\s*#.*$", "", header.read_text(encoding="utf-8"), flags=re.MULTILINE))
        return types

    @cached_property
    def constants(self) -> Any:
        """The headers' enumerators as attributes; nothing is built for them."""
        from cffi import FFI

        enumerations = FFI()  # of enumerations alone, as whole headers take ten times as long
        for header in self._headers:
            enumerations.cdef("\n".join(re.findall(r"\benum \{[^}]*\};", header.read_text(encoding="utf-8"))))
        return enumerations.dlopen(None)

    @cached_property
    def functions(self) -> Any:
        """The headers' functions.

        Raises:
            NoCompiler: there is no library for this machine, and it cannot be built.
        """
        if self._stands_on is not None:
            self._stands_on.functions  # noqa: B018, so that they are there
        return self.ffi.dlopen(str(self._file()), self.ffi.RTLD_NOW | self.ffi.RTLD_GLOBAL)

    def _file(self) -> Path:
        own, cached = self.folder / self._file_name(processor()), _cache() / self._file_name(processor())
        baseline = own.with_name(self._file_name(""))
        for file in (own, cached, baseline):
            if file.exists():
                return file
        try:
            cached.parent.mkdir(parents=True, exist_ok=True)
            return self.build(cached.parent, processor())
        except NoCompiler:
            raise
        except OSError:  # nowhere to keep it: built for this process alone
            self._unkept = tempfile.TemporaryDirectory(prefix="fingerfem-")
            return self.build(Path(self._unkept.name), processor())

    def build(self, folder: Path, level: str) -> Path:
        """Compile for a level of the processor, see `processor`, into a folder.

        Any number of processes may do so at once: each writes a file of its own, and renames it when it is whole.

        Raises:
            NoCompiler: there is none, or it fails.
        """
        command = compiler()
        if not command:
            raise NoCompiler(
                "a C compiler must be there at first use, got none: install one (Debian: apt-get install gcc "
                "libc6-dev), or a wheel of fingerfem that was made where there is one (make wheel)"
            )
        target = folder / self._file_name(level)
        march = [f"-march={level}"] if level else []
        with tempfile.TemporaryDirectory(dir=folder, prefix=".building-") as beside:
            made = Path(beside) / target.name
            line = [*command.split(), *FLAGS, *march, "-o", str(made), *map(str, self.units), "-lm"]
            try:
                done = subprocess.run(line, capture_output=True, text=True)
            except OSError as error:
                raise NoCompiler(f"the C compiler must be there, got {command} ({error.strerror})") from None
            if done.returncode:
                lines = (done.stderr.strip() or f"exit code {done.returncode}").splitlines()
                said = next((line for line in lines if "error:" in line), lines[-1])
                raise NoCompiler(f"the C compiler must build {self.name}, got: {said} (from {command})")
            made.replace(target)
        return target

    def _file_name(self, level: str) -> str:
        return f"{self.name}-{level or platform.machine()}-{self._fingerprint}.so"

    @cached_property
    def _fingerprint(self) -> str:
        """Hash of all that the library is made from."""
        under = "" if self._stands_on is None else self._stands_on._fingerprint  # whose structs it has compiled in
        digest = hashlib.sha256((under + " ".join(FLAGS)).encode())
        for file in sorted(self.folder.rglob("*.[ch]")):
            digest.update(file.relative_to(self.folder).as_posix().encode() + file.read_bytes())
        return digest.hexdigest()[:16]

    @cached_property
    def _aligned(self) -> Any:
        """Replacement of `ffi.new`: arrays begin with a cache line, as vector loads across two take twice the time."""
        from cffi import FFI

        own = FFI()
        own.cdef("int posix_memalign(void **, size_t, size_t); void free(void *);")
        libc = own.dlopen(None)

        def allocate(size: int) -> Any:
            address = own.new("void **")
            if libc.posix_memalign(address, LINE, max(size, 1)):
                raise MemoryError(f"memory must have {size} bytes left, got none")
            return address[0]

        return self.ffi.new_allocator(allocate, libc.free)

    def pointers(self, kind: str, structs: Sequence[Any]) -> Any:
        """An array of pointers to C structs of a kind, which live as long as it does."""
        array = self.ffi.new(f"{kind} *[]", list(structs))
        _kept[array] = list(structs)
        return array

    def struct(self, kind: str, **values: Any) -> Any:
        """A C struct; what its fields point to lives as long as it does.

        Args:
            kind: its name.
            values: numbers; arrays where it points to numbers; structs where it points to these; and of structs in it
                their values, as mappings.
        """
        struct, fields, kept = self.ffi.new(f"{kind} *"), dict(self.ffi.typeof(kind).fields), []
        for name, value in values.items():
            of = fields[name].type
            if of.kind == "pointer" and of.item.kind == "primitive":
                value = self._aligned(
                    f"{of.item.cname}[]", value.ravel().tolist() if hasattr(value, "ravel") else value
                )
                kept.append(value)
            elif of.kind == "struct":
                kept.append(self.struct(of.cname, **value))
                value = kept[-1][0]
            elif of.kind == "pointer":
                kept.append(value)
            setattr(struct, name, value)
        _kept[struct] = kept
        return struct


def kept_by(struct: Any) -> list[Any]:
    """Objects that a struct of a library, or an array of pointers to such, points to and keeps alive."""
    return _kept.get(struct, [])


def _cache() -> Path:
    """Folder of built libraries, one for every C library, as a newer one's may not run with an older."""
    base = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache")
    return base / "fingerfem" / "-".join(["native", *platform.libc_ver()]).rstrip("-")
