"""What to do after a diagnosis: the steps that its outcome asks for, the most urgent one first."""

from __future__ import annotations

from collections.abc import Iterator

from hil.analysis.diagnosis import NO_TEST, Alternative, Diagnosis
from hil.core.effects import EFFECTS
from reports.diagnosis_names import names_of
from reports.labels import channel_label
from reports.parts import Table

_RECORD = "chirps at two amplitudes, steps, torque reversals, a coast-down"
_HOLD = "hil diagnose … --holdout RECORDING"
_CHAIN = "hil run identification, then hil identify on its recording writes physical.toml"
_OWN = "write it as an effect of your own (docs/how-to/own-effect.md)"
_REPLAY = "hil simulate --model model.toml: it does not hold the vehicle, which a plan needs"
_USE = "hil tune PLAN --model model.toml; hil simulate; hil run --model model.toml"


def next_steps(found: Diagnosis) -> Table:
    """What to do, and how."""
    return Table(("what", "how"), tuple(_steps(found)), 2)


def _steps(found: Diagnosis) -> Iterator[tuple[str, str]]:
    if found.unfinished:
        yield "Let the search end: it was interrupted", "hil diagnose … --at-most MINUTES"
    if found.verdict == "unknown":
        yield from _unknown(found)
    for one in found.alternatives:
        yield from _apart(found, one)
    if found.open_channels and found.verdict == "named":
        names = " and ".join(channel_label(c).text.lower() for c in found.open_channels)
        yield f"Record more: more than noise stays in {names}, so something more is missing", _RECORD
    if found.held_out_open and not found.open_channels:
        yield (
            "Give the held-out recordings as recordings too, and hold others back: they show what is missing",
            _HOLD,
        )
    if not found.holdout_after:
        yield "Hold a recording back: these gaps are of data that were fitted", _HOLD
    if found.verdict != "unknown" and not (found.open_channels or found.held_out_open):
        yield "Go on with the new model", _REPLAY if found.model.load_input else _USE


def _unknown(found: Diagnosis) -> Iterator[tuple[str, str]]:
    if found.base.transfer_functions:
        yield "Get the chain: nothing can be added inside transfer functions", _CHAIN
    elif found.curves:
        yield f"Look at the torque that stays: it follows {found.curves[0].over}", _OWN
    else:
        yield "Look where the gap is, and record what excites it there", _RECORD


def _apart(found: Diagnosis, one: Alternative) -> Iterator[tuple[str, str]]:
    """How a rival is told from the name that it could stand for."""
    title = EFFECTS[one.use.id].title.lower()
    label = EFFECTS[one.use.id].label(one.use.values)
    for effect in found.effects or (None,):
        alike = effect is not None and label in effect.alike
        stands_for = effect is None or EFFECTS[effect.use.id].label(effect.use.values) == one.instead_of
        if not (alike or (one.plan and stands_for)):
            continue
        how = (
            one.separating_test
            if not one.separating_test.startswith(NO_TEST)
            else EFFECTS[one.use.id].shown_by
        )
        if one.plan:
            how = f"hil run {one.plan}, then diagnose again with its recording"
        if effect is None:
            yield f"Find out whether it is {title}", how
        else:
            yield f"Tell {names_of(effect).partition(' or ')[0]} from {title}", how
