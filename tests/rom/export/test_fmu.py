"""FMUs: FMPy finds nothing to complain of, and what they answer is what Python answers."""

import re
import shutil
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from itertools import product
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest

import rom
from rom.export.fmu import write
from rom.export.numbers import literal
from rom.files.checked_file import ModelError

fmpy = pytest.importorskip("fmpy", reason="needs FMPy (make test installs it)")
from fmpy.fmi1 import FMICallException  # noqa: E402
from fmpy.simulation import simulate_fmu  # noqa: E402
from fmpy.validation import validate_fmu  # noqa: E402
from fmus import BOTH, COMPILER, Driven, driven  # noqa: E402
from sampled import some_points  # noqa: E402
from terminal import ran  # noqa: E402

ROOT = Path(__file__).resolve().parents[3]
pytestmark = pytest.mark.skipif(COMPILER is None, reason="needs a C compiler")
QUANTITIES = "tip", "contact_force", "touch_distance"
OUTPUTS = ["tip_x", "tip_y", "tip_z", "contact_force", "touch_distance", *(f"{name}_error" for name in QUANTITIES)]
LARGEST = sys.float_info.max
OLDEST = 2, 31  # glibc of Debian 11
EACH = pytest.mark.parametrize("name", ["rod", "table"])
ROWS = [*(f"orientation_{axis}" for axis in "wxyz"), "shortening_F1", "shortening_F2"]


