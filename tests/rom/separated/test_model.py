"""A separated model of a finger's samples, and one of full-order states."""

from dataclasses import replace

import numpy as np
import pytest

from rom.files.checked_file import ModelError

FREE, TOUCHING = [10.0, 30.0, 0.025], [52.5, 25.0, 0.0121]
KINDS = ("table", "grid_model")


@pytest.fixture(params=KINDS)
def model(request):
    """A table of the bundled finger, and one of full-order states, with the pad's pressure and the displacement."""
    return request.getfixturevalue(request.param)


@pytest.mark.parametrize("point", [FREE, TOUCHING, [30.0, 20.0, 0.0111], [41.0, 5.0, 0.0107]], ids=str)
def test_the_jacobian_is_a_difference(model, point):
    jacobian = model.jacobian(point)
    for j, h in enumerate((1e-4, 1e-4, 1e-8)):
        step = h * np.eye(3)[j]
        slope = (model.outputs(np.array([point + step])) - model.outputs(np.array([point - step])))[0] / (2 * h)
        assert jacobian[:, j] == pytest.approx(slope, rel=1e-4, abs=1e-5 * np.abs(slope).max() + 1e-9)


def test_everything_is_continuous_at_touch(model):
    touch = float(model.evaluate(FREE).touch_distance)
    before, after = (model.evaluate([*FREE[:2], touch + gap]) for gap in (1e-9, -1e-9))
    assert before.contact_force == 0.0 and 0.0 <= after.contact_force < 1e-4
    assert before.tip == pytest.approx(after.tip, abs=1e-8)


def test_many_points_at_once_are_the_same_points_one_by_one(model):
    points = np.array([FREE, TOUCHING, [0.0, 0.0, 0.031]])
    together = model.evaluate(points)
    for k, point in enumerate(points):
        alone = model.evaluate(point)
        assert np.array_equal(together.tip[k], alone.tip) and together.contact_force[k] == alone.contact_force
        assert together.error["contact_force"][k] == alone.error["contact_force"]
        assert model.value_and_jacobian(point)[0] == pytest.approx(model.outputs(points)[k], rel=1e-12, abs=1e-15)


@pytest.mark.parametrize(
    ("point", "inside"),
    [
        ([0.0, 0.0, "lower"], True),
        ([100.0, 100.0, "upper"], True),
        ([20.0, 0.0, np.inf], True),  # no object
        ([20.0, 0.0, 10.0], False),  # not touched, and outside the range of d
        ([20.0, 0.0, 0.0311], False),
        ([-1e-6, 0.0, 0.02], False),
        ([100.1, 0.0, 0.02], False),
        ([50.0, 0.0, 0.0009], False),
        ([50.0, 0.0, -1.0], False),
        ([np.nan, 0.0, 0.01], False),
        ([50.0, 0.0, np.nan], False),
        ([1e300, 0.0, 0.01], False),
    ],
)
def test_points_outside_are_marked_and_answered_from_the_nearest_inside(model, point, inside):
    ends = dict(zip(("lower", "upper"), (float(end[-1]) for end in model.limits), strict=True))
    point = [*point[:2], ends.get(point[2], point[2]) if isinstance(point[2], str) else point[2]]
    answer = model.evaluate(point)
    assert bool(answer.inside) is inside
    assert np.isfinite(answer.tip).all() and np.isfinite(answer.contact_force) and answer.contact_force >= 0
    if model.nodes is not None:
        assert np.isfinite(model.displacement(point)).all()


def test_a_force_that_is_exactly_zero_has_no_error(model):
    answer = model.evaluate([FREE, TOUCHING])
    assert answer.contact_force[0] == answer.error["contact_force"][0] == 0.0
    assert answer.error["contact_force"][1] > 0


@pytest.mark.parametrize("point", [[1.0, 2.0], [1.0, 2.0, 3.0, 4.0], [], [[[1.0, 2.0, 0.01]]]], ids=str)
def test_the_wrong_number_of_parameters_is_refused(table, point):
    for ask in (table.evaluate, table.jacobian):
        with pytest.raises(ModelError, match="parameters must be F1, F2, d"):
            ask(point)


@pytest.mark.parametrize("point", ["finger", {"F1": 1.0}, [1.0, None, "wide"], [[1.0], [2.0, 3.0]]], ids=str)
def test_what_is_no_number_is_refused_with_its_value(table, point):
    for ask in (table.evaluate, table.jacobian, table.value_and_jacobian):
        with pytest.raises(ModelError, match="parameters must be numbers, one for each of F1, F2, d, got ") as refusal:
            ask(point)
        assert repr(point) in str(refusal.value) and "\n" not in str(refusal.value)


def test_a_tolerance_keeps_fewer_terms_logs_them_and_enlarges_the_estimates(model, tmp_path, caplog):
    model.save(tmp_path / "model.h5")
    with caplog.at_level("INFO"):
        loose = type(model).load(tmp_path / "model.h5", tolerance=0.1)
    assert f"contact {loose.terms['contact']} of {model.terms['contact']}" in caplog.text
    assert loose.terms["contact"] < model.terms["contact"] and loose.accuracy == {}
    points = np.random.default_rng(3).random((500, 3)) * [100, 100, 0.02] + [0, 0, 0.011]
    whole, fewer = model.evaluate(points), loose.evaluate(points)
    pressed = (whole.contact_force > 0.1) & np.isfinite(whole.error["contact_force"])
    assert fewer.error["contact_force"][pressed].mean() > whole.error["contact_force"][pressed].mean()
    with pytest.raises(ModelError, match="tolerance must be"):
        type(model).load(tmp_path / "model.h5", tolerance=-1.0)


def test_without_the_displacement_it_is_refused_by_the_key_that_stores_it(table):
    with pytest.raises(ModelError, match=r"displacement must be in the scene's sampling\.store"):
        table.displacement(FREE)


def test_the_displacement_of_the_plate_is_the_tip_s_and_the_clamp_stays(grid_model):
    nodes = grid_model.nodes
    plate = nodes[:, 0] >= 0.049 - 1e-6
    for point in (FREE, TOUCHING):
        moved = grid_model.displacement(point)
        assert moved[plate].mean(axis=0) == pytest.approx(grid_model.evaluate(point).tip, abs=1e-3)
        assert np.abs(moved[nodes[:, 0] < 1e-9]).max() < 1e-6


def test_a_plane_out_of_reach_does_not_change_the_displacement(grid_model):
    free = grid_model.displacement([100.0, 0.0, np.inf])
    touch = float(grid_model.evaluate([100.0, 0.0, np.inf]).touch_distance)
    lowered = replace(
        grid_model, parameters=[*grid_model.parameters[:2], grid_model.parameters[2]._replace(upper=0.02)]
    )
    for one, distance in ((grid_model, touch), (grid_model, 1.0), (lowered, touch), (lowered, np.inf)):
        assert np.array_equal(one.displacement([100.0, 0.0, distance]), free)
    assert not np.array_equal(lowered.displacement([100.0, 0.0, 0.015]), free)


def test_the_pad_s_pressure_is_an_output_with_its_error(grid_model):
    assert grid_model.has_pad and grid_model.outputs(np.array([TOUCHING])).shape == (1, 6)
    answer = grid_model.evaluate([[90.0, 0.0, 0.02], FREE])
    assert answer.pad_pressure[0] > 0 and answer.pad_pressure[1] == 0
    assert answer.error["pad_pressure"][0] > 0 and answer.error["pad_pressure"][1] == 0
