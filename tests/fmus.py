"""FMUs as tests drive them: made once, unzipped, and asked by the names of their variables in both versions of FMI."""

import shutil
import zipfile
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import fmpy
import pytest
from fmpy.fmi2 import FMU2Slave
from fmpy.fmi3 import FMU3Slave

from control.export import fmu as control_fmu
from rom.export.fmu import write

COMPILER = shutil.which("cc") or shutil.which("gcc")
BOTH = pytest.mark.parametrize("version", [3, pytest.param(2, marks=pytest.mark.long)])


class Maker:
    """The FMU of a model and its description, once each.

    Args:
        folder: where they are written.
        models: by name.
    """

    def __init__(self, folder: Path, models: Mapping[str, Any]):
        self._folder, self._models, self._made = folder, models, {}

    def __call__(self, name: str, version: int, controller: bool = False) -> SimpleNamespace:
        key = f"{name}{version}{'hold' if controller else ''}"
        if key not in self._made:
            path = self._folder / f"{key}.fmu"
            (control_fmu.write if controller else write)(self._models[name], path, version)
            unzipped = self._folder / key
            with zipfile.ZipFile(path) as packed:
                packed.extractall(unzipped)
            (library,) = unzipped.glob("binaries/*/*.so")
            about = fmpy.read_model_description(path)
            self._made[key] = SimpleNamespace(path=path, folder=unzipped, library=library, version=version, about=about)
        return self._made[key]


class Driven:
    """An instance, by the names of its variables, in both versions of FMI."""

    def __init__(self, fmu: SimpleNamespace, token: str | None = None, logs: bool = False, **options: Any):
        self.version = fmu.version
        about = fmu.about
        self.references = {one.name: one.valueReference for one in about.modelVariables}
        self.inputs = [one.valueReference for one in about.modelVariables if one.causality == "input"]
        self.own = (FMU2Slave if self.version == 2 else FMU3Slave)(
            guid=token or (about.guid if self.version == 2 else about.instantiationToken),
            unzipDirectory=str(fmu.folder),
            modelIdentifier=about.coSimulation.modelIdentifier,
            instanceName="finger",
        )
        self.own.instantiate(loggingOn=logs, **options)

    def begin(self, **starts: float) -> None:
        if starts:
            self.set_numbers([self.references[name] for name in starts], list(starts.values()))
        if self.version == 2:
            self.own.setupExperiment(startTime=0.0, stopTime=1.0)
            self.own.enterInitializationMode()
        else:
            self.own.enterInitializationMode(startTime=0.0, stopTime=1.0)
        self.own.exitInitializationMode()

    def set_numbers(self, references, values) -> None:
        (self.own.setReal if self.version == 2 else self.own.setFloat64)(references, values)

    def numbers(self, *names: str) -> list[float]:
        references = [self.references[name] for name in names]
        return self.own.getReal(references) if self.version == 2 else self.own.getFloat64(references)

    def ask(self, point, *names: str) -> list[float]:
        self.set_numbers(self.inputs, list(map(float, point)))
        return self.numbers(*names)

    def flag(self, name: str) -> bool:
        return bool(self.own.getBoolean([self.references[name]])[0])

    @property
    def status(self) -> int:
        return (self.own.getInteger if self.version == 2 else self.own.getInt64)([self.references["status"]])[0]

    def step(self, time: float, size: float) -> None:
        self.own.doStep(currentCommunicationPoint=time, communicationStepSize=size)

    def derivatives(self, names, seed) -> list[float]:
        return self.own.getDirectionalDerivative([self.references[name] for name in names], self.inputs, list(seed))


@contextmanager
def driven(fmu: SimpleNamespace, logs: bool = False, **starts: float) -> Iterator[Driven]:
    found = Driven(fmu, logs=logs)
    found.begin(**starts)
    yield found
    found.own.terminate()
    found.own.freeInstance()
