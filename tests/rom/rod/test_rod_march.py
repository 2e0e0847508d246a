"""A compiled rod of elements: that of NumPy, in chains and contact, its inverse, and what is refused."""

from dataclasses import replace

import numpy as np
import pytest

from rom.files.checked_file import ModelError
from rom.native import LIBRARY
from rom.rod import compiled as native
from rom.rod import limits
from rom.rod.compiled.touched import touches
from rom.rod.objects.shapes import Plane
from tests.rom.elements import laws

HALF = np.array([0.0005, laws.SIDE / 2, laws.SIDE / 2])
CORNERS = HALF * np.array([[x, y, z] for z in (-1, 1) for y in (-1, 1) for x in (-1, 1)])


def segment(elements, **more) -> native.CondensedSegment:
    return native.CondensedSegment(elements=laws.as_maps(elements), half_lengths=HALF, **more)


def compiled(elements, **more):
    return native.struct(segment(elements, **more))


def placed(elements, tensions, wrenches):
    """Centres, rotations and motions of the plate by NumPy, and whether all is inside."""
    found = laws.marched(elements, tensions, wrenches)
    rotations = found.rotation.transpose(0, 2, 1)
    centres = -np.einsum("nij,nj->ni", rotations, found.place)
    return list(zip(centres, rotations, found.motion, found.inside.all(axis=1), strict=True))


def same(elements, tensions, wrenches) -> None:
    """Asserts that compiled poses, motions and marks are NumPy's."""
    own = compiled(elements)
    for pulled, wrench, (centre, rotation, motion, inside) in zip(
        tensions, wrenches, placed(elements, tensions, wrenches), strict=True
    ):
        found = native.place(own, np.append(pulled, wrench))
        assert found[3] == inside
        for part, wanted in zip(found, (centre, rotation, motion), strict=False):
            assert part == pytest.approx(wanted, abs=1e-12 * max(1.0, np.abs(wanted).max()))


@pytest.mark.parametrize("tensions", range(1, 9))
def test_a_compiled_rod_is_that_of_numpy(tensions):
    plate, interior, clamp = (laws.law(tensions, seed, degree=3) for seed in range(3))
    pulled, wrenches = laws.inputs(tensions, 20, 5)
    same([plate, interior, interior, clamp], pulled, wrenches)
    same([clamp], pulled, wrenches)


def test_beyond_its_boxes_too():
    pulled, wrenches = laws.inputs(2, 40, 6, share=1.6)
    pulled = 1.5 * pulled - 0.25 * laws.MOST_TENSION
    elements = laws.finger()
    inside = laws.marched(elements, pulled, wrenches).inside
    assert inside.any(axis=0).all() and (~inside).any(axis=0).all()
    same(elements, pulled, wrenches)


def test_laws_of_any_products_in_any_order():
    """Some are missing, of which others are made; some stand twice; the highest power is 31."""
    random, whole = np.random.default_rng(7), laws.law(2, 0)
    kept = random.permutation(len(whole.powers))[:200]
    kept = np.append(kept, kept[:20])
    some = replace(whole, powers=whole.powers[kept], coefficients=whole.coefficients[kept])
    high = np.array([[0, 0, 0, 0, 0, 0, 0, 31], [31, 0, 0, 31, 0, 0, 0, 0], [1, 0, 31, 0, 0, 0, 31, 0]])
    steep = replace(whole, powers=high, coefficients=1e-3 * laws.SIZES * random.standard_normal((3, 6)))
    constant = replace(whole, powers=np.zeros((1, 8), int), coefficients=whole.coefficients[:1])
    for elements in ([some], [steep], [constant], [whole, some, steep, constant, some]):
        same(elements, *laws.inputs(2, 10, 8))


def test_a_shared_law_is_as_many_copies():
    plate, interior, *_, clamp = laws.finger()
    shared, copies = compiled(laws.finger()), compiled([plate, *(replace(interior) for _ in range(3)), clamp])
    assert (shared.laws, copies.laws, shared.elements, copies.elements) == (3, 5, 5, 5)
    for pulled, wrench in zip(*laws.inputs(2, 10, 9), strict=True):
        one, other = (native.place(own, np.append(pulled, wrench)) for own in (shared, copies))
        assert all(np.array_equal(*parts) for parts in zip(one, other, strict=True))


def chained(rods: list):
    """Rods of two tensions one after another as a chain."""
    errors = {name: 0.0 for name, _ in LIBRARY.ffi.typeof("fingerfem_chain").fields if "error" in name}
    rest = np.array([sum(len(one) for one in rods) * laws.LENGTH, 0.0, 0.0])
    own = np.tile([0, 1], (len(rods), 1))
    return native.chain_struct([compiled(one) for one in rods], own, rest, errors.pop("surface_error"), errors)


