"""What the report of a diagnosis says of names: those given, those rejected, those as likely."""

from __future__ import annotations

from collections.abc import Mapping

from hil.analysis.diagnosis import BOOTSTRAP_DRAWS, Diagnosis, NamedEffect
from hil.core.digits import multiple
from hil.core.effects import EFFECTS
from reports import quantities
from reports.labels import channel_label
from reports.parts import Table

_MOST_CONSIDERED = 20
_BEYOND_DOUBT = 1e6  # noise variances


def effects_text(found: Diagnosis) -> str:
    """What each named effect is, and against what chance gave it stands."""
    if not found.effects:
        return "None."
    effects = [EFFECTS[id_] for id_ in dict.fromkeys(e.use.id for e in found.effects)]
    said = " ".join(f"{e.title}: {e.summary} Known by: {_lowered(e.signature)}" for e in effects)
    drops = [e.drop for e in found.effects if e.drop is not None]
    if not drops or found.by_chance is None:
        return said
    chance = quantities.number(float(f"{found.by_chance:.2g}"), significant=2)
    return (
        f"{said} Evidence: in {BOOTSTRAP_DRAWS} draws of noise alone no effect took more than {chance} "
        "noise variances off the squared error; each named one takes "
        f"{_beyond_chance(min(drops), found.by_chance)}."
    )


def _lowered(sentence: str) -> str:
    return f"{sentence[:1].lower()}{sentence[1:]}"


def _beyond_chance(drop: float, chance: float) -> str:
    """The smallest drop against what noise alone gave."""
    if chance <= 0.0:
        return f"{_evidence(drop)} or more"
    return f"{multiple(drop / chance)} as much or more"


def effects_table(found: Diagnosis) -> Table:
    """Numbers, errors, confidence and place of each named effect."""
    rows = []
    for e in found.effects:
        units = {p.name: p.unit for p in EFFECTS[e.use.id].parameters}
        for index, (name, value) in enumerate(e.use.values.items()):
            shown = value if isinstance(value, str) else quantities.quantity(value, units.get(name, ""))
            error = e.standard_error.get(name)
            rows.append(
                (
                    EFFECTS[e.use.id].title if index == 0 else "",
                    name,
                    shown,
                    quantities.number(error, significant=2) if error is not None else "",
                    quantities.chance(e.confidence) if index == 0 else "",
                    _place(e) if index == 0 else "",
                )
            )
    return Table(("effect", "parameter", "value", "standard error", "confidence", "where"), tuple(rows), 2, 5)


def _place(effect: NamedEffect) -> str:
    low, high = effect.where.band_hz
    channels = ", ".join(channel_label(c).text.lower() for c in effect.where.channels)
    return f"{channels}; {low:g}-{high:g} Hz; {effect.where.condition}"


def considered_table(found: Diagnosis) -> Table:
    """What was looked at and not named, the likeliest first."""
    rows = tuple(
        (
            c.id + (f" ({c.about})" if c.about else ""),
            _evidence(c.score),
            quantities.factor(c.left),
            c.reason,
        )
        for c in found.considered[:_MOST_CONSIDERED]
    )
    return Table(("effect", "expected drop", "gap left / noise", "why not"), rows, 1, 3)


def _evidence(drop: float) -> str:
    """A drop in noise variances; beyond what anybody would doubt it says that alone."""
    return f">{quantities.THIN}10⁶" if drop >= _BEYOND_DOUBT else quantities.number(drop, significant=2)


def alternatives_table(found: Diagnosis) -> Table:
    """Other names for the same gap, each with the test that separates it."""
    rows = tuple(
        (_about(a.use.id, a.use.values), quantities.chance(a.confidence), a.separating_test, a.plan or "")
        for a in found.alternatives
    )
    return Table(("effect", "confidence", "separating test", "plan for hil run"), rows, 1, 2)


def _about(id_: str, values: Mapping[str, float | str]) -> str:
    """An effect's id, with the channel or parameter that it speaks of."""
    about = values.get("channel", values.get("parameter"))
    return f"{id_} ({about})" if about else id_
