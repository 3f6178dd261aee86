"""Whether mistakes in recordings are refused by their name, and good recordings never.

    python -m benchmarks.mistakes [--every 18] [--seed 105]

Cases are those of the blind set, each from its own base, and from one of half and of three times all
inertias. Good recordings are asked one by one and all together; in the last of each, every mistake is made in
turn.
"""

from __future__ import annotations

import argparse
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt

from benchmarks.missing_effects import blind_cases, with_inertias
from hil.analysis.diagnosis import examine
from hil.core.channels import INPUT, OUTPUTS, TIME
from hil.core.errors import BadInputError
from hil.core.model import Model
from hil.core.recording import Recording

Array = npt.NDArray[np.float64]
Channels = dict[str, Array]
Change = Callable[[Channels], Channels]

MOTOR, WHEEL, SHAFT = OUTPUTS
_RPM = 60.0 / (2.0 * np.pi)
_FROZEN_S = 2.0


@dataclass(frozen=True)
class Mistake:
    """A mistake made in a recording that has the channels `of`; a refusal by its name has all `words`."""

    name: str
    make: Change
    words: tuple[str, ...]
    of: tuple[str, ...]


def scaled(factor: float, *names: str) -> Change:
    """Channels times a factor."""
    return lambda channels: {**channels, **{name: factor * channels[name] for name in names}}


def swapped(channels: Channels) -> Channels:
    """Both speeds exchanged."""
    return {**channels, MOTOR: channels[WHEEL], WHEEL: channels[MOTOR]}


def noise_alone(name: str) -> Change:
    """A channel of noise, about as much as it has."""

    def make(channels: Channels) -> Channels:
        values = channels[name]
        level = float(np.median(np.abs(np.diff(values)))) / 0.954 + 1e-9
        return {**channels, name: np.random.default_rng(0).normal(0.0, level, len(values))}

    return make


def frozen(name: str) -> Change:
    """A channel that stays for two seconds."""

    def make(channels: Channels) -> Channels:
        values, first = channels[name].copy(), len(channels[name]) // 3
        values[first : first + round(_FROZEN_S / float(np.median(np.diff(channels[TIME]))))] = values[first]
        return {**channels, name: values}

    return make


def clipped(name: str) -> Change:
    """A channel of half its range."""

    def make(channels: Channels) -> Channels:
        values = channels[name]
        half = 0.5 * max(float(np.ptp(values - np.median(values))) / 2.0, 1e-9)
        middle = 0.5 * float(np.max(values) + np.min(values))
        return {**channels, name: np.clip(values, middle - half, middle + half)}

    return make


def mistakes() -> Iterator[Mistake]:
    """Each that is made."""
    for name in (*OUTPUTS, INPUT):
        yield Mistake(f"{name} inverted", scaled(-1.0, name), (name, "inverted"), (name,))
    yield Mistake("both speeds inverted", scaled(-1.0, MOTOR, WHEEL), ("inverted",), (MOTOR, WHEEL))
    yield Mistake("speeds swapped", swapped, ("swapped",), (MOTOR, WHEEL))
    for names in ((MOTOR,), (WHEEL,), (MOTOR, WHEEL)):
        yield Mistake(f"{' and '.join(names)} in rpm", scaled(_RPM, *names), (*names, "rpm"), (MOTOR, WHEEL))
    for names in ((SHAFT,), (INPUT,), (INPUT, SHAFT)):
        yield Mistake(f"{' and '.join(names)} in kN m", scaled(1e-3, *names), (*names, "kN m"), names)
    for name in OUTPUTS:
        yield Mistake(f"{name} of noise alone", noise_alone(name), (name, "dead"), OUTPUTS)
        yield Mistake(f"{name} frozen", frozen(name), (name, "frozen"), (name,))
        yield Mistake(f"{name} clipped", clipped(name), (name, "clipped"), (name,))


def bases(model: Model) -> Iterator[Model]:
    """A model, and with half and three times all its inertias."""
    return (with_inertias(model, factor) for factor in (1.0, 0.5, 3.0))


def refusal(model: Model, recordings: Sequence[Recording]) -> str:
    """What is said against recordings; nothing where they are taken."""
    try:
        examine(model, recordings)
    except BadInputError as error:
        return error.what
    return ""


def main(arguments: Sequence[str] | None = None) -> int:
    """Print good recordings that were refused, and how many of each mistake were refused by its name."""
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks.mistakes",
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("--every", type=int, default=18, help="of the blind set's cases")
    parser.add_argument("--seed", type=int, default=105, help="of the blind set")
    options = parser.parse_args(arguments)
    good, wrongly = 0, 0
    asked, refused, named = Counter[str](), Counter[str](), Counter[str]()
    for case in blind_cases(options.seed, options.every):
        recordings = [*case.recordings, *case.holdout]
        last = recordings[-1]
        for model in bases(case.model):
            for group in (*([one] for one in recordings), recordings):
                good += 1
                said = refusal(model, group)
                if said and "no recording shows motion" not in said:
                    wrongly += 1
                    print(f"refused though good: {case.name}: {said}", flush=True)
            for mistake in mistakes():
                if all(name in last for name in mistake.of):
                    channels = mistake.make({name: last[name] for name in last.channels})
                    said = refusal(model, [Recording(channels, Path("last.csv"))])
                    asked[mistake.name] += 1
                    refused[mistake.name] += bool(said)
                    named[mistake.name] += bool(said) and all(word in said for word in mistake.words)
    print(f"good recordings, one by one and together, from three bases: {wrongly} of {good} refused")
    print(f"{'mistake':<52}{'made':>6}{'refused':>9}{'by name':>9}")
    for name, count in asked.items():
        print(f"{name:<52}{count:>6}{refused[name]:>9}{named[name]:>9}")
    print(f"{'all':<52}{asked.total():>6}{refused.total():>9}{named.total():>9}")
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
