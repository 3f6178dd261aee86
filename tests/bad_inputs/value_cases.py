"""Numbers out of range: of every numeric option, and in plans, bench files and models."""

from __future__ import annotations

import functools
from collections.abc import Iterator
from pathlib import Path

from tests.bad_inputs.case import DONE, FAILED, REFUSED, VALUES, Case
from tests.bad_inputs.commands import NUMBERS, usual

_NEVER = ("nan", "inf", "many")
_PERHAPS = ("0", "-1", "1e308")  # may be in range for some options
_FILES = (
    ("check", "plan.yaml", "amplitude_nm: 10", "amplitude_nm: {}", ()),
    ("check", "plan.yaml", "duration_s: 2", "duration_s: {}", ()),
    ("check", "plan.yaml", "to_hz: 30", "to_hz: {}", ()),
    ("check", "plan.yaml", "upper: 300", "upper: {}", ("0", "-1", "1e308")),
    ("run", "bench.toml", "shaft_torque_nm = 1200.0", "shaft_torque_nm = {}", ()),
    ("run", "bench.toml", "persistence_s = 0.005", "persistence_s = {}", ("0",)),
    ("run", "bench.toml", "wheel_radius_m = 0.33", "wheel_radius_m = {}", ()),
    ("run", "bench.toml", "bit_rate = 1000000", "bit_rate = {}", ()),
    ("run", "bench.toml", "seed = 1", "seed = {}", ("0",)),
    ("simulate", "model.toml", "motor_inertia = 0.0200", "motor_inertia = {}", ("1e308",)),
    ("simulate", "model.toml", "torque_delay = 0.008", "torque_delay = {}", ("0", "1e-308", "1e308")),
    ("design", "model.toml", "shaft_stiffness = 6089.0", "shaft_stiffness = {}", ("1e308",)),
    ("diagnose", "model.toml", "gear_ratio = 8.148", "gear_ratio = {}", ("1e308",)),
)


def value_cases() -> Iterator[Case]:
    """Each number with each wrong value; what may be right is only to end without a fault."""
    for command, options in NUMBERS.items():
        for option in options:
            for value in (*_NEVER[: 1 if option != options[0] else None], *_PERHAPS):
                allowed = (REFUSED,) if value in _NEVER else (DONE, REFUSED)
                yield Case(
                    command, VALUES, f"{option}={value}", (*usual(command), f"{option}={value}"), allowed
                )
    for command, file, old, new, in_range in _FILES:
        for value in (*_NEVER[:1], *_PERHAPS):
            ends: tuple[int, ...] = (DONE, FAILED, REFUSED) if value in in_range else (REFUSED,)
            shown = value if file.endswith(".yaml") or value != "many" else '"many"'
            if file.endswith(".yaml") and value in ("nan", "inf"):
                shown = f".{value}"
            tried = f"{file}: {new.format(shown)}"
            change = functools.partial(_replace, file, old, new.format(shown))
            # A limit that no run can keep is a limit: it trips.
            if value in in_range and command == "run":
                ends = (*ends, 3)
            yield Case(command, VALUES, tried, usual(command), ends, change)


def _replace(name: str, old: str, new: str, folder: Path) -> None:
    path = folder / name
    text = path.read_text("utf-8")
    assert old in text, old
    path.write_text(text.replace(old, new, 1), "utf-8")
