"""An FMU run by FMPy with the inputs of a record: the check that an exported model moves as the model does."""

import tempfile
import zipfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING
from xml.etree import ElementTree

import numpy as np

from seatrial.core.text.words import printable
from seatrial.core.values import NOTATION, Array, Channel, InputError, Provenance, Record, RecordKind, frozen
from seatrial.data.read.log import require_library
from seatrial.physics.simulate.replay import ZERO_BY_DEFAULT

if TYPE_CHECKING:
    from fmpy.fmi2 import FMU2Slave
    from fmpy.model_description import ModelDescription, ScalarVariable


def replay_fmu(path: Path, record: Record) -> Record:
    """Return the run of an FMU for co-simulation under the inputs of a record, straight between its samples.

    Inputs, and states at the first sample, are the channels of the same name; states without one start as the FMU says.

    Raises:
        InputError: no FMU, none for co-simulation or this platform, an input that the record lacks, a step that fails,
            or FMPy is not installed.
    """
    require_library("fmpy", f"'{path}'", "an FMU", "fmu")
    with _instance(path) as (description, fmu, log):
        inputs = [v for v in description.modelVariables if v.causality == "input" and v.type == "Real"]
        outputs = [v for v in description.modelVariables if v.causality == "output" and v.type == "Real"]
        signs = _signs(path)
        driven = np.column_stack(
            [_input_values(record, v, signs, path) for v in inputs] or [np.empty((len(record), 0))]
        )
        starts = {v: float(record[v.name][0]) for v in outputs if v.initial == "exact" and v.name in record}
        try:
            values = _run(fmu, inputs, outputs, starts, driven, record.dt)
        except Exception as error:  # FMPy raises its own and those of ctypes
            reason = log[-1] if log else str(error)
            raise InputError(f"FMU '{path}' stopped on record '{record.name}': {printable(reason)}") from None
    channels = {v.name: _channel(v.name, values[:, k] * signs.get(v.name, 1.0)) for k, v in enumerate(outputs)}
    channels |= {v.name: record.channel(v.name) for v in inputs if v.name in record}
    provenance = Provenance(str(path), steps=(f"inputs of '{record.name}' replayed through the FMU by FMPy",))
    return Record(record.name, record.time, channels, RecordKind.SIMULATED, provenance=provenance)


@contextmanager
def _instance(path: Path) -> "Iterator[tuple[ModelDescription, FMU2Slave, list[str]]]":
    """The unpacked FMU's description, an instance of it, and the messages that it logs."""
    import fmpy
    from fmpy.fmi2 import FMU2Slave

    log: list[str] = []
    with tempfile.TemporaryDirectory() as place:
        try:
            description = fmpy.read_model_description(str(path))
            if description.coSimulation is None or description.fmiVersion != "2.0":
                raise InputError(f"FMU '{path}' is not one of FMI 2.0 for co-simulation; export it so")
            fmpy.extract(str(path), unzipdir=place)
            identifier = description.coSimulation.modelIdentifier
            fmu = FMU2Slave(guid=description.guid, unzipDirectory=place, modelIdentifier=identifier, instanceName="run")
            fmu.instantiate(callbacks=_callbacks(log))
        except InputError:
            raise
        except Exception as error:  # whatever a damaged archive, description or library raises
            reason = printable(" ".join(str(error).split()))
            raise InputError(f"'{path}' cannot be run as an FMU on this platform ({reason})") from None
        try:
            yield description, fmu, log
        finally:
            fmu.freeInstance()


def _callbacks(log: list[str]) -> object:
    from fmpy import calloc, free
    from fmpy.fmi2 import (
        fmi2CallbackAllocateMemoryTYPE,
        fmi2CallbackFreeMemoryTYPE,
        fmi2CallbackFunctions,
        fmi2CallbackLoggerTYPE,
    )

    def logged(
        _environment: object, _name: bytes, _status: int, _category: bytes, message: bytes, *_more: object
    ) -> None:
        log.append(message.decode("utf-8", "replace"))

    callbacks = fmi2CallbackFunctions()
    callbacks.logger = fmi2CallbackLoggerTYPE(logged)
    callbacks.allocateMemory, callbacks.freeMemory = (
        fmi2CallbackAllocateMemoryTYPE(calloc),
        fmi2CallbackFreeMemoryTYPE(free),
    )
    return callbacks


def _run(
    fmu: "FMU2Slave", inputs: "list[ScalarVariable]", outputs: "list[ScalarVariable]",
    starts: "dict[ScalarVariable, float]", driven: Array, dt: float,
) -> Array:  # fmt: skip
    """Return the outputs at each row of the inputs, shape (n, ny)."""
    references = [v.valueReference for v in inputs]
    rows = np.empty((len(driven), len(outputs)))
    fmu.setupExperiment(startTime=0.0)
    fmu.setReal([v.valueReference for v in starts], list(starts.values()))
    fmu.enterInitializationMode()
    fmu.setReal(references, driven[0].tolist())
    fmu.exitInitializationMode()
    for k, row in enumerate(driven):
        fmu.setReal(references, row.tolist())
        rows[k] = fmu.getReal([v.valueReference for v in outputs])
        if k + 1 < len(driven):
            slopes = ((driven[k + 1] - row) / dt).tolist()
            fmu.setRealInputDerivatives(references, [1] * len(references), slopes)
            fmu.doStep(currentCommunicationPoint=k * dt, communicationStepSize=dt)
    return rows


def _signs(path: Path) -> dict[str, float]:
    """Inputs that the model counts against the notation's sign -> -1, as the annotation of an exported FMU says."""
    with zipfile.ZipFile(path) as archive:
        root = ElementTree.fromstring(archive.read("modelDescription.xml"))
    annotation = root.find("./VendorAnnotations/Tool[@name='seatrial']/Model")
    return {} if annotation is None else dict.fromkeys(annotation.get("reversed", "").split(), -1.0)


def _input_values(record: Record, variable: "ScalarVariable", signs: dict[str, float], path: Path) -> Array:
    name = variable.name
    if name not in record:
        if name in ZERO_BY_DEFAULT:
            return np.zeros(len(record))
        raise InputError(f"record '{record.name}' has no channel '{name}', an input of FMU '{path}'; add it")
    if not np.isfinite(record[name]).all():
        raise InputError(f"record '{record.name}': input channel '{name}' has gaps; repair it first")
    return record[name] * signs.get(name, 1.0)


def _channel(name: str, values: Array) -> Channel:
    if name in NOTATION:
        return Channel.from_notation(name, frozen(np.ascontiguousarray(values)))
    return Channel(frozen(np.ascontiguousarray(values)), "1", "none", "none")
