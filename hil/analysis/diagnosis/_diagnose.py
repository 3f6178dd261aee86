"""The diagnosis as a whole: check the data, find what explains the gap, state it."""

from __future__ import annotations

import contextlib
import math
from collections.abc import Callable, Iterator, Mapping, Sequence

from hil.analysis.diagnosis.asked import Asked, stated_noise
from hil.analysis.diagnosis.data.sanity import examine
from hil.analysis.diagnosis.findings.assembly import diagnosis_of
from hil.analysis.diagnosis.findings.result import Diagnosis
from hil.analysis.missing_effects import explain_gap
from hil.analysis.plausible import refuse_same_data, within_floating_point
from hil.core.channels import ANGLES, OUTPUTS
from hil.core.errors import BadInputError
from hil.core.model import Model
from hil.core.recording import Recording
from hil.plant import by_angle
from hil.plant.sides import refuse_separate


def diagnose(
    model: Model,
    recordings: Sequence[Recording],
    holdout: Sequence[Recording] = (),
    *,
    noise: Mapping[str, float] | None = None,
    least: Mapping[str, float] | None = None,
    at_most_s: float = math.inf,
    show: Callable[[str], None] = lambda text: None,
) -> Diagnosis:
    """Say which effects `model` lacks to explain `recordings`, and by how much they close the gap.

    Args:
        model: a chain; or transfer functions, to which only effects of torque path and sensors can be added.
        holdout: recordings that no fit sees, only the final figures.
        noise: standard deviation of a sample that a channel's sensor is known to have, by channel; before
            what the recordings' bench files state.
        least: smallest size of an effect that is worth a name, by effect; others have sizes of their own.
        at_most_s: processor time of the search, s; what it knows by then is stated as `unfinished`.
        show: stated what is going on.

    An interrupt (KeyboardInterrupt) ends the search likewise; before anything is known, and while it is
    stated, it is raised.

    Raises:
        BadInputError: there is no recording; the recordings cannot belong to the model (inverted, swapped,
            dead, clipped, wrong gear ratio, values that no axle gives), hold the same data twice, have no
            output of the model, or differ in whether they have a speed or its angle.
    """
    if not recordings:
        raise BadInputError("there is no recording", fix="give at least one to be fitted")
    refuse_separate(model, "a diagnosis")
    refuse_same_data(recordings, holdout)
    _refuse_mixed([*recordings, *holdout])
    asked = Asked.checked({**stated_noise([*recordings, *holdout]), **(noise or {})}, least or {}, at_most_s)
    with within_floating_point(", ".join(str(r.source) for r in recordings)):
        show("reading the recordings")
        with _by_recorded_names([*recordings, *holdout]):
            fitted, still = examine(model, recordings)
            unseen, _ = examine(model, holdout, fitted)
        notes = _together([(one.name, note) for one in fitted for note in one.notes]) + still
        found = explain_gap(model, fitted, unseen, noise=asked.noise, at_most_s=asked.at_most_s, show=show)
        return diagnosis_of(found, model, asked, notes)


def _refuse_mixed(recordings: Sequence[Recording]) -> None:
    """Noise of a speed and of an angle are not one: a channel is either in all recordings that have it."""
    for column, speed in enumerate(OUTPUTS):
        turning = [str(one.source) for one in recordings if by_angle(one)[column]]
        going = [str(one.source) for one in recordings if speed in one]
        if turning and going:
            raise BadInputError(
                f"has {ANGLES[speed]} and no {speed}, and {going[0]} has that",
                where=turning[0],
                fix="give the same of the two in every recording; the angle, where the speed was made of it",
            )


def _together(notes: Sequence[tuple[str, str]]) -> list[str]:
    """Notes on recordings, each once, with the names of those that it is about."""
    about: dict[str, list[str]] = {}
    for name, note in notes:
        about.setdefault(note, []).append(name)
    return [f"{', '.join(dict.fromkeys(names))}: {note}" for note, names in about.items()]


@contextlib.contextmanager
def _by_recorded_names(recordings: Sequence[Recording]) -> Iterator[None]:
    """Refusals name the angle that was recorded, not the speed that was read from it."""
    try:
        yield
    except BadInputError as error:
        what = error.what
        for speed, angle in ANGLES.items():
            if any(angle in one and speed not in one for one in recordings):
                what = what.replace(speed, angle)
        if what == error.what:
            raise
        fix = f"{error.fix}; or is the angle in degrees, or in counts?" if error.fix else ""
        raise BadInputError(what, where=error.where, fix=fix) from error
