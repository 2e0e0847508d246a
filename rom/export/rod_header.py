"""A finger of rod elements as one C header: declarations, and in one file of a program the code and the numbers.

The same C that Python calls (rom/native), with the model's numbers as constants. Its limits are this finger's: a
finger of one plate needs a small part of the stack that one of the most plates does.
"""

import hashlib
import re
from collections.abc import Mapping
from pathlib import Path

from rom.export.amalgamation import Sources
from rom.export.c_text import renamed
from rom.export.numbers import definitions, literal
from rom.export.wasm_memory import address, owners
from rom.files.checked_file import ModelError
from rom.native import LIBRARY
from rom.rod.touched_segment import TouchedSegment

NATIVE = Path(__file__).parent / "native"
# A rod needs no separated forms, and no choice between kinds of models.
UNITS = [unit for unit in LIBRARY.units if unit.parent.name != "separated" and unit.name != "model.c"]
PUBLIC = "fingerfem_object", "FINGERFEM_PLANE"  # by these: the type of objects, and the enum of shapes
EXAMPLE, DEEP = 0.3, 2 / 3  # of the leading tension's range, and of the touch distance there: a point in contact [-]
# The stack that gcc takes, times 1.25 or so, which tests measure: by the bodies that may bear wrenches, plates and
# sections of rubber, and their square, for matrices of all wrenches, and by the powers of a polynomial [kB].
SECTIONS = LIBRARY.constants.FINGERFEM_MOST_BODIES - LIBRARY.constants.FINGERFEM_MOST_PLATES  # besides plates
STACK, BY_BODY, BY_BODIES, BY_POWER = 160.0, 18.0, 3.2, 0.35


def rod_header(model: TouchedSegment, name: str) -> str:
    """The text of a header whose names begin with `name`, a C identifier."""
    chain = model.touching.chain
    memory, limits = LIBRARY.functions.fingerfem_chain_memory(chain), _limits(model)
    types, sources = Sources.of(UNITS).taken_out(PUBLIC)
    objects = _template("rod_objects.h.in").replace("@TYPES@\n", types)
    lines, touching = definitions(model.touching, f"{name}__part_", aligned=True)
    texts = _about(model) | {
        "FINGERPRINT": str(model.rod.elements.provenance.get("fingerprint", "unknown")),
        "STACK": f"{_stack(limits):.0f}",
        "TENSIONS": str(chain.tensions),
        "PLATES": str(chain.plates),
        "LOADS": str(LIBRARY.functions.fingerfem_chain_loads(chain)),
        "MEMORY": str(memory),
        "BYTES": str(8 * memory),
        "UPPER": name.upper(),
        "GUARD": f"{name.upper()}_H",
        "VERSION": f"0x{hashlib.sha256(objects.encode()).hexdigest()[:8]}",
        "OBJECT": objects,
        "TOUCHING": touching,
    }
    wrapper = _ends(model, name) + _filled(_template("rod_functions.c.in"), name, texts)
    needed, shared = "".join(lines) + wrapper, sources.shared(f"{name}__")
    code = sources.text(needed, f"{name}__")
    texts |= {
        "SOURCES": _limited(code, limits),
        "NUMBERS": renamed("".join(lines), shared),
        "WRAPPER": renamed(wrapper, shared),
    }
    return _filled(_template("rod.h.in"), name, texts)


def _about(model: TouchedSegment) -> dict[str, str]:
    """Texts of a header's comment: the model's title, its parameters, its plane's position, and a point in contact."""
    lower, upper = model.limits
    point = lower.copy()
    point[model.lead] += EXAMPLE * (upper - lower)[model.lead]
    touch = float(model.outputs(point[None])[0, 4])
    point[-1] = DEEP * touch if touch > 0 else 0.0
    parameters = [f"      {one.name} [{one.unit}] from {one.lower:g} to {one.upper:g}" for one in model.parameters]
    return {
        "TITLE": re.sub(r"[^\w .,:()-]", " ", str(model.scene["name"])),
        "PARAMETERS": "\n".join(parameters),
        "HALF": f"{model.obstacle.centre[1]:g}",
        "EXAMPLE": ", ".join(f"{value:.2g}" for value in point),
    }


def _ends(model: TouchedSegment, name: str) -> str:
    """The box, as constants."""
    values = [", ".join(literal(float(value), "double") for value in end) for end in model.limits]
    ends = zip(("lower", "upper"), values, strict=True)
    return "".join(f"const double {name}_{end}[{name}_TENSIONS + 1] = {{{numbers}}};\n" for end, numbers in ends)


def _limits(model: TouchedSegment) -> dict[str, int]:
    """Limits of compiled code that this finger has need of: arrays have sizes by these."""
    known, powers = owners(model.touching), [1]
    for one in known.values():
        kind = LIBRARY.ffi.typeof(one)
        fields = dict(kind.item.fields) if kind.kind == "pointer" else {}
        powers += [one.most_power] if "most_power" in fields else []
        powers += list(known[address(one.most_powers)]) if "most_powers" in fields else []
    chain = model.touching.chain
    return {
        "FINGERFEM_MOST_PLATES": chain.plates,
        "FINGERFEM_MOST_ELEMENTS": max(chain.segments[k].elements for k in range(chain.plates)),
        "FINGERFEM_MOST_POWER": max(powers),
        "FINGERFEM_MOST_VERTICES": max(1, *(chain.segments[k].vertices for k in range(chain.plates))),
    }


def _stack(limits: Mapping[str, int]) -> float:
    """The most that a call needs [kB]."""
    bodies, power = limits["FINGERFEM_MOST_PLATES"] + SECTIONS, limits["FINGERFEM_MOST_POWER"]
    return STACK + BY_BODY * bodies + BY_BODIES * bodies**2 + BY_POWER * (power + 1)


def _limited(code: str, limits: Mapping[str, int]) -> str:
    """Code with other limits."""
    for limit, value in limits.items():
        code, count = re.subn(rf"(__{limit} =) \d+\b", rf"\1 {value}", code)
        if count != 1:
            raise ModelError(f"sources must define {limit} once, got {count} times")
    return code


def _template(name: str) -> str:
    return (NATIVE / name).read_text(encoding="utf-8")


def _filled(template: str, name: str, texts: Mapping[str, str]) -> str:
    """A template with texts for @NAME@, and the header's name for @."""
    return re.sub(r"@([A-Z]+)@|@", lambda found: texts[found[1]] if found[1] else name, template)
