"""Structs in memory of 32-bit addresses: read back by Python's ctypes, which has a layout of its own."""

import ctypes
import struct

import numpy as np
import pytest

import rom
from rom.export.wasm_memory import ALIGNED, Image, address, owners
from rom.native import LIBRARY
from rom.rod.objects.shapes import box

NAMES = {
    **{"double": ctypes.c_double, "float": ctypes.c_float, "int32_t": ctypes.c_int32},
    **{"int64_t": ctypes.c_int64, "uint8_t": ctypes.c_uint8, "uint64_t": ctypes.c_uint64},
}
CUBE = box(centre=(0.01, 0.02, 0.03), sides=(0.01, 0.02, 0.04), direction=(0, 1, 0))


def mirrored(kind):
    """The same type for ctypes, with addresses of 32 bits."""
    if kind.kind == "pointer":
        return ctypes.c_uint32
    if kind.kind == "array":
        return mirrored(kind.item) * kind.length
    if kind.kind == "struct":
        fields = [(name, mirrored(field.type)) for name, field in kind.fields]
        return type(kind.cname, (ctypes.LittleEndianStructure,), {"_fields_": fields})
    return NAMES[kind.cname]


def read(image: Image, at: int, kind: str):
    return mirrored(LIBRARY.ffi.typeof(kind)).from_buffer_copy(bytes(image.memory), at)


@pytest.fixture(scope="module")
def touching():
    return rom.load().touching


def test_a_hull_is_read_back_from_its_image_number_by_number():
    numbers = CUBE.numbers()
    image, at = Image.of(LIBRARY.struct("fingerfem_object", **numbers))
    found = read(image, at, "fingerfem_object")
    assert found.radius == numbers["radius"] and list(found.centre) == numbers["centre"]
    assert (found.corners, found.edges, found.faces) == (8, 12, 6)
    for name, kind in (("vertices", np.float64), ("heights", np.float64), ("ends", np.int32), ("sides", np.int32)):
        begin, values = getattr(found, name), np.asarray(numbers[name])
        assert np.array_equal(np.frombuffer(image.memory, kind, values.size, begin), values.ravel())


def test_addresses_are_listed_aligned_and_never_zero(touching):
    image, at = Image.of(touching)
    assert at == ALIGNED and len(set(image.addresses)) == len(image.addresses) > 50
    targets = np.array([struct.unpack_from("<I", image.memory, place)[0] for place in image.addresses])
    assert (targets >= ALIGNED).all() and (targets < len(image.memory)).all() and (targets % ALIGNED == 0).all()


def test_what_several_structs_point_to_is_written_once(touching):
    """Interior elements share a law: it has one place."""
    image, at = Image.of(touching)
    chain = read(image, read(image, at, "fingerfem_touching").chain, "fingerfem_chain")
    (first,) = struct.unpack_from("<I", image.memory, chain.segments)
    segment = read(image, first, "fingerfem_segment")
    laws = struct.unpack_from(f"<{segment.laws}I", image.memory, segment.law)
    law_of = struct.unpack_from(f"<{segment.elements}i", image.memory, segment.law_of)
    assert segment.laws == 3 and len(set(laws)) == 3 and len(law_of) == 5 and set(law_of) == {0, 1, 2}
    own = touching.chain.segments[0]
    for k, place in enumerate(laws):
        law, expected = read(image, place, "fingerfem_law"), own.law[k]
        assert (law.groups, law.monomials, law.most_power) == (expected.groups, expected.monomials, expected.most_power)
        found = np.frombuffer(image.memory, np.float64, 6, law.upper)
        assert found.tolist() == list(expected.upper[0:6])


def test_a_struct_that_two_pointers_have_lies_in_memory_once():
    one, other = (LIBRARY.struct("fingerfem_object", **CUBE.numbers()) for _ in range(2))
    twice, both = (Image.of(LIBRARY.pointers("fingerfem_object", pair)) for pair in ([one, one], [one, other]))
    places = [struct.unpack_from("<2I", image.memory, at) for image, at in (twice, both)]
    assert places[0][0] == places[0][1] and places[1][0] != places[1][1]
    sizes = [len(image.memory) - ALIGNED - 8 for image, _ in (twice, both)]
    assert sizes[1] == pytest.approx(2 * sizes[0], abs=ALIGNED)


def test_a_pointer_to_nothing_stays_zero_and_is_no_address():
    plane = LIBRARY.struct("fingerfem_object", **rom.load().obstacle.numbers())
    image, at = Image.of(plane)
    found = read(image, at, "fingerfem_object")
    assert not image.addresses and found.vertices == found.ends == 0 and list(owners(plane)) == [address(plane)]
    assert list(found.axis) == [0.0, -1.0, 0.0]
