"""States of FMUs: they come back in any instance of the same FMU, and in no other; what is not declared is refused."""

import struct
from ctypes import c_double, c_void_p, create_string_buffer

import numpy as np
import pytest

fmpy = pytest.importorskip("fmpy", reason="needs FMPy (make test installs it)")
from fmpy.fmi1 import FMICallException  # noqa: E402
from fmus import BOTH, COMPILER, Driven, driven  # noqa: E402

pytestmark = pytest.mark.skipif(COMPILER is None, reason="needs a C compiler")
KINDS = pytest.mark.parametrize("controller", [False, True])
OUTPUTS = {
    False: ("tip_x", "tip_y", "contact_force", "touch_distance", "tip_error"),
    True: ("F1", "F2", "residual", "contact_force_error"),
}
POINTS = {False: [[20.0, 5.0, 0.012], [35.0, 0.0, 0.008]], True: [[1.0, 0.015], [3.0, 0.01]]}
VERSION = 16  # byte of the state's version in its serialised form; its kind and its token follow
TOKEN = 24


def began(fmu: Driven, controller: bool) -> None:
    fmu.ask(POINTS[controller][0], *OUTPUTS[controller])
    fmu.step(0.0, 0.1)


@BOTH
@KINDS
def test_a_state_that_was_kept_comes_back(made, version, controller):
    names, (_, second) = OUTPUTS[controller], POINTS[controller]
    with driven(made("rod", version, controller)) as fmu:
        began(fmu, controller)
        kept = fmu.own.getFMUState()
        packed = fmu.own.serializeFMUState(kept)
        first = fmu.ask(second, *names)
        fmu.step(0.1, 0.1)
        for state in (kept, fmu.own.deserializeFMUState(packed)):
            fmu.ask(POINTS[controller][0], *names)
            fmu.step(0.2, 0.1)
            fmu.own.setFMUState(state)
            assert fmu.ask(second, *names) == first
            fmu.own.freeFMUState(state)


@BOTH
@KINDS
def test_a_state_continues_in_a_new_instance_with_its_time_and_its_end(made, version, controller):
    names, (_, second) = OUTPUTS[controller], POINTS[controller]
    with driven(made("rod", version, controller)) as fmu:
        began(fmu, controller)
        packed = fmu.own.serializeFMUState(fmu.own.getFMUState())
        expected = fmu.ask(second, *names)
    new = Driven(made("rod", version, controller))
    new.own.setFMUState(new.own.deserializeFMUState(packed))
    assert new.ask(second, *names) == expected
    with pytest.raises(FMICallException):
        new.step(0.95, 0.1)  # the stop time was 1 s
    new.step(0.1, 0.1)
    new.own.terminate()
    new.own.freeInstance()


def refused(fmu: Driven, packed: bytes, reason: str, capsys) -> None:
    """Bytes are refused with a reason, and change nothing."""
    before = fmu.own.serializeFMUState(fmu.own.getFMUState())
    capsys.readouterr()
    with pytest.raises(FMICallException):
        fmu.own.deserializeFMUState(packed)
    assert reason in capsys.readouterr().out
    assert fmu.own.serializeFMUState(fmu.own.getFMUState()) == before


@BOTH
@KINDS
def test_bytes_that_are_no_state_are_refused(made, version, controller, capsys):
    random = np.random.default_rng(0)
    with driven(made("rod", version, controller), logs=True) as fmu:
        began(fmu, controller)
        packed = fmu.own.serializeFMUState(fmu.own.getFMUState())
        for _ in range(20):
            refused(fmu, random.bytes(len(packed)), "one of fingerfem", capsys)
        for wrong in (b"", packed[:-1], packed + b"\0"):
            refused(fmu, wrong, "its own size", capsys)
        for at in random.choice(np.arange(TOKEN + 40, len(packed)), 40, replace=False):
            changed = bytearray(packed)
            changed[at] ^= 1 << int(random.integers(8))
            refused(fmu, bytes(changed), "its hash differs", capsys)
        for other in (1, 3):
            changed = packed[:VERSION] + struct.pack("i", other) + packed[VERSION + 4 :]
            refused(fmu, changed, "this version of the format", capsys)
        fmu.own.deserializeFMUState(packed)


@pytest.mark.long
@BOTH
def test_states_of_other_fmus_are_refused(made, version, capsys):
    others = {
        ("rod", version, True): "the same kind",
        ("table", version, False): "model hash or version of FMI",
        ("rod", 5 - version, False): "model hash or version of FMI",
    }
    with driven(made("rod", version), logs=True) as fmu:
        began(fmu, controller=False)
        own = fmu.own.serializeFMUState(fmu.own.getFMUState())
        for key, reason in others.items():
            with driven(made(*key)) as other:
                state = other.own.getFMUState()
                packed = other.own.serializeFMUState(state)
                assert len(packed) == len(own)
                refused(fmu, packed, reason, capsys)
                with pytest.raises(FMICallException):  # nor as it is in memory
                    fmu.own.setFMUState(state)
                assert reason in capsys.readouterr().out
                other.own.freeFMUState(state)


