"""What stands in a bench file, table by table; what devices say of themselves is theirs (`drivers`)."""

from __future__ import annotations

import datetime
from pathlib import Path
from typing import Annotated, Any, Self

from pydantic import BeforeValidator, Field, SerializeAsAny, model_validator

from drivers import DeviceTable, File, LoadTable, Name
from hil.core.errors.wording import LONGEST_NAME
from hil.core.files.toml_file import FORMAT, FormatNumber
from hil.engine.bench.ranges import Bound, Interlock, Limit, Limits, Table


def _date(value: object) -> object:
    """A date as TOML has it, also in quotes; no number, which would count as seconds since 1970."""
    if isinstance(value, str) and len(value) == len("2027-06-30"):
        return datetime.date.fromisoformat(value)
    if not isinstance(value, datetime.date) or isinstance(value, datetime.datetime):
        raise ValueError("is not a date; write the last valid day as 2027-06-30")
    return value


Day = Annotated[datetime.date, BeforeValidator(_date)]
Line = Annotated[str, Field(max_length=200)]
Statement = Annotated[str, Field(max_length=1000)]
_HIGHEST_CHANNEL = 255
Deviation = Annotated[float, Field(ge=0, le=1e4)]


def _channel(value: object) -> object:
    """A name, or a number as the adapter counts."""
    if not isinstance(value, str | int) or isinstance(value, bool) or value == "":
        raise ValueError('is not a channel; write a name such as "can0", or a number such as 0')
    if isinstance(value, int) and not 0 <= value <= _HIGHEST_CHANNEL:
        raise ValueError(f"is not a channel; channels are numbered from 0 to {_HIGHEST_CHANNEL}")
    return value


Channel = Annotated[str | int, BeforeValidator(_channel)]
Segment = Annotated[int, Field(ge=1, le=1024)]
SamplePoint = Annotated[float, Field(ge=50.0, le=100.0, description="%")]


class Timing(Table):
    """Bit timing of an adapter, if its default does not fit; by sample points or by segments.

    Segments count time quanta and have CiA's and python-can's names; those of CAN FD's data phase begin
    with data_.
    """

    f_clock: int = Field(ge=1_000_000, le=160_000_000, description="clock of the CAN controller, Hz")
    sample_point: SamplePoint | None = None
    data_sample_point: SamplePoint | None = None
    tseg1: Segment | None = None
    tseg2: Segment | None = None
    sjw: Segment | None = None
    data_tseg1: Segment | None = None
    data_tseg2: Segment | None = None
    data_sjw: Segment | None = None

    @model_validator(mode="after")
    def _is_whole(self) -> Self:
        for data in ("", "data_"):
            segments = [getattr(self, f"{data}{key}") for key in ("tseg1", "tseg2", "sjw")]
            given = [segment is not None for segment in segments]
            if any(given) and not all(given):
                raise ValueError(f"give {data}tseg1, {data}tseg2 and {data}sjw together")
            if any(given) and getattr(self, f"{data}sample_point") is not None:
                raise ValueError(
                    f"give {data}sample_point or {data}tseg1, {data}tseg2 and {data}sjw, not both"
                )
        if (self.data_sample_point is None) != (self.sample_point is None) and self.has_data_phase:
            raise ValueError("give both phases by sample points, or both by segments")
        if self.sample_point is None and self.tseg1 is None:
            raise ValueError("is empty; give sample_point, or tseg1, tseg2 and sjw")
        return self

    @property
    def has_data_phase(self) -> bool:
        """Whether it is one of CAN FD."""
        return self.data_sample_point is not None or self.data_tseg1 is not None


class Bus(Table):
    """One CAN bus, opened by python-can."""

    interface: str = Field(min_length=1)
    channel: Channel
    bit_rate: int = Field(ge=10_000, le=1_000_000, description="bit/s")
    fd: bool = Field(False, description="open the controller for CAN FD")
    data_bit_rate: int | None = Field(
        None, ge=10_000, le=10_000_000, description="bit/s of CAN FD's data phase"
    )
    timing: Timing | None = None
    options: dict[str, Any] = Field({}, description="further arguments for can.Bus")


class Vehicle(Table):
    """The dynos' vehicle model; what is left out keeps the controller's value."""

    wheel_radius_m: float = Field(0.33, ge=0.01, le=10.0)
    slip: float = Field(0.0, ge=0, lt=1)
    gear_ratio: float | None = Field(
        None, gt=0, le=100, description="motor speed / wheel speed; default: the controller's"
    )
    wheel_orders: list[Annotated[float, Field(gt=0, le=1000)]] = Field(
        [],
        max_length=12,
        description="orders of the wheel that joints, tyres or an imbalance excite: "
        "not counted as oscillation of the control loop",
    )
    inertia_kg_m2: float | None = Field(None, gt=0, le=1e6)
    rolling_nm: float | None = Field(None, ge=0, le=1e6)
    aero_nms2_rad2: float | None = Field(None, ge=0, le=1e6)


