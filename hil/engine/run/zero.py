"""What sensors read while nothing moves: before the drives are enabled, and after they are off again."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence

import numpy as np

from drivers import BusLoop, Samples, Stream
from hil.core.channels import CHANNELS
from hil.core.errors import BenchError
from hil.core.result import Zero
from hil.engine.bench.bench_tables import ZeroLimit

REST_S = 0.2  # over so long a mean is taken
SETTLE_S = 0.3  # what swings when the drives are switched off has died away
STANDSTILL_WITHIN_S = 1.0
_SILENT = "nothing came"
#: Slower than this is rest: an offset of a speed sensor is less, a wheel that turns more.
STANDSTILL_RAD_S = 0.5
#: Sensors of the axle; others are looked at if the bench file limits them.
SENSORS = (
    "motor_speed_rad_s",
    "wheel_speed_left_rad_s",
    "wheel_speed_right_rad_s",
    "shaft_torque_left_nm",
    "shaft_torque_right_nm",
)
_FIX = (
    "zero the sensor's amplifier, and check the shafts for locked-in torque; "
    "the limit is under [zero] in the bench file"
)


class ZeroCheck:
    """Reads the sensors at rest, before and after a run. `zeros` is what is known so far."""

    def __init__(self, streams: Sequence[Stream], limits: Mapping[str, ZeroLimit]) -> None:
        self._limits = limits
        self._units = {
            name: CHANNELS[name].unit if name in CHANNELS else unit
            for stream in streams
            for name, unit in zip(stream.channels, stream.units, strict=True)
            if name in SENSORS or name in limits
        }
        self._sums: dict[str, tuple[float, int]] = {}
        self._active = False
        self._before: dict[str, float] = {}
        self.zeros: tuple[Zero, ...] = ()

    def begin(self) -> None:
        """Take samples from now on, and forget earlier ones."""
        self._sums, self._active = {}, True

    def take(self, samples: Samples) -> None:
        """Add samples of any stream."""
        if not self._active:
            return
        for column, name in enumerate(samples.stream.channels):
            if name in self._units:
                total, count = self._sums.get(name, (0.0, 0))
                values = samples.values[:, column]
                self._sums[name] = total + float(np.sum(values)), count + len(values)

    def before(self) -> None:
        """Nothing has been enabled yet: what came since `begin` came at rest.

        Raises:
            BenchError: a sensor reads more than the bench file allows, or cannot be read.
        """
        readings = self._means()
        moving = turning(readings)
        self._before = {} if moving else readings
        self.zeros = self._zeros_after({}, moving or _SILENT)
        refuse_offsets(self.zeros)

    def after(self, loop: BusLoop, *, ended_well: bool) -> None:
        """The drives are off again: let what swings die away, and read once more.

        Raises:
            BenchError: a sensor has changed by more than the bench file allows, or a bus fails.
        """
        if not self.zeros:
            return
        if not ended_well:
            self.zeros = self._zeros_after({}, "the bench failed: nothing was read after the run")
            return
        loop.run_for(SETTLE_S)
        readings: dict[str, float] = {}
        for _ in range(round(STANDSTILL_WITHIN_S / REST_S)):
            self.begin()
            loop.run_for(REST_S)
            readings = self._means()
            if not turning(readings):
                break
        moving = turning(readings)
        self.zeros = self._zeros_after({} if moving else readings, moving or _SILENT)
        refuse_drift(self.zeros)

    def _means(self) -> dict[str, float]:
        """Of what has come; a channel of which nothing came, or nothing known, is left out."""
        self._active = False
        means = {name: total / count for name, (total, count) in self._sums.items() if count}
        return {name: mean for name, mean in means.items() if math.isfinite(mean)}

    def _zeros_after(self, after: Mapping[str, float], reason: str) -> tuple[Zero, ...]:
        return tuple(
            zero_of(name, unit, self._limits.get(name), self._before.get(name), after.get(name), reason)
            for name, unit in self._units.items()
        )


def zero_of(
    channel: str, unit: str, limit: ZeroLimit | None, before: float | None, after: float | None, reason: str
) -> Zero:
    """A sensor's readings beside what the bench file allows."""
    return Zero(
        channel=channel,
        unit=unit,
        before=None if before is None else round(before, 6) + 0.0,
        after=None if after is None else round(after, 6) + 0.0,
        within=limit.within if limit else None,
        drift_within=limit.drift if limit else None,
        reason=reason if before is None or after is None else "",
    )


def turning(readings: Mapping[str, float]) -> str:
    """Which speed says that the axle turns; '' if it stands still."""
    for name, value in readings.items():
        if name in SENSORS and name.endswith("rad_s") and abs(value) > STANDSTILL_RAD_S:
            return f"the axle turns: {name} reads {value:.3g} rad/s"
    return ""


def offset_in_words(zero: Zero) -> str:
    """What is wrong with the reading before a run."""
    if zero.before is None:
        return f"{zero.channel} cannot be read at rest: {zero.reason}"
    reads = f"{zero.channel} reads {zero.before:.4g} {zero.unit} at rest"
    return f"{reads}, the bench file allows {zero.within:g} {zero.unit}"


def drift_in_words(zero: Zero) -> str:
    """What is wrong with the change since."""
    return (
        f"{zero.channel} has drifted by {zero.drift:.4g} {zero.unit} during the run, "
        f"the bench file allows {zero.drift_within:g} {zero.unit}"
    )


def what_to_do() -> str:
    """About a sensor that is not at zero."""
    return _FIX


def refuse_offsets(zeros: Iterable[Zero]) -> None:
    """Raises:
    BenchError: a sensor reads more at rest than the bench file allows, or cannot be read.
    """
    wrong = [offset_in_words(zero) for zero in zeros if not zero.offset_fits]
    if wrong:
        raise BenchError("; ".join(wrong), where="zero check", fix=_FIX)


def refuse_drift(zeros: Iterable[Zero]) -> None:
    """Raises:
    BenchError: a sensor has changed by more than the bench file allows.
    """
    wrong = [drift_in_words(zero) for zero in zeros if not zero.drift_fits]
    if wrong:
        raise BenchError(
            "; ".join(wrong), where="zero check", fix="the results of this run are not reliable; " + _FIX
        )
