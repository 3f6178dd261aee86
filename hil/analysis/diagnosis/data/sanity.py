"""Data that no physics can explain: refused by name before anything is fitted."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace

import numpy as np
import numpy.typing as npt

from hil.analysis.diagnosis.data.held import moves, refuse_held
from hil.analysis.diagnosis.data.mistakes import mistaken
from hil.analysis.diagnosis.thresholds import MOMENT_S, STANDSTILL_SHARE
from hil.analysis.missing_effects import Series, block_means, proven_noise, series_of
from hil.analysis.plausible import refuse_implausible
from hil.core.channels import INPUT, OUTPUTS
from hil.core.errors import BadInputError
from hil.core.model import Model
from hil.core.recording import Recording
from hil.plant import is_regulated

Array = npt.NDArray[np.float64]


def examine(
    model: Model, recordings: Sequence[Recording], beside: Sequence[Series] = ()
) -> tuple[list[Series], list[str]]:
    """Recordings as they come from a file made ready for fits, and notes on those that show no motion.

    Args:
        beside: others of the same channels: a coarse rounding shows better in many.

    Raises:
        BadInputError: a channel is dead, clipped, frozen, inverted, swapped with another or in another unit,
            the gear ratio is wrong, nothing moves, or a recording is too short or too slowly sampled.
    """
    for recording in recordings:
        refuse_implausible(recording)
    period_s = 1.0 / beside[0].rate_hz if beside else 0.0
    series = series_of(model, recordings, period_s) if recordings else []
    if not series:
        return [], []
    noise = proven_noise([*series, *beside], {})
    seen = [_as_recorded(one) for one in series]
    refuse_held(model, seen, noise, [_as_recorded(one) for one in beside])
    notes = _refuse_motionless(model, seen, noise, held_out=bool(beside))
    files = list(dict.fromkeys(one.source for one in seen))
    _refuse_each((file, mistaken(model, [s for s in seen if s.source == file], noise)) for file in files)
    if len(files) > 1 and (together := mistaken(model, seen, noise)) is not None:
        raise together
    return series, notes


def _as_recorded(one: Series) -> Series:
    """With a speed that is given to the model as a reading like others."""
    if not one.given.any():
        return one
    return replace(
        one, measured=block_means(one.samples, one.block), given=np.zeros(len(OUTPUTS), dtype=bool)
    )


def _refuse_each(found: Iterable[tuple[str, BadInputError | None]]) -> None:
    """Refuse the first mistake, with the files that have it, however right others beside them are."""
    wrong = {file: error for file, error in found if error is not None}
    for error in wrong.values():
        alike = [file for file, other in wrong.items() if _kind(other) == _kind(error)]
        raise BadInputError(error.what, where=", ".join(alike), fix=error.fix)


def _kind(error: BadInputError) -> str:
    """What is wrong, without its numbers."""
    return error.what.split(":")[0]


def _refuse_motionless(model: Model, series: Sequence[Series], noise: Array, *, held_out: bool) -> list[str]:
    """A note for each recording that tells nothing; without any that does there is nothing to explain."""
    driven = is_regulated(model)  # by what is not recorded
    moved = [any(moves(one, column, noise) for column in range(len(OUTPUTS))) for one in series]
    for one, moving in zip(series, moved, strict=True):
        if (
            moving
            and not driven
            and np.ptp(one.torque) == 0.0
            and one.load is None
            and not _slows_down(one, noise)
        ):
            raise BadInputError(
                f"{INPUT} looks dead: it reads {one.torque[0]:g} throughout, but the axle accelerates",
                where=one.source,
                fix="repair the channel, or omit the recording",
            )
    if not any(moved):
        names = [name for column, name in enumerate(OUTPUTS) if any(one.has[column] for one in series)]
        no_use, remedy = "nothing to diagnose", "check that the channel is connected, and"
        if held_out:
            no_use, remedy = "nothing to check a model by", "leave them out of the ones held out, or"
        raise BadInputError(
            f"no recording shows motion, so there is {no_use}: noise alone in {', '.join(names)}",
            where=", ".join(dict.fromkeys(one.source for one in series)),
            fix=f"{remedy} record a chirp or steps that move the axle",
        )
    still = [one.name for one, moving in zip(series, moved, strict=True) if not moving]
    return [f"{name}: no motion, not used" for name in still]


def _slows_down(one: Series, noise: Array) -> bool:
    """Whether no speed grows in magnitude by more than noise: the axle coasts."""
    length = max(1, round(MOMENT_S * one.rate_hz))
    for column in np.flatnonzero(one.has[:2]).tolist():
        count = len(one.measured) // length
        slow = np.abs(one.measured[: count * length, column].reshape(count, length).mean(axis=1))
        risen = slow - np.minimum.accumulate(slow)
        if count and np.max(risen) > max(5.0 * noise[column], STANDSTILL_SHARE * np.max(slow)):
            return False
    return True
