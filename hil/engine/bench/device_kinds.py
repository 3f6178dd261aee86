"""The tables of a bench file that describe devices: each is checked by the kind of device that it names."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from drivers import OWN_KINDS, DeviceTable, LoadTable
from hil.core.can.symbol_files import LARGEST_BYTES
from hil.core.errors import BadInputError
from hil.core.errors.mistakes import mistakes_of
from hil.core.errors.wording import printable
from hil.core.files import read_bytes
from hil.core.recording import DEVICE
from test_plans.registry import Registry

#: Kinds of device by name; those of other packages are entry points of `hil.devices`.
KINDS: Registry[DeviceTable] = Registry("kind of device", "hil.devices", DeviceTable, OWN_KINDS)

#: Kinds of the tables that need not name theirs.
DEFAULT_KINDS = {"rmcu": "rmcu-can", "dyno": "rcs-canopen"}


def descriptions_of(device: str, files: Iterable[Path]) -> dict[str, bytes]:
    """What says what a device's frames mean, by the names of a recording's attachments.

    Raises:
        BadInputError: a file cannot be read, or is larger than any that describes a device.
    """
    return {f"{DEVICE}{device}/{path.name}": read_bytes(path, LARGEST_BYTES) for path in files}


def device_tables(data: dict[str, Any]) -> tuple[dict[str, Any], list[str]]:
    """The device tables of a bench file's contents, checked, and what is wrong with them.

    A table with a mistake stays as it is.
    """
    mistakes: list[str] = []
    found: dict[str, Any] = {}
    for key, default in DEFAULT_KINDS.items():
        if isinstance(data.get(key), dict):
            found[key] = _checked(key, data[key], default, mistakes)
    if isinstance(found.get("dyno"), DeviceTable) and not isinstance(found["dyno"], LoadTable):
        mistakes.append(f"dyno.kind = '{found['dyno'].kind}': is not a dyno device; move it to [devices]")
    if isinstance(data.get("devices"), dict):
        found["devices"] = {
            name: _checked(f"devices.{printable(name, 60)}", table, "", mistakes)
            for name, table in data["devices"].items()
        }
    return found, mistakes


def _checked(key: str, table: Any, default: str, mistakes: list[str]) -> Any:
    """The table as its kind has it; itself if something is wrong with it, which is added to `mistakes`."""
    if not isinstance(table, dict):
        return table  # refused with the whole file
    kind = table.get("kind", default)
    if not isinstance(kind, str) or not kind:
        wrong = f" = {printable(repr(kind), 60)}: is not a kind" if "kind" in table else ": is missing"
        mistakes.append(f"{key}.kind{wrong}; known: {', '.join(KINDS.names())}")
        return table
    try:
        found = KINDS.find(kind)
    except BadInputError as error:
        mistakes.append(f"{key}.kind = '{printable(kind, 60)}': {error.where}: {error.what}; {error.fix}")
        return table
    if found is None:
        known = printable(KINDS.suggestion(kind), 300)
        mistakes.append(f"{key}.kind = '{printable(kind, 60)}': no installed package provides it; {known}")
        return table
    try:
        return found.model_validate({**table, "kind": kind})
    except ValidationError as error:
        mistakes += mistakes_of(error, found, key)
        return table
