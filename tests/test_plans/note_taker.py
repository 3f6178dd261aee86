"""A conductor that writes down what it is asked for, and keeps no bench."""

from __future__ import annotations

from pathlib import Path

from hil.core.vehicle import VehicleAndRoad
from test_plans import PROMPT_TIMEOUT_S, Array, PlannedSegment, Quantity, Work


class NoteTaker:
    def __init__(self) -> None:
        self.sample_time_s = 0.001
        self.calls: list[tuple[object, ...]] = []
        self.played: list[tuple[Quantity, Array, PlannedSegment | None]] = []

    def set_controller(self, file: Path) -> None:
        self.calls.append(("set_controller", file))

    def hold_speed(self, speed_m_s: float, duration_s: float) -> None:
        self.calls.append(("hold_speed", speed_m_s, duration_s))

    def set_vehicle(self, vehicle: VehicleAndRoad) -> None:
        self.calls.append(("set_vehicle", vehicle))

    def set_slip(self, slip: float) -> None:
        self.calls.append(("set_slip", slip))

    def release_vehicle(self) -> None:
        self.calls.append(("release_vehicle",))

    def play(self, quantity: Quantity, samples_nm: Array, segment: PlannedSegment | None) -> None:
        self.calls.append(("play", quantity, segment.id if segment else None))
        self.played.append((quantity, samples_nm, segment))

    def coast(self, duration_s: float) -> None:
        self.calls.append(("coast", duration_s))

    def wait(self, duration_s: float) -> None:
        self.calls.append(("wait", duration_s))

    def prompt(self, text: str, timeout_s: float = PROMPT_TIMEOUT_S, picture: str = "") -> None:
        self.calls.append(("prompt", text, picture) if picture else ("prompt", text))

    def ramp_down(self, duration_s: float) -> None:
        self.calls.append(("ramp_down", duration_s))

    def analyse(self, name: str, work: Work, makes: tuple[str, ...]) -> None:
        del work
        self.calls.append(("analyse", name, makes))
