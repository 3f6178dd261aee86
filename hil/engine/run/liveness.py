"""Whether what is measured is alive while the axle is under torque: below any plan, as the limits are.

A frame that keeps coming says that its sender runs, not that anybody measures. What a repetition of a value
proves is in `test_plans.evidence`; the judge asks the same of a recording.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from drivers import Samples, Stream
from hil.core.errors import BenchError
from test_plans.evidence import (
    FROZEN_BESIDE_WITNESS_S,
    FROZEN_S,
    LEAST_SAMPLES,
    SENSORS,
    WITNESSES,
    Repetition,
    least_motion,
)

#: What stands for a channel that no device measures.
_INSTEAD = {"wheel_speed_rad_s": "wheel_speed_left_rad_s"}


@dataclass
class _Witness:
    """Newest value and largest magnitude of a channel that moves others."""

    newest: float = np.nan
    largest: float = 0.0


@dataclass
class _Sensor:
    """A measured channel: its column, its witness, and how far that moved since the channel last changed.

    `beside` counts the samples since the witness has moved far enough to move the channel.
    """

    channel: str
    column: int
    witness: str
    lowest: float = np.inf
    highest: float = -np.inf
    beside: int = 0


@dataclass
class _Watched:
    stream: Stream
    sensors: list[_Sensor]
    repetition: Repetition = field(init=False)

    def __post_init__(self) -> None:
        self.repetition = Repetition(len(self.sensors))
        self.columns = np.array([sensor.column for sensor in self.sensors])


class LivenessWatch:
    """Follows every sensor's samples; `refuse_frozen` ends a run in which one repeats bit for bit."""

    def __init__(self, streams: Sequence[Stream]) -> None:
        channels = {channel for stream in streams for channel in stream.channels}
        self._witnesses: dict[str, _Witness] = {}
        self._watched: dict[Stream, _Watched] = {}
        for stream in streams:
            sensors = [
                _Sensor(name, column, self._witness_of(name, channels))
                for column, name in enumerate(stream.channels)
                if name in SENSORS
            ]
            if sensors:
                self._watched[stream] = _Watched(stream, sensors)

    def _witness_of(self, channel: str, channels: set[str]) -> str:
        name = WITNESSES[channel]
        name = name if name in channels else _INSTEAD.get(name, "")
        if name not in channels:
            return ""
        self._witnesses.setdefault(name, _Witness())
        return name

    def take(self, samples: Samples) -> None:
        """Look at samples, also before the axle is under torque: noise shows then."""
        for column, name in enumerate(samples.stream.channels):
            witness = self._witnesses.get(name)
            if witness is not None and len(samples.values):
                witness.newest = float(samples.values[-1, column])
                witness.largest = max(witness.largest, abs(witness.newest))
        watched = self._watched.get(samples.stream)
        if watched is None:
            return
        repetition = watched.repetition
        repetition.look(samples.values[:, watched.columns])
        for sensor, run in zip(watched.sensors, repetition.runs.tolist(), strict=True):
            if sensor.witness:
                self._follow(sensor, run, len(samples.values))

    def _follow(self, sensor: _Sensor, run: int, samples: int) -> None:
        """How far the witness has gone since the sensor last changed, and for how long it has been away."""
        if run < samples:
            sensor.lowest, sensor.highest, sensor.beside = np.inf, -np.inf, 0
        witness = self._witnesses[sensor.witness]
        sensor.lowest = min(sensor.lowest, witness.newest)
        sensor.highest = max(sensor.highest, witness.newest)
        if sensor.highest - sensor.lowest > least_motion(sensor.witness, witness.largest):
            sensor.beside += samples

    def refuse_frozen(self) -> None:
        """Call while the axle is under torque.

        Raises:
            BenchError: a sensor repeats for longer than its noise, or its neighbour's motion, allows.
        """
        for watched in self._watched.values():
            repetition, period_s = watched.repetition, watched.stream.period_s
            if int(np.max(repetition.runs)) < LEAST_SAMPLES:
                continue
            for place, sensor in enumerate(watched.sensors):
                run, noisy = int(repetition.runs[place]), bool(repetition.noisy[place])
                if run < LEAST_SAMPLES:
                    continue
                if noisy and run * period_s >= FROZEN_S:
                    self._refuse(sensor, watched.stream, run, "though it had noise before")
                moved = sensor.beside * period_s >= FROZEN_BESIDE_WITNESS_S
                if moved and repetition.values[place] != 0.0:
                    self._refuse(sensor, watched.stream, run, f"while {sensor.witness} moves")

    def _refuse(self, sensor: _Sensor, stream: Stream, run: int, shown: str) -> None:
        raise BenchError(
            f"{sensor.channel} repeats bit for bit for {run * stream.period_s * 1e3:.0f} ms, {shown}: it is "
            "no longer measured",
            where=f"{stream.label}, {stream.where}",
            fix="check the sensor, its amplifier and the end of its range",
        )
