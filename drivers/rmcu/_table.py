"""The table of an RMCU on CAN, described by a DBC."""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Iterator, Mapping

from pydantic import Field

from drivers.rmcu._driver import RMCU_SIGNALS, RmcuDriver, read_rmcu
from drivers.table import Connections, DeviceTable, File
from hil.core.can.dbc import Names
from hil.core.can.frames import most_frame_bits
from hil.core.channels import TICK_S
from hil.core.errors import BadInputError
from hil.core.errors.wording import printable


class RmcuTable(DeviceTable):
    """Bus and DBC of the RMCU, with the names that differ from benches/rmcu.dbc."""

    kind: str = "rmcu-can"
    bus: str
    dbc: File
    messages: dict[str, str] = Field({}, description="our message: the DBC's")
    signals: dict[str, dict[str, str]] = Field({}, description="our message: our signal: the DBC's")
    values: dict[str, dict[str, dict[str, str]]] = Field(
        {}, description="our message: our signal: our text of a value: the DBC's (VAL_)"
    )

    @property
    def names(self) -> Names:
        """What the DBC calls things."""
        return Names(self.messages, self.signals, self.values)

    def open(self, name: str, connections: Connections) -> RmcuDriver:
        """Make the driver.

        Raises:
            BadInputError: the DBC cannot be used.
        """
        del name  # there is one RMCU
        return RmcuDriver(connections.loop, connections.wires[self.bus], self.dbc, self.names)

    def contradictions(self) -> Iterator[str]:
        """Names for what an RMCU does not have, and names given twice."""
        yield from _unknown("messages", self.messages, RMCU_SIGNALS)
        yield from _twice("messages", self.messages)
        for key, tables in (("signals", self.signals), ("values", self.values)):
            yield from _unknown(key, tables, RMCU_SIGNALS)
            for message in tables.keys() & RMCU_SIGNALS.keys():
                yield from _unknown(f"{key}.{message}", tables[message], RMCU_SIGNALS[message])
        for message, signals in self.signals.items():
            yield from _twice(f"signals.{message}", signals)
        for message, tables in self.values.items():
            for signal, texts in tables.items():
                yield from _twice(f"values.{message}.{signal}", texts)

    def unusable_files(self) -> Iterator[tuple[str, BadInputError]]:
        """The DBC, if it cannot be used."""
        try:
            read_rmcu(self.dbc, self.names)
        except BadInputError as error:
            yield "dbc", error

    def identifiers(self) -> Mapping[int, str]:
        """Those of the messages that are used."""
        layouts = read_rmcu(self.dbc, self.names).layouts
        return {layout.id: f"'{layout.name}'" for layout in layouts.values()}

    def remarks(self) -> tuple[str, ...]:
        """Units of the DBC."""
        return read_rmcu(self.dbc, self.names).remarks

    def bits_each_second(self) -> float:
        """Requests, status, and the dyno controller's vehicle speed, one each millisecond."""
        layouts = read_rmcu(self.dbc, self.names).layouts
        cyclic = ("RMCU_Request", "RMCU_Status", "RMCU_Control", "RCS_Vehicle")
        return sum(int(most_frame_bits(layouts[name].length, False)) for name in cyclic) / TICK_S

    def described_in(self) -> dict[str, tuple[str, str]]:
        """Signals of the DBC, as it calls them."""
        signals = {
            "motor_speed_rad_s": ("RMCU_Status", "MotorSpeed"),
            "motor_torque_ref_nm": ("RMCU_Status", "MotorTorqueRef"),
            "motor_torque_nm": ("RMCU_Status", "MotorTorque"),
            "driving_torque_ref_nm": ("RMCU_Control", "DrivingTorqueRef"),
            "driving_torque_est_nm": ("RMCU_Control", "DrivingTorqueEst"),
        }
        return {
            channel: (
                "dbc",
                f"signal '{self.names.signal(message, signal)}' of '{self.names.message(message)}'",
            )
            for channel, (message, signal) in signals.items()
        }

    def asked_by_hosts(self) -> tuple[int, ...]:
        """Requests and parameters."""
        layouts = read_rmcu(self.dbc, self.names).layouts
        return layouts["RMCU_Request"].id, layouts["RMCU_ParameterWrite"].id


def _unknown(key: str, given: Iterable[str], known: Iterable[str]) -> Iterator[str]:
    choices = list(known)
    for name in given:
        if name not in choices:
            near = difflib.get_close_matches(name, choices, 1)
            hint = f"did you mean '{near[0]}'?" if near else f"known: {', '.join(choices)}"
            yield f"{key}.{printable(name, 60)}: is not of the RMCU; on the left stand our names; {hint}"


def _twice(key: str, names: Mapping[str, str]) -> Iterator[str]:
    seen: dict[str, str] = {}
    for ours, theirs in names.items():
        other = seen.setdefault(theirs, ours)
        if other != ours:
            yield f"{key}.{ours} = '{printable(theirs, 60)}': is also {other}; each has a name of its own"
