"""A device's table in the bench file: its settings, and how the device is opened with them."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Self

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field

from drivers.device import Device
from drivers.loop import BusLoop
from drivers.wire import Wire
from hil.core.errors import BadInputError

_LONGEST_NAME = 64


def _plain_name(value: object) -> object:
    """A name that can stand in a file's name, a topic and a channel."""
    if isinstance(value, str) and (set(value) & {"/", "\\"} or value.strip(" .") != value):
        raise ValueError("is a path or has spaces around it; give a plain name, such as 'rear_axle'")
    return value


#: A name that people give to something in a bench file.
Name = Annotated[str, Field(min_length=1, max_length=_LONGEST_NAME), BeforeValidator(_plain_name)]
#: A file that a bench file names, relative to it.
File = Annotated[Path, Field(strict=False)]


@dataclass(frozen=True)
class VehicleParameters:
    """What the dynos' vehicle model is set to; None leaves the value that the controller has."""

    wheel_radius_m: float = 0.33
    slip: float = 0.0
    inertia_kg_m2: float | None = None
    rolling_nm: float | None = None
    aero_nms2_rad2: float | None = None


@dataclass(frozen=True)
class Connections:
    """What a device is opened with.

    Attributes:
        loop: what it waits in, with the bench clock; a device of another wire lets it serve its port.
        wires: the CAN buses of the bench file, by name.
        vehicle: what the bench file says of the vehicle.
        simulated: whether time is computed: then a device that is not there brings its own stand-in, which
            lives in the loop.
        serial_stand_ins: by kind, what makes one of the project's own stand-ins and gives its port.
    """

    loop: BusLoop
    wires: Mapping[str, Wire] = field(default_factory=dict)
    vehicle: VehicleParameters = VehicleParameters()
    simulated: bool = False
    serial_stand_ins: Mapping[str, Callable[[], str]] = field(default_factory=dict)


class DeviceTable(BaseModel):
    """A kind of device: the keys of its table, checked, and `open`.

    A class derived from this is offered as an entry point of the group `hil.devices`; the entry point's name
    is the `kind` in the bench file. A table with a key `bus` is on that CAN bus.
    """

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False, strict=True)

    kind: str
    expects: dict[str, str] = Field(
        {}, description="expected identification of the device: software, calibration, serial number"
    )

    def open(self, name: str, connections: Connections) -> Device:
        """Make the device; `name` is that of its table.

        Raises:
            BadInputError: what the table names cannot be used.
            BenchError: the device's own port cannot be opened.
        """
        raise NotImplementedError(f"{type(self).__name__} does not open its device")

    def contradictions(self) -> Iterable[str]:
        """What contradicts itself though every key is right alone: key, value and what to do, each a line."""
        return ()

    def unusable_files(self) -> Iterable[tuple[str, BadInputError]]:
        """Keys of files that cannot be used, and why; paths are absolute by now."""
        return ()

    def remarks(self) -> Iterable[str]:
        """What of its files was converted, or had to be assumed; a sentence each."""
        return ()

    def identifiers(self) -> Mapping[int, str]:
        """CAN identifiers that the device sends or hears on its bus, with words for each."""
        return {}

    def described_in(self) -> Mapping[str, tuple[str, str]]:
        """Where each channel is described: the key of the file in this table, and what to look for there."""
        return {}

    def asked_by_hosts(self) -> Collection[int]:
        """Those of `identifiers` that only a host sends: who sends them drives this bench."""
        return ()

    def sends_by_itself(self) -> bool:
        """Whether frames of the device come on its bus though no one has asked for any."""
        return True

    def bits_each_second(self) -> float:
        """Of the frames on its bus that come and go all the time, stuff bits included; 0: no one knows."""
        return 0.0

    def files(self) -> list[Path]:
        """The files that the table names, such as a DBC: a recording keeps them."""
        return [value for _, value in self if isinstance(value, Path)]

    def beside(self, directory: Path) -> Self:
        """The table with its paths relative to a directory made absolute."""
        paths = {key: directory / value for key, value in self if isinstance(value, Path)}
        return self.model_copy(update=paths)


class LoadTable(DeviceTable):
    """The table of a device that turns the wheels."""

    speed_ramp_m_s2: float = Field(4.0, ge=0.01, le=100.0)