def inner_points(model, count: int) -> np.ndarray:
    """Points with an answer inside, half of them in contact."""
    random, (lower, upper) = np.random.default_rng(1), model.limits
    points = lower + (upper - lower) * (0.05 + 0.9 * random.random((20 * count, len(lower))))
    found = model.evaluate(points)
    touching = found.inside & (found.contact_force > 0.1)
    apart = found.inside & (points[:, -1] > found.touch_distance + 1e-3)
    return np.vstack([points[touching][: count // 2], points[apart][: count // 2]])


CHOSEN = [("rod", 3, True), ("table", 2, False)]
OTHERS = [one for one in product(["rod", "table"], [2, 3], [False, True]) if one not in CHOSEN]


@pytest.mark.parametrize(
    ("name", "version", "controller"),
    [
        *CHOSEN,
        *(pytest.param(*one, marks=pytest.mark.long) for one in OTHERS),
    ],
)
def test_fmpy_finds_nothing_to_complain_of(made, name, version, controller):
    fmu = made(name, version, controller)
    assert validate_fmu(str(fmu.path)) == []
    assert fmu.about.fmiVersion == f"{version}.0"
    units = {one.name: one.unit for one in fmu.about.modelVariables if one.unit}
    assert units["d"] == "m" and units["F1"] == units["contact_force"] == "N"


COUNTS = {"rod": 300, "table": 2000, "two_segments": 100}


@BOTH
@pytest.mark.parametrize(
    "name", ["table", *(pytest.param(one, marks=pytest.mark.long) for one in ("rod", "two_segments"))]
)
def test_its_numbers_are_python_s_also_outside(models, made, name, version):
    model, count = models[name], COUNTS[name]
    points = some_points(model, count)
    expected = model.evaluate(points)
    with driven(made(name, version)) as fmu:
        found = np.array([[*fmu.ask(point, *OUTPUTS), fmu.flag("inside"), fmu.status] for point in points])
    want = np.column_stack([expected.tip, expected.contact_force, expected.touch_distance])
    errors = np.column_stack([expected.error[quantity] for quantity in QUANTITIES])
    assert np.isfinite(found).all()
    assert np.array_equal(found[:, 8].astype(bool), expected.inside)
    assert np.array_equal(found[:, 9] == 0, expected.inside) and set(found[:, 9]) <= {0, 1, 2}
    known = np.isfinite(errors).all(axis=1)  # elsewhere what is left is where the solve gave up
    assert np.array_equal(known, found[:, 9] != 1)
    assert (found[~known, 5:7] == LARGEST).all()
    rounding = np.array([1e-11, 1e-11, 1e-11, 3e-9, 1e-11])  # m, N: it is compiled for any processor
    assert (np.abs(found[:, :5] - want)[known].max(axis=0) < rounding).all()
    assert (np.abs(found[:, 5:8] - errors)[known].max(axis=0) < rounding[2:]).all()
    assert known.sum() > 0.85 * count and (known & ~expected.inside).sum() > 0.1 * count


@BOTH
@EACH
def test_derivatives_are_python_s_and_those_of_differences(models, made, name, version):
    model, names = models[name], OUTPUTS[:5]
    lower, upper = model.limits
    random, off = np.random.default_rng(2), []
    with driven(made(name, version)) as fmu:
        for point in inner_points(model, 60):
            seed = random.normal(size=len(lower)) * (upper - lower)
            fmu.ask(point, "tip_x")
            found, known = np.array(fmu.derivatives(names, seed)), model.jacobian(point)[:5] @ seed
            sizes = np.maximum(np.abs(known), [1e-3, 1e-3, 1e-3, 1e-1, 1e-3])
            assert np.abs((found - known) / sizes).max() < 1e-9
            ahead, behind = (np.array(fmu.ask(point + share * seed, *names)) for share in (1e-5, -1e-5))
            off.append(np.abs(((ahead - behind) / 2e-5 - found) / sizes).max())
        assert np.median(off) < 1e-5 and max(off) < 2e-3  # the rod's own are as good as that


@BOTH
@pytest.mark.parametrize("name", ["rod", pytest.param("two_segments", marks=pytest.mark.long)])
def test_it_reports_orientation_and_shortenings_with_derivatives_and_errors(models, made, name, version):
    model, random = models[name], np.random.default_rng(3)
    errors = ["orientation_error", "shortening_error"]
    with driven(made(name, version)) as fmu:
        for point in inner_points(model, 40):
            seed, report = random.normal(size=3) * [1.0, 1.0, 1e-3], model.report(point)
            found, slopes = fmu.ask(point, *ROWS, *errors), fmu.derivatives(ROWS, seed)
            assert found[:4] == pytest.approx(report.orientation, abs=1e-9)
            assert found[4:6] == pytest.approx(report.shortenings, abs=1e-11)
            assert found[6:] == pytest.approx([report.orientation_error, report.shortening_error])
            expected = np.concatenate([report.orientation_jacobian @ seed, report.shortening_jacobian @ seed])
            assert slopes[:4] == pytest.approx(expected[:4], abs=1e-7)
            assert slopes[4:] == pytest.approx(expected[4:], abs=1e-9)
        lost = points_without_equilibrium(model)
        for point in lost:
            assert fmu.ask(point, *errors) == [LARGEST, LARGEST]
    assert len(lost) or name != "two_segments"


def points_without_equilibrium(model) -> np.ndarray:
    """Among some points."""
    points = some_points(model, 1000)
    return points[~np.isfinite(model.evaluate(points).error["tip"])]


@BOTH
def test_a_table_does_not_declare_what_it_does_not_report(made, version):
    names = {one.name for one in made("table", version).about.modelVariables}
    assert "tip_x" in names and not names & set(ROWS)


@BOTH
def test_where_a_derivative_is_asked_for_of_nothing_it_is_refused(made, version):
    with driven(made("rod", version)) as fmu:
        errors = [fmu.references[name] for name in OUTPUTS[5:8]]  # discrete: they jump
        for unknowns, knowns in (([1], fmu.inputs), ([101], [101]), ([999], [1]), ([101], [0]), (errors, fmu.inputs)):
            with pytest.raises(FMICallException):
                fmu.own.getDirectionalDerivative(unknowns, knowns, [1.0] * len(knowns))


@BOTH
@pytest.mark.parametrize("controller", [False, pytest.param(True, marks=pytest.mark.long)])
def test_the_library_runs_with_the_c_library_of_debian_11(made, version, controller):
    library = made("rod", version, controller).library.read_bytes()
    needed = {tuple(map(int, one)) for one in re.findall(rb"GLIBC_(\d+)\.(\d+)", library)}
    assert needed and max(needed) <= OLDEST and b"GLIBC_PRIVATE" not in library


@BOTH
def test_instances_do_not_disturb_each_other(made, version):
    model = rom.load()
    points = inner_points(model, 400)
    expected = model.evaluate(points).contact_force
    with driven(made("rod", version)) as one, driven(made("rod", version)) as other:
        one.ask(points[0], "tip_x")
        other.ask(points[1], "tip_x")
        assert one.numbers("contact_force") == pytest.approx([expected[0]], abs=1e-12)
        assert other.numbers("contact_force") == pytest.approx([expected[1]], abs=1e-12)

        def force(fmu: Driven) -> list[float]:
            return [fmu.ask(point, "contact_force")[0] for point in points]

        with ThreadPoolExecutor(2) as pool:  # at the same time: Python lets go while C answers
            for found in pool.map(force, [one, other]):
                assert np.abs(found - expected).max() < 1e-12


@BOTH
@EACH
def test_it_follows_an_input_in_a_simulation(models, made, name, version):
    fmu, model = made(name, version), models[name]
    names = model.names
    signal = np.array(
        [(0.0, 10.0, 5.0, 0.03), (1.0, 60.0, 20.0, 0.005)], dtype=[(one, float) for one in ("time", *names)]
    )
    found = simulate_fmu(
        str(fmu.path), input=signal, stop_time=1.0, output_interval=0.05, output=[*names, *OUTPUTS, "inside"]
    )
    expected = model.evaluate(np.column_stack([found[one] for one in names]))
    assert (
        len(found) == 21 and found["contact_force"][-1] > 1.0 and found["F1"][-1] == pytest.approx(57.5)
    )  # of its last step
    assert np.abs(found["contact_force"] - expected.contact_force).max() < 1e-12
    assert np.array_equal(found["inside"].astype(bool), expected.inside)


@BOTH
@pytest.mark.skipif(shutil.which("readelf") is None or shutil.which("nm") is None, reason="needs binutils")
@pytest.mark.parametrize("controller", [False, True])
def test_the_library_needs_no_other_and_shows_nothing_but_the_standard(made, version, controller):
    fmu = made("rod", version, controller)
    needed = subprocess.run(["readelf", "-d", fmu.library], capture_output=True, text=True, check=True).stdout
    assert set(re.findall(r"NEEDED.*\[(\w+)", needed)) <= {"libc", "libm"}
    shown = subprocess.run(["nm", "-D", "--defined-only", fmu.library], capture_output=True, text=True, check=True)
    names = {line.split()[-1] for line in shown.stdout.splitlines()}
    standard = (Path(fmpy.__file__).parent / "c-code" / f"fmi{version}Functions.h").read_text()
    declared = set(re.findall(rf"(fmi{version}\w+)TYPE\s+fmi", standard))
    assert len(declared) > 30 and names <= declared
    of_model_exchange = {"fmi2EnterEventMode", "fmi2NewDiscreteStates", "fmi2EnterContinuousTimeMode"}
    of_model_exchange |= {"fmi2CompletedIntegratorStep", "fmi2SetTime", "fmi2SetContinuousStates", "fmi2GetDerivatives"}
    of_model_exchange |= {"fmi2GetEventIndicators", "fmi2GetContinuousStates", "fmi2GetNominalsOfContinuousStates"}
    assert declared - names == (of_model_exchange if version == 2 else set())


@BOTH
@pytest.mark.parametrize("controller", [False, pytest.param(True, marks=pytest.mark.long)])
def test_its_sources_make_the_library_on_their_own(made, tmp_path, version, controller):
    fmu = made("table", version, controller)
    sources = fmu.folder / "sources"
    if version == 3:
        root = ElementTree.parse(sources / "buildDescription.xml").getroot()
        assert root.find("BuildConfiguration").get("modelIdentifier") == fmu.about.coSimulation.modelIdentifier
        units = [one.get("name") for one in root.iter("SourceFile")]
    else:
        described = ElementTree.parse(fmu.folder / "modelDescription.xml").getroot()
        units = [one.get("name") for one in described.iterfind("CoSimulation/SourceFiles/File")]
        assert len(units) > 10
    strict = ["-std=c99", "-O0", "-Wall", "-Werror", "-Wno-psabi", "-shared", "-fPIC"]
    line = [COMPILER, *strict, "-o", str(tmp_path / "own.so"), *units, "-lm"]
    done = subprocess.run(line, cwd=sources, capture_output=True, text=True)
    assert done.returncode == 0 and done.stderr == ""


@pytest.mark.long
def test_the_same_model_makes_the_same_file(table, made, tmp_path):
    again = tmp_path / "table3.fmu"
    write(table, again)
    assert again.read_bytes() == made("table", 3).path.read_bytes()


@BOTH
def test_steps_that_are_none_are_refused(made, version):
    with driven(made("table", version)) as fmu:
        for time, size in ((0.0, 0.0), (0.0, -0.1), (0.0, np.nan), (np.inf, 0.1), (0.0, np.inf), (0.95, 0.1)):
            with pytest.raises(FMICallException, match="error"):
                fmu.step(time, size)
        fmu.step(0.0, 0.1)
        fmu.step(0.1, 0.9 + 1e-12)
    early = Driven(made("table", version))
    with pytest.raises(FMICallException, match="error"):
        early.step(0.0, 0.1)
    early.own.freeInstance()


@BOTH
def test_another_s_token_and_variables_that_are_none_are_refused(made, version):
    with pytest.raises(Exception, match="instantiate"):
        Driven(made("rod", version), token="{another}")
    with driven(made("rod", version)) as fmu:
        for references in ([101], [0], [50], [999]):
            with pytest.raises(FMICallException, match="error"):
                fmu.set_numbers(references, [1.0])
        for get in (fmu.own.getBoolean, fmu.own.getInteger if version == 2 else fmu.own.getInt64, fmu.own.getString):
            with pytest.raises(FMICallException, match="error"):
                get([101])


@BOTH
def test_reset_and_start_values_begin_anew(made, version):
    model = rom.load()
    with driven(made("rod", version), F1=40.0, d=0.01) as fmu:
        assert fmu.numbers("contact_force") == [pytest.approx(float(model.evaluate([40.0, 0.0, 0.01]).contact_force))]
        fmu.own.reset()
        assert fmu.numbers("F1", "F2", "d", "contact_force") == [0.0, 0.0, model.limits[1][-1], 0.0]
        fmu.begin()


@BOTH
@EACH
def test_the_controller_holds_forces(models, made, name, version):
    model, random, converged = models[name], np.random.default_rng(1), 0
    lower, upper = model.limits
    with driven(made(name, version, controller=True)) as fmu:
        for force, share in zip(random.uniform(0.1, 4.0, 200), random.uniform(0.1, 0.5, 200), strict=True):
            d = lower[-1] + share * min(upper[-1] - lower[-1], 0.04)
            *tensions, residual, error = fmu.ask([force, d], "F1", "F2", "residual", "contact_force_error")
            assert np.isfinite([*tensions, residual, error]).all()
            assert (tensions >= lower[:-1]).all() and (tensions <= upper[:-1]).all()
            assert fmu.flag("converged") == (fmu.status == 1)
            if fmu.status != 1:
                continue
            answer = model.evaluate([*tensions, d])
            assert answer.inside and answer.contact_force == pytest.approx(force, abs=1e-5)
            assert residual < 1e-5 and error == pytest.approx(answer.error["contact_force"], rel=1e-3, abs=1e-6)
            converged += 1
    assert converged > 190


@BOTH
def test_the_controller_says_what_it_cannot_hold(made, version):
    model = rom.load()
    with driven(made("rod", version, controller=True), start_F1=20.0, start_F2=5.0) as fmu:
        assert fmu.ask([np.nan, 0.01], "F1", "F2") == [20.0, 5.0] and fmu.status == 4
        held = fmu.ask([2.0, 0.01], "F1", "F2")
        fmu.step(0.0, 0.1)
        for force, d in (
            (np.nan, 0.01),
            (2.0, np.nan),
            (np.inf, 0.01),
            (-1.0, 0.01),
            (0.0, 0.01),
            (2.0, -1.0),
            (2.0, np.inf),
        ):
            assert fmu.ask([force, d], "F1", "F2", "residual", "contact_force_error") == [*held, LARGEST, LARGEST]
            assert fmu.status == 4 and not fmu.flag("converged")
        *tensions, missed = fmu.ask([500.0, 0.01], "F1", "F2", "residual")
        assert fmu.status == 2 and not fmu.flag("converged")
        assert missed == pytest.approx(500.0 - model.evaluate([*tensions, 0.01]).contact_force)
        assert fmu.ask([2.0, 0.01], "F1", "F2") == pytest.approx(held, abs=1e-3)  # and goes on from where it was


@BOTH
def test_the_controller_follows_a_moving_plane_in_a_simulation(made, version):
    model = rom.load()
    time = np.linspace(0.0, 1.0, 101)
    signal = np.array(
        list(zip(time, np.full(101, 2.0), 0.012 + 0.006 * np.sin(6.0 * time), strict=True)),
        dtype=[("time", float), ("contact_force", float), ("d", float)],
    )
    found = simulate_fmu(
        str(made("rod", version, controller=True).path),
        input=signal,
        stop_time=1.0,
        output_interval=0.01,
        start_values={"start_F1": 30.0},
        output=["contact_force", "d", "F1", "F2", "converged"],
    )
    assert found["converged"].all() and np.ptp(found["d"]) > 0.01
    points = np.column_stack([found["F1"], found["F2"], found["d"]])
    assert np.abs(model.evaluate(points).contact_force - 2.0).max() < 1e-5
    assert np.abs(np.diff(points, axis=0)).max() < 3.0  # of many answers the nearest


@pytest.mark.parametrize(
    ("value", "kind", "text"),
    [
        (0.1, "double", "0.1"),
        (np.inf, "double", "INFINITY"),
        (-np.inf, "float", "-INFINITY"),
        (np.nan, "double", "NAN"),
        (3, "int32_t", "3"),
        (2**63, "uint64_t", f"{2**63}ULL"),
        (float(np.float32(0.1)), "float", "0.10000000149011612f"),
    ],
)
def test_numbers_of_c_are_exact(value, kind, text):
    assert literal(value, kind) == text


def test_what_cannot_be_written_is_refused_in_one_line(tmp_path, monkeypatch):
    model = rom.load()
    with pytest.raises(ModelError, match="fmi must be 2 or 3, got 4"):
        write(model, tmp_path / "finger.fmu", 4)
    for name in ("my finger.fmu", "2.fmu", "finger.zip"):
        with pytest.raises(ModelError, match="C identifier, got"):
            write(model, tmp_path / name)
    monkeypatch.setenv("CC", "no-such-compiler")
    with pytest.raises(ModelError, match="got no-such-compiler"):
        write(model, tmp_path / "finger.fmu")
    monkeypatch.setenv("CC", "false")
    with pytest.raises(ModelError, match="exit code 1"):
        write(model, tmp_path / "finger.fmu")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.long
def test_the_command_writes_one_and_refuses_the_rest(table_file, tmp_path):
    file = tmp_path / "finger.fmu"
    done = ran("rom", "export", "rom/finger.h5", str(file), "--fmi", "2")
    assert done.returncode == 0 and "FMI 2.0" in done.stderr + done.stdout
    assert fmpy.read_model_description(file).coSimulation.modelIdentifier == "finger"
    for arguments, said in (
        (["rom/finger.h5", str(file), "--fmi", "1"], "fmi must be 2 or 3, got 1"),
        ([str(table_file), str(tmp_path / "finger.h"), "--fmi", "2"], ".fmu"),
        ([str(table_file), str(tmp_path / "nowhere" / "finger.fmu")], "folder"),
    ):
        refused = ran("rom", "export", *arguments)
        assert refused.returncode == 2 and said in refused.stderr and len(refused.stderr.splitlines()) == 1
