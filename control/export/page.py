"""A model as one page for a browser: the finger bends as sliders move, with nothing but the file.

`viewer.html` is the page without a model. `make page` makes it from browser/ and from the C that Python calls.
"""

import base64
import json
import math
import zlib
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from rom.dataset.geometry import tip_at_rest
from rom.dataset.sections.section import outline, top
from rom.export.model import struct
from rom.export.wasm_memory import Image
from rom.files.atomic_file import write_whole
from rom.files.checked_file import ModelError
from rom.rod.compiled import ENDS
from rom.rod.touched_segment import TouchedSegment
from rom.separated.model import SeparatedModel

VIEWER = Path(__file__).with_name("viewer.html")
FEW = 10.0  # [N]: what a bar of forces shows of a separated model without any
AROUND = 48  # points of a round section's border


def write(model: SeparatedModel | TouchedSegment, path: Path) -> None:
    """Write the page of a model.

    Raises:
        ModelError: no name of a page.
    """
    if path.suffix.lower() not in (".html", ".htm"):
        raise ModelError(f"page must be a file named .html, got {path}")
    text = json.dumps(about(model), allow_nan=False).replace("<", "\\u003c")
    page = VIEWER.read_text(encoding="utf-8").replace("@MODEL@", text)
    write_whole(path, lambda stream: stream.write(page.encode()))


def about(model: SeparatedModel | TouchedSegment) -> dict[str, Any]:
    """The model for the page, as plain data."""
    own = struct(model)
    image, root = Image.of(own)
    geometry = model.scene["geometry"]
    surface = parts(model) if isinstance(model, TouchedSegment) else []
    ends = np.cumsum([len(one) for one in surface])  # sections up to every plate's front
    return {
        "title": f"{model.scene['name']}: a rubber finger, {millimetres(geometry['segments'])} long",
        "description": described(model),
        "parameters": [one.as_json() for one in model.parameters],
        "has_obstacle": model.has_obstacle,
        "has_pad": model.has_pad,
        "reports": isinstance(model, TouchedSegment),  # the tip's orientation and the strokes of actuators
        "growth_error": model.rod.errors.growth if isinstance(model, TouchedSegment) else 0.0,
        "lead": model.lead,
        "most_force": most_force(model),
        "rest": tip_at_rest(geometry).tolist(),
        "geometry": {"side": 2 * top(model.scene)} | {name: geometry[name] for name in ("segments", "plate")},
        "tendons": [
            {
                "weights": weights(model, [one["offset"]])[0].tolist(),
                "straight": one["path"] == "straight",
                "last": int(ends[one["segment"] - 1]) - 1 if own.sections else 0,
            }
            for one in model.scene["tendons"]
        ],
        "sections": own.sections,
        "border": weights(model, border(model)).tolist(),
        "metal": [bool(one) for segment in surface for one in segment],
        "root": root,
        "addresses": image.addresses,
        "memory": base64.b64encode(zlib.compress(bytes(image.memory), 9)).decode(),
    }


def border(model: SeparatedModel | TouchedSegment) -> np.ndarray:
    """Points around the section at the clamp, shape (n, 2) [m]."""
    section = outline(model.scene)
    return section.points(AROUND) if section.radius else section.vertices


def weights(model: SeparatedModel | TouchedSegment, points: ArrayLike) -> np.ndarray:
    """Bilinear weights of points in a section's box, by its corners -y -z, -y z, y -z and y z, shape (n, 4) [-]."""
    y, z = ((1 + np.asarray(points, float) / outline(model.scene).box) / 2).T
    return np.column_stack([(1 - y) * (1 - z), (1 - y) * z, y * (1 - z), y * z])


def parts(model: TouchedSegment) -> list[np.ndarray]:
    """Marks of every segment's sections: true if the next interval is its plate; the last is its front."""
    return [np.arange(one.struct.places + ENDS) >= one.struct.places + ENDS - 2 for one in model.rod.segments]


def most_force(model: SeparatedModel | TouchedSegment) -> float:
    """The largest contact force that a page shows [N]: about what was trained."""
    if isinstance(model, TouchedSegment):
        return model.rod.force
    lower, upper = model.limits
    pressed = upper.copy()
    pressed[-1] = lower[-1]
    corners = [np.where([k >> j & 1 for j in range(len(upper))], upper, lower) for k in range(2 ** len(upper))]
    force = float(np.max(model.evaluate(np.array(corners)).contact_force))
    return 10.0 ** math.ceil(math.log10(force)) / 2 if force > 0 else FEW


def described(model: SeparatedModel | TouchedSegment) -> str:
    """One line under the title."""
    if isinstance(model, TouchedSegment):
        states = int(model.rod.elements.provenance.get("states", 0))
        kind = f"a rod of {sum(map(len, model.rod.pieces))} elements"
        return f"{kind}, from {states} full-order states; contact with the plane is solved for as the sliders move"
    return f"separated model, {sum(model.terms.values())} products from {model.provenance['states']} " + (
        "samples of a finger of elements" if "specialised_from" in model.provenance else "full-order states"
    )


def millimetres(lengths: list[float]) -> str:
    """Lengths [m] one after another."""
    return " + ".join(f"{1e3 * one:g}" for one in lengths) + " mm"
