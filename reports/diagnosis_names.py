"""What the report of a diagnosis says of names: those given, and those as likely."""

from __future__ import annotations

from collections.abc import Mapping

from hil.analysis.diagnosis import Diagnosis, NamedEffect
from hil.core.channels import CHANNELS
from hil.core.effects import EFFECTS
from hil.core.model import parameter_unit
from reports import labels
from reports.labels import capitalised, channel_label, parameter_title, with_titles
from reports.parts import Table


def effects_text(found: Diagnosis) -> str:
    """What each named effect is, and where it is seen."""
    if not found.effects:
        return "None."
    effects = [EFFECTS[id_] for id_ in dict.fromkeys(e.use.id for e in found.effects)]
    laws = [f"{e.title}: {e.summary} Known by: {_lowered(e.signature)}" for e in effects]
    seen = [f"{capitalised(names_of(e))} is seen in {_place(e)}." for e in found.effects]
    return " ".join((*laws, *seen))


def names_of(effect: NamedEffect) -> str:
    """An effect's title, and those of the names that the data cannot tell from it."""
    return " or ".join(
        (_titled(EFFECTS[effect.use.id].label(effect.use.values)), *map(_together, effect.alike))
    )


def _together(names: str) -> str:
    """One name or several that go together; of one effect by all of its channels."""
    titles, about = zip(*map(_in_words, names.split(" + ")), strict=True)
    if len(about) == 1 or len({*titles}) > 1:
        return " and ".join(map(_titled, names.split(" + ")))
    return f"the same {titles[0]} of {', '.join(about[:-1])} and {about[-1]}"


def _titled(label: str) -> str:
    """`sensor_lag(motor_speed_rad_s)` or `parameter_mismatch(gear_ratio)` in words."""
    title, about = _in_words(label)
    return f"{title} of {about}" if about else title


def _in_words(label: str) -> tuple[str, str]:
    """An effect's title, and the channel or parameter that it speaks of, if any."""
    id_, _, about = label.rstrip(")").partition("(")
    named = with_titles(about) if about in CHANNELS else parameter_title(about) if about else ""
    return EFFECTS[id_].title.lower(), named


def _lowered(sentence: str) -> str:
    return f"{sentence[:1].lower()}{sentence[1:]}"


def effects_table(found: Diagnosis) -> Table:
    """Numbers, errors and confidence of each named effect; what is in its name stands there."""
    rows = []
    for e in found.effects:
        units = {p.name: p.unit for p in EFFECTS[e.use.id].parameters}
        if "parameter" in e.use.values:
            units["value"] = parameter_unit(str(e.use.values["parameter"]))
        numbers = [(name, value) for name, value in e.use.values.items() if not isinstance(value, str)]
        for index, (name, value) in enumerate(numbers):
            error = e.standard_error.get(name)
            rows.append(
                (
                    capitalised(names_of(e)) if index == 0 else "",
                    parameter_title(name),
                    labels.quantity(value, units.get(name, "")),
                    labels.number(error, significant=2) if error is not None else "",
                    labels.chance(e.confidence) if index == 0 else "",
                )
            )
    return Table(("effect", "parameter", "value", "standard error", "confidence"), tuple(rows), 2)


def _place(effect: NamedEffect) -> str:
    low, high = effect.where.band_hz
    channels = ", ".join(channel_label(c).text.lower() for c in effect.where.channels)
    return f"{channels}; {low:g}-{high:g} Hz; {effect.where.condition}"


def alternatives_table(found: Diagnosis) -> Table:
    """Other names for the same gap, each with the test that separates it."""
    rows = tuple(
        (_about(a.use.id, a.use.values), labels.chance(a.confidence), a.separating_test, a.plan or "")
        for a in found.alternatives
    )
    return Table(("effect", "confidence", "separating test", "plan for hil run"), rows, 1, 2)


def _about(id_: str, values: Mapping[str, float | str]) -> str:
    """An effect's id, with the channel or parameter that it speaks of."""
    about = values.get("channel", values.get("parameter"))
    return f"{id_} ({about})" if about else id_