@BOTH
def test_two_controllers_in_one_process_keep_their_own_steps_and_a_reset_is_a_new_beginning(made, version):
    names, (first, second) = OUTPUTS[True], POINTS[True]
    with driven(made("rod", version, True)) as one, driven(made("rod", version, True), start_F1=30.0) as other:
        fresh = one.ask(first, *names)
        far = other.ask([6.0, 0.005], *names)
        one.step(0.0, 0.1)
        other.step(0.0, 0.1)
        assert one.ask(first, *names) == pytest.approx(fresh, abs=1e-6) and far[0] != fresh[0]
        kept = one.ask(second, *names), other.ask(second, *names)
        assert kept[0] != kept[1]  # each is the nearest to its own last step
        one.own.reset()
        assert other.ask(second, *names) == kept[1]
        one.begin()
        assert one.ask(first, *names) == fresh
        one.step(0.0, 0.1)
        assert one.ask(second, *names) == kept[0]


@BOTH
def test_a_controller_that_declares_no_derivatives_refuses_them(made, version):
    fmu = made("rod", version, controller=True)
    assert not fmu.about.coSimulation.providesDirectionalDerivative
    with driven(fmu) as one:
        one.ask([1.0, 0.015], "F1")
        for name in ("F1", "residual"):
            with pytest.raises(FMICallException):
                one.derivatives([name], [1.0, 0.0])


@BOTH
@KINDS
def test_numbers_that_are_no_variables_are_refused(made, version, controller):
    fmu = made("table", version, controller)
    declared = {one.valueReference for one in fmu.about.modelVariables if one.type in ("Real", "Float64")}
    with driven(fmu) as one:
        get = one.own.getReal if version == 2 else one.own.getFloat64
        for reference in range(250):
            if reference in declared:
                get([reference])
            else:
                with pytest.raises(FMICallException):
                    get([reference])


@BOTH
def test_what_is_fixed_cannot_be_set_after_initialisation_nor_anything_after_the_end(made, version):
    with driven(made("rod", version, True), start_F1=20.0) as fmu:
        with pytest.raises(FMICallException):
            fmu.set_numbers([fmu.references["start_F1"]], [10.0])
        assert fmu.numbers("start_F1") == [20.0]
    ended = Driven(made("rod", version))
    ended.begin()
    ended.own.terminate()
    with pytest.raises(FMICallException):
        ended.ask(POINTS[False][0], "tip_x")
    ended.own.freeInstance()


NOTHING = [c_void_p(None)] * 8
UNDECLARED = {
    2: ["fmi2CancelStep"],
    3: [
        *("fmi3EnterEventMode", "fmi3EnterStepMode", "fmi3EnterConfigurationMode", "fmi3ExitConfigurationMode"),
        *("fmi3EnterContinuousTimeMode", "fmi3EvaluateDiscreteStates", "fmi3UpdateDiscreteStates", "fmi3SetTime"),
        *("fmi3GetAdjointDerivative", "fmi3GetOutputDerivatives", "fmi3GetVariableDependencies", "fmi3GetClock"),
        *("fmi3SetClock", "fmi3GetBinary", "fmi3SetBinary", "fmi3ActivateModelPartition", "fmi3GetShiftDecimal"),
        *("fmi3GetNumberOfContinuousStates", "fmi3GetContinuousStates", "fmi3GetNumberOfVariableDependencies"),
    ],
}


@BOTH
def test_functions_of_capabilities_that_are_not_declared_return_an_error(made, version):
    with driven(made("rod", version)) as fmu:
        for name in UNDECLARED[version]:
            function = getattr(fmu.own.dll, name)
            given = [0.0] if name == "fmi3SetTime" else NOTHING
            function.argtypes = [c_void_p, c_double] if name == "fmi3SetTime" else None
            assert function(c_void_p(fmu.own.component), *given) == 3, name
        if version == 2:
            order, value = create_string_buffer(8), create_string_buffer(8)
            for name in ("fmi2SetRealInputDerivatives", "fmi2GetRealOutputDerivatives"):
                call = getattr(fmu.own.dll, name)
                reference = create_string_buffer(struct.pack("I", 1))
                call.argtypes = None
                assert call(c_void_p(fmu.own.component), reference, c_void_p(1), order, value) == 3, name


def test_events_and_intermediate_variables_which_are_not_declared_are_refused(made):
    about = made("rod", 3)
    for given in ({"eventModeUsed": True}, {"requiredIntermediateVariables": [101]}):
        with pytest.raises(Exception, match="Failed to instantiate"):
            Driven(about, **given)
    for name in ("fmi3InstantiateModelExchange", "fmi3InstantiateScheduledExecution"):
        fmu = Driven(about)
        function = getattr(fmu.own.dll, name)
        function.argtypes, function.restype = None, c_void_p
        assert function(b"finger", about.about.instantiationToken.encode(), *[c_void_p(None)] * 8) is None
        fmu.own.freeInstance()