class ZeroLimit(Table):
    """Limits of a sensor's reading at rest, in its channel's unit; without one it is not evaluated."""

    within: Limit | None = Field(None, description="largest magnitude before a run")
    drift: Limit | None = Field(None, description="largest change from before a run to after it")

    @model_validator(mode="after")
    def _says_something(self) -> Self:
        if self.within is None and self.drift is None:
            raise ValueError("sets no limit; give 'within', 'drift' or both")
        return self


class NoiseTable(Table):
    """Standard deviations of the simulated sensors."""

    motor_speed_rad_s: Deviation = 0.02
    wheel_speed_rad_s: Deviation = 0.002
    shaft_torque_nm: Deviation = 0.5


class SensorTable(Table):
    """Errors of a simulated sensor: reading = gain × true value + offset."""

    gain: Bound = 1.0
    offset: Bound = 0.0


class StatedNoise(Table):
    """Standard deviations of a sample, from the sensors' data sheets."""

    motor_speed_rad_s: Deviation | None = None
    wheel_speed_rad_s: Deviation | None = None
    shaft_torque_nm: Deviation | None = None


class Simulation(Table):
    """A simulated bench in place of hardware."""

    model: File
    seed: int = Field(1, ge=0, le=2**63 - 1)
    noise: NoiseTable = NoiseTable()
    sensors: dict[str, SensorTable] = Field({}, description="errors of a channel's sensor, by channel")
    rmcu: dict[str, Bound] = Field(
        {}, description="parameters that this RMCU keeps, whatever is written to it"
    )


class Supervision(Table):
    """Mutual supervision of the command and of the process that drives the bench for it.

    Times are those of a bench in real time; with `time_scale` they are as much longer.
    """

    own_process: bool | None = Field(
        None, description="true: a separate process drives the bench; default: true for hardware"
    )
    hung_after_s: float = Field(
        2.0, ge=0.5, le=60, description="the process is ended if its loop stops for this time, s"
    )
    alone_after_s: float = Field(
        2.0, ge=0.5, le=60, description="the run is ended if its command is silent for this time, s"
    )
    run_down_s: float = Field(
        10.0,
        ge=0,
        le=600,
        description="after a stop the axle is recorded until it stands, at most this time, s",
    )


class ReportTable(Table):
    """Data of a test report in addition to the results (ISO/IEC 17025, 7.8); default: 'not stated'."""

    laboratory: Statement = Field("", description="name and address")
    report_number: Line = ""
    customer: Statement = Field("", description="name and contact")
    conditions: Statement = Field("", description="ambient conditions, where they affect the results")
    equipment: Statement = Field("", description="measuring equipment, with inventory or serial numbers")
    measurement_uncertainty: Statement = Field(
        "", description="measurement uncertainty of the results, in their unit, with its coverage factor"
    )
    decision_rule: Statement = Field("", description="decision rule for uncertainty in a verdict (ILAC-G8)")


class BenchFile(Table):
    """One bench file; paths are absolute once it is loaded."""

    format: FormatNumber = FORMAT
    name: Name
    title: Line = ""
    operator: Annotated[str, Field(max_length=LONGEST_NAME)] = ""
    time_scale: float = Field(
        1.0, ge=0.001, le=1, description="bench seconds per real second; for `hil bench sim` only"
    )
    buses: dict[Name, Bus]
    rmcu: SerializeAsAny[DeviceTable]
    dyno: SerializeAsAny[LoadTable]
    devices: dict[Name, SerializeAsAny[DeviceTable]] = Field({})
    limits: Limits
    interlocks: dict[Name, Interlock] = Field({}, description="conditions that must hold during a run")
    vehicle: Vehicle = Vehicle()
    supervision: Supervision = Supervision()
    zero: dict[str, ZeroLimit] = Field({}, description="limits of the reading at rest, by channel")
    dut: dict[Line, Line] = Field({}, max_length=50)
    report: ReportTable = Field(ReportTable(), description="data of the laboratory for the test report")
    calibration: dict[str, Day] = Field({}, description="last valid day of the calibration, by sensor")
    noise: StatedNoise = Field(
        StatedNoise(),
        description="noise by channel, from the sensors' data sheets; read by `hil diagnose`",
    )
    simulation: Simulation | None = None
    text: str = ""
    source: File = Path()

    @property
    def device_tables(self) -> dict[str, DeviceTable]:
        """The tables of all devices by their keys, in the order in which they come up."""
        further = {f"devices.{name}": table for name, table in self.devices.items()}
        return {"rmcu": self.rmcu, "dyno": self.dyno, **further}
