"""The run-down: what is recorded after a stop, every device safe, until the axle stands."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence

from drivers import BusLoop, Samples, Stream
from hil.engine.bench.bench import Bench
from hil.engine.run.safety import reach_safe_state
from hil.engine.run.zero import REST_S, turning

#: So often it is looked whether every device is safe and whether somebody asks to stop, s of bench time.
LOOK_S = 0.01
#: Without a measured speed for so long no one knows whether the axle turns, s.
SILENT_S = 0.5
_SPEEDS = ("motor_speed_rad_s", "wheel_speed_left_rad_s", "wheel_speed_right_rad_s")

Event = Callable[[str, str], None]


class AxleSpeeds:
    """The newest speeds of the axle, from samples of any stream."""

    def __init__(self, streams: Sequence[Stream], now_s: Callable[[], float]) -> None:
        self._now_s = now_s
        self._columns: Mapping[Stream, list[tuple[int, str]]] = {
            stream: [(column, name) for column, name in enumerate(stream.channels) if name in _SPEEDS]
            for stream in streams
        }
        self._newest: dict[str, float] = {}
        self._heard_s = self._turned_s = now_s()

    def take(self, samples: Samples) -> None:
        """Look at the last of the samples."""
        columns = self._columns.get(samples.stream)
        if not columns or not len(samples.values):
            return
        for column, name in columns:
            value = float(samples.values[-1, column])
            if math.isfinite(value):  # not known is no rest
                self._newest[name] = value
                self._heard_s = self._now_s()
        if self.turns:
            self._turned_s = self._now_s()

    @property
    def turns(self) -> str:
        """Which speed says that the axle turns; '' if none does."""
        return turning(self._newest)

    @property
    def stands(self) -> bool:
        """Whether it has stood for long enough to be called at rest."""
        rested_s = self._now_s() - self._turned_s
        return bool(self._newest) and not self.turns and rested_s >= REST_S

    @property
    def silent(self) -> bool:
        """Whether no speed has come for too long."""
        return self._now_s() - self._heard_s > SILENT_S


def follow_run_down(
    bench: Bench, speeds: AxleSpeeds, longest_s: float, fault: Callable[[Exception], None], event: Event
) -> list[str]:
    """Let the bench be recorded until the axle stands, a time has passed, or somebody asks to stop once more.

    Call it when every device has confirmed its safe state. A device that leaves it is commanded again at
    once, with all others, and nothing more is waited for if one does not come back.

    Args:
        speeds: gets what is measured meanwhile.
        longest_s: of the bench's clock.
        fault: gets what is a mistake in a device's code.

    Returns:
        Complaints of devices that are no longer safe.

    Raises:
        HilError: a bus or the recording failed, or somebody asked for an emergency stop.
    """
    loop = bench.loop
    began_s = loop.clock.now_s()
    loop.run_for(2 * LOOK_S)
    if not speeds.turns or loop.stop_requested:
        return []
    event("run_down", f"begins, no device gives torque; {speeds.turns}")
    complaints: list[str] = []
    ended = ""
    try:
        while not ended:
            loop.run_for(LOOK_S)
            complaints = _kept_safe(bench, fault)
            ended = "; ".join(complaints) or _ended(loop, speeds, longest_s - (loop.clock.now_s() - began_s))
    finally:
        event("run_down", f"ends after {loop.clock.now_s() - began_s:.3g} s: {ended or 'interrupted'}")
    return [f"{complaint}, while the axle ran down" for complaint in complaints]


def _kept_safe(bench: Bench, fault: Callable[[Exception], None]) -> list[str]:
    """Complaints of devices that have left their safe state and did not come back to it."""
    try:
        if all(device.is_safe() for device in bench.devices):
            return []
    except Exception as error:  # a fault in a device's code: then nothing is known
        fault(error)
    return reach_safe_state(bench, fault)


def _ended(loop: BusLoop, speeds: AxleSpeeds, left_s: float) -> str:
    """Why nothing more is waited for; '' if the axle still runs down."""
    if speeds.stands:
        return "the axle stands"
    if loop.stop_requested:
        return f"stopped once more; {speeds.turns}"
    if speeds.silent:
        return "the speed is no longer measured"
    return f"not recorded any longer; {speeds.turns}" if left_s <= 0.0 else ""
