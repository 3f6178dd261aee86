"""How a bench's DBC, EDS and bit rates show on its wire, for a bench that is predicted without one."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import accumulate
from typing import Any

from drivers import TICK_S, read_dyno, read_rmcu
from hil.core.can.dbc import Dbc
from hil.core.can.frames import longest_frame_s
from hil.core.can.signals import FrameLayout
from hil.engine.bench.bench_tables import BenchFile
from hil.engine.bench.simulable import dyno_of, rmcu_of
from hil.plant.closed_loop import Wire

_RMCU = {
    "motor_speed_rad_s": ("RMCU_Status", "MotorSpeed"),
    "motor_torque_ref_nm": ("RMCU_Status", "MotorTorqueRef"),
    "motor_torque_nm": ("RMCU_Status", "MotorTorque"),
    "driving_torque_ref_nm": ("RMCU_Control", "DrivingTorqueRef"),
    "driving_torque_est_nm": ("RMCU_Control", "DrivingTorqueEst"),
}
_LARGEST_SHIFT = 1


@dataclass(frozen=True)
class PredictedWire:
    """A bench's wire as a recording sees it.

    `first_stamp_s` is how long after its sample the frame appears that a recording's time counts from, and
    `unsettled_s` by how much earlier the earliest frame of a sample appears. `parameters` are those of the
    RMCU that the DBC names; `dictionary` is the dynos'. `loads` is the share of each bus that is
    taken by the frames of each millisecond, with the most stuff bits that they may have.
    """

    rounding: Wire
    first_stamp_s: float
    unsettled_s: float
    parameters: frozenset[str]
    dictionary: Any
    loads: dict[str, float]


def wire_of(bench: BenchFile) -> PredictedWire:
    """What the wire of a bench does to numbers and times, from its DBC, its EDS and its bit rates.

    Raises:
        BadInputError: a device file cannot be used.
    """
    dbc, dyno = read_rmcu(rmcu_of(bench).dbc, rmcu_of(bench).names), dyno_of(bench)
    left, right = read_dyno(dyno.eds, dyno.rear_left), read_dyno(dyno.eds, dyno.rear_right)
    signals = {name: dbc.layouts[message].signals[signal] for name, (message, signal) in _RMCU.items()}
    frames = {name: dbc.layouts[message].id for name, (message, _) in _RMCU.items()}
    for side, file in (("left", left), ("right", right)):
        values, status = file.values, file.status
        shown = {
            f"wheel_speed_{side}_rad_s": (values, "Wheel speed"),
            f"shaft_torque_{side}_nm": (values, "Shaft torque"),
            f"dyno_torque_{side}_nm": (status, "Torque actual value"),
        }
        if side == "left":
            shown["vehicle_speed_m_s"] = (status, "Vehicle speed")
        for name, (layout, signal) in shown.items():
            signals[name], frames[name] = layout.signals[signal], layout.id
    ends_s = _frame_ends_s(bench, dbc, (left.values, left.status, right.values, right.status))
    master_s = ends_s[frames["motor_speed_rad_s"]]
    late = {name: _nearest(ends_s[frame] - master_s) for name, frame in frames.items()}
    rounding = Wire(
        channels=signals,
        request=dbc.layouts["RMCU_Request"].signals["TorqueRequest"],
        parameter=dbc.layouts["RMCU_ParameterWrite"].signals["Value"],
        target_speed=left.command.signals["Target velocity"],
        late={name: shift for name, shift in late.items() if shift},
    )
    earliest_s = min(ends_s[frame] for frame in frames.values())
    named = frozenset(dbc.texts.get(("RMCU_ParameterWrite", "Index"), {}))
    loads = _loads(bench)
    return PredictedWire(rounding, master_s, master_s - earliest_s, named, left.dictionary, loads)


def _cyclic(
    bench: BenchFile, dbc: Dbc, dynos: tuple[FrameLayout, ...]
) -> list[tuple[str, list[FrameLayout]]]:
    """What devices send in each millisecond, bus by bus."""
    rmcu = [dbc.layouts[name] for name in ("RCS_Vehicle", "RMCU_Status", "RMCU_Control")]
    sync = FrameLayout("SYNC", 0x80, 0, {})
    return [(rmcu_of(bench).bus, rmcu), (dyno_of(bench).bus, [sync, *dynos])]


def _loads(bench: BenchFile) -> dict[str, float]:
    """Share of each bus that is taken, the torque requests of the RMCU's bus included."""
    found = dict.fromkeys(bench.buses, 0.0)
    for table in bench.device_tables.values():
        bus = getattr(table, "bus", None)
        if bus in found:
            found[bus] += table.bits_each_second() / bench.buses[bus].bit_rate
    return found


def _frame_ends_s(bench: BenchFile, dbc: Dbc, dynos: tuple[FrameLayout, ...]) -> dict[int, float]:
    """When each cyclic frame of a sample has crossed its bus, by identifier, as on the simulated bench."""
    found: dict[int, float] = {}
    for bus, layouts in _cyclic(bench, dbc, dynos):
        rate = bench.buses[bus].bit_rate
        ends = accumulate(longest_frame_s(layout.length, rate) for layout in layouts)
        found |= {layout.id: end_s for layout, end_s in zip(layouts, ends, strict=True)}
    return found


def _nearest(after_s: float) -> int:
    """Of a cyclic frame `after_s` behind the recording's stamp: which sample's is nearest to the stamp."""
    shifts = range(-_LARGEST_SHIFT, _LARGEST_SHIFT + 1)
    return min(shifts, key=lambda shift: (abs(after_s + shift * TICK_S), shift))