def test_two_rods_stand_one_on_the_other_and_carry_its_wrench():
    base, tip = laws.finger(), laws.finger()[1:]
    (pulled,), wrenches = laws.inputs(2, 1, 10)[0], laws.inputs(2, 2, 11, share=0.1)[1]
    centres, rotations, motions, inside = native.place_chain(chained([base, tip]), pulled, wrenches)
    ((second, turned, _, _),) = placed(tip, pulled[None], wrenches[1:])
    arm, force = second + np.array([HALF[0], 0, 0]), turned @ wrenches[1, :3]
    transmitted = wrenches[0] + [*force, *turned @ wrenches[1, 3:] + np.cross(arm, force)]
    ((centre, rotation, _, _),) = placed(base, pulled[None], transmitted[None])
    assert inside
    assert centres == pytest.approx(np.array([centre, centre + rotation @ arm]), abs=1e-14)
    assert rotations == pytest.approx(np.array([rotation, rotation @ turned]), abs=1e-14)
    ways = np.diag([*np.full(2, 1e-4), *np.tile(np.repeat([1e-5, 1e-7], 3), 2)])
    for k, way in enumerate(ways):
        after, before = (
            native.place_chain(chain, pulled + sign * way[:2], wrenches + sign * way[2:].reshape(2, 6))[0]
            for chain, sign in ((chained([base, tip]), 1), (chained([base, tip]), -1))
        )
        moves = np.einsum("pji,pj->pi", rotations, (after - before) / (2 * way[k]))
        assert motions[:, :3, k] == pytest.approx(moves, abs=1e-6 * np.abs(moves).max())


def before(chain, one):
    """A struct fingerfem_touching of a chain and one object."""
    return LIBRARY.struct(
        "fingerfem_touching", chain=chain, count=1, objects=LIBRARY.pointers("fingerfem_object", [one])
    )


def nine(element):
    return laws.law(9, 0, degree=1)


def other_box(element):
    return replace(element, upper=element.upper + np.eye(8)[0])


def as_quaternions(element):
    return replace(element, coefficients=np.pad(element.coefficients, [(0, 0), (0, 1)]))


def steep(element):
    return replace(element, powers=element.powers + 32 * (np.arange(8) == 3))


def uneven(element):
    return replace(element, lower=element.lower * [1.0, 1.0, 0.5, *np.ones(5)])


def endless(element):
    return replace(element, coefficients=element.coefficients * np.inf)


def scattered(element):
    """Products of force and moment that are all different: all of both go with each other."""
    powers = np.zeros((1500, 8), int)
    powers[:, 2], powers[:, 3], powers[:, 5], powers[:, 6] = (np.arange(1500) // 31**k % 31 for k in (0, 1, 0, 1))
    powers[:, 4] = powers[:, 7] = np.arange(1500) // 31**2
    return replace(element, powers=powers, coefficients=np.ones((1500, 6)))


REFUSED = {
    nine: "tensions must be from 1 to 8, got 9",
    as_quaternions: r"coefficients of powers of law 0 must have shape \(495, 6\), got \(495, 7\)",
    steep: "powers of law 0 must be from 0 to 31, got 0 to 36",
    uneven: "box must be as wide to both sides of no wrench",
    endless: "coefficients of powers of law 0 must be finite",
    scattered: "laws must have at most 1048576 products, all as the largest, padded, got ",
}


@pytest.mark.parametrize("change", REFUSED, ids=lambda change: change.__name__)
def test_a_law_beyond_what_compiled_code_holds_is_refused_by_name_and_limit(change):
    with pytest.raises(ModelError, match=REFUSED[change]):
        compiled([change(laws.law(2, 0))])


def test_a_rod_beyond_what_compiled_code_holds_is_refused_by_name_and_limit():
    element = laws.law(2, 0, degree=1)
    most = limits.MOST_ELEMENTS
    with pytest.raises(ModelError, match=f"elements must be from 1 to {most}, got {most + 1}"):
        compiled([element] * (most + 1))
    with pytest.raises(ModelError, match="tensions of all elements must have one box"):
        compiled([element, other_box(element)])
    with pytest.raises(ModelError, match="corners and the plate's element must have one box"):
        bent = replace(other_box(element), coefficients=np.zeros((9, 24)))
        compiled([element], corners=bent)
    same([element] * most, *laws.inputs(2, 2, 15, share=0.01))


def test_corners_bent_by_few_tensions_are_taken_by_their_monomials():
    """Without the product that is 1: their rows are not the first ones."""
    element = laws.law(2, 0)
    powers = np.pad(laws.total_degree(2, 2)[1:], [(0, 0), (0, 6)])
    off = 2e-6 * np.random.default_rng(1).standard_normal((len(powers), 24))
    powers, off = powers[powers.any(axis=1)], off[powers.any(axis=1)]
    corners = replace(element, powers=powers, coefficients=off)
    far = Plane(centre=(0.0, 0.01, 0.0), normal=(0.0, -1.0, 0.0), direction=(0.0, 1.0, 0.0), distances=(0.0, 1.0))
    errors = {name: 0.0 for name, _ in LIBRARY.ffi.typeof("fingerfem_chain").fields if "error" in name}
    chain = native.chain_struct(
        [compiled([element], corners=corners)], np.array([[0, 1]]), np.zeros(3), errors.pop("surface_error"), errors
    )
    own = before(chain, LIBRARY.struct("fingerfem_object", **far.numbers()))
    pull = np.array([7.0, 3.0])
    ((free, rotation, _, _),) = placed([element], pull[None], np.zeros((1, 6)))
    places = CORNERS + corners.value(np.append(pull, np.zeros(6))[None]).reshape(8, 3)
    highest = (free + places @ rotation.T)[:, 1].max()
    assert touches(own, np.array([[*pull, 0.9]])).out[0, 4] == pytest.approx(highest - 0.01, abs=1e-10)
