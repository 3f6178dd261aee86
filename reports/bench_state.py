"""In what state the bench was: which software and calibration its devices said that they run."""

from __future__ import annotations

from hil.core.recording import Recording
from hil.core.result import Identity, RunResult
from reports.provenance import Fact

TABLE = "identification"


def identification_facts(recording: Recording, result: RunResult | None) -> tuple[Fact, ...]:
    """What each device, or each part of one, said that it is; without a result from the recording alone."""
    if result is not None:
        identities = result.identities
    else:
        said = recording.metadata.get(TABLE, {})
        identities = tuple(_identity(key, value) for key, value in said.items())
    parts: dict[str, list[Identity]] = {}
    for identity in identities:
        part = identity.name.rpartition(": ")[0]
        parts.setdefault(f"{identity.device}, {part}" if part else identity.device, []).append(identity)
    return tuple(Fact(part, _told(found), _state(found)) for part, found in parts.items())


def _identity(key: str, value: str) -> Identity:
    device, _, name = key.partition(": ")
    return Identity(device=device, name=name, value=value)


def _told(identities: list[Identity]) -> str:
    said = []
    for identity in identities:
        text = f"{identity.name.rpartition(': ')[2]} {identity.value or 'not said'}"
        said.append(text if identity.matches else f"{text} ({identity.expected} was expected)")
    return ", ".join(said)


def _state(identities: list[Identity]) -> str:
    if not all(identity.matches for identity in identities):
        return "bad"
    return "good" if any(identity.expected for identity in identities) else ""
