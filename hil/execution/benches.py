"""The benches of a service: their files, and whether one may be driven now."""

from __future__ import annotations

from pathlib import Path

from hil.core.channels import unit_of
from hil.core.errors import BadInputError, BenchError, StopWay
from hil.engine import BenchFile, load_bench
from hil.engine.bench.bench_lock import alone_on
from hil.engine.bench.ranges import limits_of_channels
from hil.engine.stop.emergency_stop import latch, refuse_latched, reset


class Bench:
    """A bench; its file is read when the service begins, and again before each run.

    `stops` is the folder of the service or agent: there lie the stops of its benches that are simulated.
    """

    def __init__(self, name_or_path: str, stops: Path | None = None) -> None:
        self._named, self.stops = name_or_path, stops
        self.file = load_bench(name_or_path)
        self.name = self.file.name

    @property
    def title(self) -> str:
        """What it is called for people."""
        return self.file.title

    @property
    def dut(self) -> str:
        """Serial number or name of the device under test; '' for none."""
        return self.file.dut.get("serial", self.file.dut.get("name", ""))

    @property
    def simulated(self) -> bool:
        """Whether what moves is computed."""
        return self.file.simulation is not None

    @property
    def limits(self) -> dict[str, float]:
        """Largest magnitude by channel; of the shaft torque, whose sides are limited, also both together."""
        return limits_of_channels(self.file.limits) | {"shaft_torque_nm": self.file.limits.shaft_torque_nm}

    @property
    def units(self) -> dict[str, str]:
        """Units of the limited channels."""
        return {name: unit_of(name) for name in self.limits}

    def read_again(self) -> BenchFile:
        """The file as it is now.

        Raises:
            BadInputError: it cannot be used any more, or names another bench.
        """
        file = load_bench(self._named)
        if file.name != self.name:
            raise BadInputError(
                f"was '{self.name}' when the service started and is now '{file.name}'",
                where=str(file.source),
                fix="restore the name, or restart the service",
            )
        self.file = file
        return file

    def stopped(self) -> str:
        """Why nothing may move until somebody resets it; '' if nothing is latched."""
        try:
            refuse_latched(self.file, self.stops)
        except BenchError as error:
            return error.what
        return ""

    def used_by(self) -> str:
        """Which process drives its buses; '' if none does."""
        try:
            with alone_on(self.file):
                return ""
        except BenchError as error:
            return error.what

    def stop(self, by: str, folder: Path, *, origin: str = "", way: StopWay = "api") -> None:
        """Latch it: no process arms it before a person has reset it.

        Args:
            by: who asks for it, from `origin`, by which way.
            folder: of the run under way.

        Raises:
            HilError: that cannot be written.
        """
        why = f"requested by {by} at the bench service"
        latch(self.file, by=by, why=why, run=folder, owner=self.stops, origin=origin, way=way)

    def reset(self, by: str) -> int:
        """Let it be armed again; how many stops there were.

        Raises:
            HilError: that cannot be written.
        """
        return len(reset(self.file, by, self.stops))


def benches_of(names: list[str], stops: Path | None = None) -> dict[str, Bench]:
    """Benches by the names in their files.

    Args:
        stops: the folder of the service or agent.

    Raises:
        BadInputError: one of the files cannot be used, or two have the same name.
    """
    found: dict[str, Bench] = {}
    for name in names:
        bench = Bench(name, stops)
        if bench.name in found:
            raise BadInputError(
                f"the name '{bench.name}' is used by two benches",
                where=str(bench.file.source),
                fix="rename one of them in its file",
            )
        found[bench.name] = bench
    return found
