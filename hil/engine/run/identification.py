"""What devices say that they are, against what the bench file expects."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from drivers import DeviceTable, Identifies
from hil.core.errors import BenchError
from hil.core.result import Identity

_FIX = "load the software or calibration that is expected, or correct [{key}.expects] in the bench file"


def identities_of(key: str, table: DeviceTable, device: object) -> tuple[Identity, ...]:
    """What a device says, and what was expected of it and not answered.

    A name such as "software" under `expects` counts for the device and for each of its parts,
    "rear left: software" for that part.

    Args:
        key: of its table in the bench file.
    """
    answers: Mapping[str, str] = device.identify() if isinstance(device, Identifies) else {}
    found = [
        Identity(device=key, name=name, value=value, expected=_wanted(table, name))
        for name, value in answers.items()
    ]
    names = {part for name in answers for part in (name, name.rpartition(": ")[2])}
    unsaid = [
        Identity(device=key, name=name, value="", expected=wanted)
        for name, wanted in table.expects.items()
        if name not in names
    ]
    return (*found, *unsaid)


def _wanted(table: DeviceTable, name: str) -> str:
    return table.expects.get(name, table.expects.get(name.rpartition(": ")[2], ""))


def mismatch_in_words(identity: Identity) -> str:
    """What is wrong with one that does not match."""
    if not identity.value:
        return f"does not report its {identity.name}, the bench file expects {identity.expected}"
    return f"{identity.name} is {identity.value}, the bench file expects {identity.expected}"


def what_to_do(identity: Identity) -> str:
    """About one that does not match."""
    return _FIX.format(key=identity.device)


def refuse_others(identities: Iterable[Identity]) -> None:
    """Raises:
    BenchError: a device is not what the bench file expects.
    """
    wrong = [identity for identity in identities if not identity.matches]
    if wrong:
        text = "; ".join(f"{identity.device}: {mismatch_in_words(identity)}" for identity in wrong)
        raise BenchError(text, where="identification", fix=what_to_do(wrong[0]))
