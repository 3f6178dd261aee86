"""In what state the bench was: software and calibration of its devices, sensors at rest."""

from __future__ import annotations

from hil.core.recording import Recording
from hil.core.result import Identity, RunResult, Zero
from reports import labels
from reports.provenance import Fact

TABLE = "identification"


def identification_facts(recording: Recording, result: RunResult | None) -> tuple[Fact, ...]:
    """What each device, or each part of one, identified as; without a result from the recording alone."""
    if result is not None:
        identities = result.identities
    else:
        values = recording.metadata.get(TABLE, {})
        identities = tuple(_identity(key, value) for key, value in values.items())
    parts: dict[str, list[Identity]] = {}
    for identity in identities:
        part = identity.name.rpartition(": ")[0]
        parts.setdefault(f"{identity.device}, {part}" if part else identity.device, []).append(identity)
    return tuple(Fact(part, _in_words(found), _state(found)) for part, found in parts.items())


def _identity(key: str, value: str) -> Identity:
    device, _, name = key.partition(": ")
    return Identity(device=device, name=name, value=value)


def _in_words(identities: list[Identity]) -> str:
    lines = []
    for identity in identities:
        text = f"{identity.name.rpartition(': ')[2]} {identity.value or 'not values'}"
        lines.append(text if identity.matches else f"{text} ({identity.expected} was expected)")
    return ", ".join(lines)


def _state(identities: list[Identity]) -> str:
    if not all(identity.matches for identity in identities):
        return "bad"
    return "good" if any(identity.expected for identity in identities) else ""


def zero_facts(result: RunResult | None) -> tuple[Fact, ...]:
    """What each sensor read at rest before and after the run, beside what the bench file allows."""
    zeros = result.zeros if result is not None else ()
    return tuple(Fact(zero.channel, _readings(zero), _zero_state(zero)) for zero in zeros)


def _readings(zero: Zero) -> str:
    if zero.before is None:
        return f"not read: {zero.reason}"
    unit = zero.unit
    offset = f"{labels.quantity(zero.before, unit, 3)} before ({_allowed(zero.within, unit)})"
    if zero.after is None or zero.drift is None:
        return f"{offset}; not read after: {zero.reason}"
    drift = f"drift {labels.quantity(zero.drift, unit, 3)} ({_allowed(zero.drift_within, unit)})"
    return f"{offset}, {labels.quantity(zero.after, unit, 3)} after: {drift}"


def _allowed(limit: float | None, unit: str) -> str:
    return "no limit stated" if limit is None else f"limit {labels.nominal(limit)} {unit}"


def _zero_state(zero: Zero) -> str:
    if not (zero.offset_fits and zero.drift_fits):
        return "bad"
    return "good" if zero.within is not None or zero.drift_within is not None else ""
