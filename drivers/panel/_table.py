"""The table of a panel."""

from __future__ import annotations

from pydantic import Field

from drivers.panel._panel import Panel, ReturningLine
from drivers.table import Connections, DeviceTable


class PanelTable(DeviceTable):
    """Serial line of the dynos' panel."""

    kind: str = "rcs-panel"
    port: str = Field(min_length=1, description="as pyserial opens it: /dev/ttyUSB0, COM3, rfc2217://…")
    baud_rate: int = Field(9600, ge=300, le=1_000_000, description="bit/s")
    channel: int = Field(0, ge=0, le=9, description="number of the test bench in the protocol")
    answers_within_s: float = Field(0.3, ge=0.01, le=10, description="deadline of an answer")
    gone_after_s: float = Field(
        3.0, ge=0.5, le=60, description="a panel that is silent for this time ends the run"
    )

    def open(self, name: str, connections: Connections) -> Panel:
        """Make the driver.

        Raises:
            BenchError: the port cannot be opened.
        """
        port = self.port
        stand_in = connections.serial_stand_ins.get(self.kind)
        if connections.simulated and stand_in is not None:
            port = stand_in()
        line = ReturningLine(name, port, self.baud_rate, connections.loop.clock)
        return Panel(name, line, connections.loop, self.channel, self.answers_within_s, self.gone_after_s)
