"""What a user knows or wants beside model and recordings."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from hil.core.channels import ANY_OUTPUT, OUTPUTS
from hil.core.effects import EFFECTS
from hil.core.errors import BadInputError
from hil.core.files.toml_file import parse_toml
from hil.core.recording import Recording

_BENCH_FILE, _TABLE = "bench.toml", "noise"


@dataclass(frozen=True)
class Asked:
    """`noise`: standard deviation of a sample that a channel's sensor is known to have, by channel.

    `least`: smallest size worth a name, by effect, in the unit of its first number. `at_most_s`: processor
    time that the search may take, s.
    """

    noise: dict[str, float]
    least: dict[str, float]
    at_most_s: float = math.inf

    @classmethod
    def checked(
        cls, noise: Mapping[str, float], least: Mapping[str, float], at_most_s: float = math.inf
    ) -> Asked:
        """What was asked.

        Raises:
            BadInputError: no such channel or effect, or a number that is no noise, size or time.
        """
        if not at_most_s > 0.0:
            raise BadInputError(
                f"a search time of {at_most_s / 60.0:g} min is not possible",
                where="--at-most",
                fix="give minutes above 0",
            )
        _refuse(noise, ANY_OUTPUT, ("--noise", "channel", "standard deviation"))
        _refuse(least, tuple(EFFECTS), ("--least", "effect", "size"))
        return cls(dict(noise), dict(least), at_most_s)


def _refuse(given: Mapping[str, float], known: tuple[str, ...], words: tuple[str, str, str]) -> None:
    option, what, number = words
    for name, value in given.items():
        if name not in known:
            raise BadInputError(f"unknown {what} '{name}'", where=option, fix=f"{what}s: {', '.join(known)}")
        if not (np.isfinite(value) and value >= 0.0):
            raise BadInputError(f"{name}={value:g}", where=option, fix=f"give a {number} from 0 up")


def stated_noise(recordings: Sequence[Recording]) -> dict[str, float]:
    """Standard deviation of a sample by channel, the largest that the recordings' bench files state.

    A recording without its bench file, or with one that is none, states nothing.
    """
    found: dict[str, float] = {}
    for recording in recordings:
        for channel, value in _table(recording).items():
            if not isinstance(value, int | float) or isinstance(value, bool):
                continue
            if channel in OUTPUTS and np.isfinite(value) and value >= 0.0:
                found[channel] = max(found.get(channel, 0.0), float(value))
    return found


def _table(recording: Recording) -> dict[str, object]:
    try:
        bench = parse_toml(recording.attachments.get(_BENCH_FILE, b"").decode(), _BENCH_FILE)
    except (UnicodeDecodeError, BadInputError):
        return {}
    table = bench.get(_TABLE)
    return table if isinstance(table, dict) else {}
