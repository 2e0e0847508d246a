"""Setting of lines: their first states, and those taken from other sets."""

from types import SimpleNamespace

import numpy as np
import pytest

from fingerfem.equilibrium.failures import NotConverged
from fingerfem.snapshots.lines.setting import NOTHING_KNOWN, SAME_PLACE, Known, Setting
from rom.dataset.snapshot_set import write_task

FIELD = np.arange(12.0).reshape(4, 3)


class Followed:
    """A continuation that notes where it is begun."""

    def __init__(self):
        self.begun = []

    def start(self, tensions, distance, displacement):
        self.begun.append((list(tensions), distance, displacement.tolist()))

    def rest(self):
        self.begun.append("rest")


def setting(path, known=NOTHING_KNOWN, has_field=True, has_obstacle=True, lead=0) -> Setting:
    description = SimpleNamespace(
        parameters=[{"lower": 0.0}, {"lower": 0.0}, {"lower": 0.004}],
        has_obstacle=has_obstacle,
        has_field=has_field,
        lead=lead,
    )
    scene = SimpleNamespace(geometry=SimpleNamespace(side=0.02))
    model = SimpleNamespace(continuation=Followed(), scene=scene)
    order = SimpleNamespace(scatter=lambda field: field.ravel()[::-1])
    plan = SimpleNamespace(lines={}, refresh=lambda: plan.lines.update(new="its line"))
    return Setting(description=description, model=model, path=path, numbering=order, plan=plan, known=known)


def test_the_nearest_plane_and_the_shortest_path_are_those_of_the_scene(tmp_path):
    one = setting(tmp_path)
    assert one.nearest == 0.004 and one.shortest_path == SAME_PLACE * 0.02
    assert np.isnan(setting(tmp_path, has_obstacle=False).nearest)
    assert one.line("new") == "its line"  # of a plan that another rank has extended
    with pytest.raises(KeyError):
        one.line("none")


def test_a_free_line_begins_at_the_last_state_that_converged_before_its_lead(tmp_path):
    leads = [0.0, 10.0, 20.0, 30.0]
    arrays = {
        "parameters": np.array([[lead, 5.0, np.nan] for lead in leads]),
        "converged": np.array([True, True, False, True]),
        "displacement": FIELD[:, None],
    }
    (tmp_path / "tasks").mkdir()
    write_task(tmp_path, "free-3", "f", arrays)
    for tension, expected in ((10.0, 1), (25.0, 1), (30.0, 3), (99.0, 3), (4.0, 0)):
        one = setting(tmp_path)
        one.start_free(3, np.array([tension, 5.0]))
        (begun,) = one.model.continuation.begun
        assert begun == ([leads[expected], 5.0], None, FIELD[expected][::-1].tolist())


def test_without_a_known_state_before_or_a_field_a_line_begins_at_rest(tmp_path):
    (tmp_path / "tasks").mkdir()
    arrays = {"parameters": np.array([[5.0, 0.0, np.nan]]), "converged": np.array([True])}
    write_task(tmp_path, "free-0", "f", arrays | {"displacement": FIELD[:1, None]})
    before, bare = setting(tmp_path), setting(tmp_path, has_field=False)
    before.start_free(0, np.array([4.9, 0.0]))
    bare.start_free(0, np.array([6.0, 0.0]))
    assert before.model.continuation.begun == bare.model.continuation.begun == ["rest"]


@pytest.mark.parametrize("distance", [0.012, np.nan])
def test_a_state_that_is_taken_is_noted_and_the_model_is_brought_there(tmp_path, distance):
    record = SimpleNamespace(noted=[], restarts=0)
    record.take = lambda row, field: record.noted.append(field)
    record.restarted = lambda: setattr(record, "restarts", record.restarts + 1)
    row = {"displacement": FIELD, "parameters": np.array([7.0, 3.0, distance])}
    one, bare = setting(tmp_path), setting(tmp_path, has_field=False)
    one.take(record, row)
    expected = ([7.0, 3.0], None if np.isnan(distance) else distance, FIELD.ravel()[::-1].tolist())
    assert one.model.continuation.begun == [expected] and record.restarts == 1
    bare.take(record, row)
    assert bare.model.continuation.begun == [] and record.restarts == 1 and record.noted[1] is None


def test_a_line_begins_near_a_known_state_only_where_that_is_an_equilibrium(tmp_path):
    def raises(error):
        def begin(*_, **__):
            if error is not None:
                raise error

        return Known(near=SimpleNamespace(begin=begin))

    failures = [None, NotConverged("it does not")]
    found = [setting(tmp_path, raises(one)).begin_near(np.zeros(2)) for one in failures]
    assert found == [True, False] and not setting(tmp_path).begin_near(np.zeros(2))
    with pytest.raises(ZeroDivisionError):
        setting(tmp_path, raises(ZeroDivisionError())).begin_near(np.zeros(2))
    assert setting(tmp_path).given("a line") == {}
    donor = SimpleNamespace(states=lambda line: {2: line})
    assert setting(tmp_path, Known(donor=donor)).given("a line") == {2: "a line"}
