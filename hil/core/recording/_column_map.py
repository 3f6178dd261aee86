"""Which column of another tool's file is which channel: from options or a TOML file, alike for all commands.

[motor_speed_rad_s]
column = "n_EM"
unit = "rpm"
sign = -1
"""

from __future__ import annotations

import contextlib
import math
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from hil.core.channels import CHANNELS, TIME, unit_of
from hil.core.errors import BadInputError
from hil.core.errors.mistakes import Mistakes
from hil.core.errors.wording import did_you_mean, printable
from hil.core.files.toml_file import parse_toml, toml_text
from hil.core.units import UnitError, conversion

OPTION = "--columns"
_FORM = f"write {OPTION} FILE.toml, or {OPTION} 'CHANNEL=COLUMN, unit=rpm, sign=-1'"
_NUMBERS = ("scale", "offset", "gear", "wraps", "every_s")
_KEYS = ("column", "unit", "sign", *_NUMBERS, "missing", "derivative")
_NEXT_KEY = re.compile(rf",\s*(?=(?:{'|'.join(_KEYS)})\s*=)")


@dataclass(frozen=True)
class Source:
    """How a channel is computed from a column: sign · (scale · cell + offset) in `unit`, past the gear.

    Attributes:
        column: name in the file; '' only of a time that is counted (`every_s`).
        unit: of scale · cell + offset; '' for what the file says, else the channel's own.
        gear: ratio of a gear between the place of measurement and the channel's: angle and speed are divided
            by it, torque is multiplied.
        wraps: range of a counter or position that begins again, in the column's own numbers, or 0.
        missing: cells that mean that nothing was measured; empty if each number is one; None if not known.
        derivative: the channel is the slope of the column over time.
        every_s: distance of samples in s, of a file without time; 0 if it has one.
    """

    column: str
    unit: str = ""
    sign: float = 1.0
    scale: float = 1.0
    offset: float = 0.0
    gear: float = 1.0
    wraps: float = 0.0
    missing: tuple[float, ...] | None = None
    derivative: bool = False
    every_s: float = 0.0

    def as_json(self) -> dict[str, Any]:
        """What is not as it is by default."""
        plain = Source(self.column)
        chosen = {name: value for name, value in vars(self).items() if value != getattr(plain, name)}
        return {"column": self.column, **chosen}


@dataclass(frozen=True)
class ColumnMap:
    """Sources by channel; empty for files that name their columns as channels."""

    sources: Mapping[str, Source] = field(default_factory=dict)

    def __bool__(self) -> bool:
        return bool(self.sources)

    def columns(self) -> Iterator[tuple[str, Source]]:
        """Channels that have a column in the file, with their sources."""
        return ((channel, source) for channel, source in self.sources.items() if source.column)

    @property
    def every_s(self) -> float:
        """Distance of samples in s, where time is counted; else 0."""
        return self.sources[TIME].every_s if TIME in self.sources else 0.0


#: Of files that name their columns as channels.
AS_NAMED = ColumnMap()


def column_map(given: Sequence[str] | None) -> ColumnMap:
    """What options say, each a TOML file or CHANNEL=COLUMN with keys; of a channel the last one counts.

    Raises:
        BadInputError: a file or an option that cannot be understood; all mistakes of a file at once.
    """
    sources: dict[str, Source] = {}
    for text in given or ():
        if text.lower().endswith(".toml") and "=" not in text:
            sources |= _of_file(Path(text))
        else:
            channel, source = _of_option(text)
            sources[channel] = source
    _refuse_twice(sources)
    return ColumnMap(sources)


def _of_file(path: Path) -> dict[str, Source]:
    text = toml_text(path)
    mistakes = Mistakes()
    sources: dict[str, Source] = {}
    for channel, table in parse_toml(text, str(path), _FORM).items():
        with mistakes.of(channel):
            sources[channel] = _source(channel, {"column": table} if isinstance(table, str) else table)
    mistakes.refuse(str(path), text)
    if not sources:
        raise BadInputError(
            "names no channel", where=str(path), fix="write [motor_speed_rad_s] and column = …"
        )
    return sources


def _of_option(text: str) -> tuple[str, Source]:
    channel, equals, rest = text.partition("=")
    if not equals:
        raise BadInputError(f"'{printable(text, 60)}' has no '='", where=OPTION, fix=_FORM)
    column, *keys = _NEXT_KEY.split(f" {rest}")
    table: dict[str, Any] = {"column": column.strip()}
    for key in keys:
        name, _, value = (part.strip() for part in key.partition("="))
        if name in table:
            raise BadInputError(
                f"{name} stands twice", where=f"{OPTION} {printable(text, 60)}", fix="give it once"
            )
        table[name] = _value(name, value)
    channel = channel.strip()
    try:
        return channel, _source(channel, table)
    except BadInputError as error:
        raise BadInputError(error.what, where=f"{OPTION} {printable(text, 60)}", fix=error.fix) from None


def _value(name: str, text: str) -> Any:
    """A value of an option as TOML would give it."""
    if name in ("column", "unit"):
        return text
    if name == "derivative":
        return {"true": True, "false": False}.get(text.lower(), text)
    if name == "missing":
        return [_number_of(cell) for cell in text.split()]
    return _number_of(text)


def _number_of(text: str) -> Any:
    try:
        return float(text)
    except ValueError:
        return text


def _source(channel: str, table: Any) -> Source:
    """Raises:
    BadInputError: no channel, no such key, or a value that the key cannot have.
    """
    if not unit_of(channel):
        raise BadInputError(f"'{printable(channel, 40)}' is no channel", fix=did_you_mean(channel, CHANNELS))
    if not isinstance(table, dict):
        raise BadInputError(f"'{channel}' is no table", fix=f'write [{channel}] and column = "…"')
    for key in table:
        if key not in _KEYS:
            raise BadInputError(f"'{printable(key, 40)}' is no key of a column", fix=did_you_mean(key, _KEYS))
    values = {name: _finite(name, table[name]) for name in _NUMBERS if name in table}
    for name in ("gear", "scale"):
        if values.get(name) == 0.0:
            raise BadInputError(f"{name} is 0", fix="give the ratio")
    for name in ("wraps", "every_s"):
        if values.get(name, 1.0) <= 0.0:
            raise BadInputError(f"{name} is {values[name]:g}", fix="give what is above 0")
    source = Source(
        _text(table, "column"),
        _text(table, "unit"),
        sign=_sign(table),
        missing=_missing(table),
        derivative=_derivative(table),
    )
    source = replace(source, **values)  # type: ignore[arg-type]
    if not source.column and not (channel == TIME and source.every_s):
        raise BadInputError(f"'{channel}' has no column", fix=_FORM)
    if channel != TIME and source.every_s:
        raise BadInputError(f"every_s goes with {TIME}", fix="it is the distance of samples")
    _refuse_unit(channel, source)
    return source


def _text(table: Mapping[str, Any], key: str) -> str:
    value = table.get(key, "")
    if not isinstance(value, str):
        raise BadInputError(f"{key} is {printable(value, 40)}", fix="write it in quotation marks")
    return value.strip()


def _finite(key: str, value: Any) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
        raise BadInputError(f"{key} is '{printable(value, 40)}'", fix="give a number")
    return float(value)


def _sign(table: Mapping[str, Any]) -> float:
    value = table.get("sign", 1)
    if value not in (1, -1) or isinstance(value, bool):
        raise BadInputError(f"sign is '{printable(value, 40)}'", fix="1 or -1")
    return float(value)


def _missing(table: Mapping[str, Any]) -> tuple[float, ...] | None:
    if "missing" not in table:
        return None
    value = table["missing"]
    return tuple(_finite("missing", one) for one in (value if isinstance(value, list) else [value]))


def _derivative(table: Mapping[str, Any]) -> bool:
    value = table.get("derivative", False)
    if not isinstance(value, bool):
        raise BadInputError(f"derivative is '{printable(value, 40)}'", fix="true or false")
    return value


def _refuse_unit(channel: str, source: Source) -> None:
    """A unit that can never become the channel's is refused before a file is read."""
    if not source.unit:
        return
    try:
        conversion(source.unit, wanted_unit(channel, source))
    except UnitError as error:
        fix = fix_of(source.unit, wanted_unit(channel, source), error)
        raise BadInputError(f"'{channel}' {error.what}", fix=fix) from None


def fix_of(unit: str, wanted: str, error: UnitError) -> str:
    """What to do about a unit that does not become another; a position may give a speed."""
    if wanted.endswith("/s"):
        with contextlib.suppress(UnitError):
            conversion(unit, wanted.removesuffix("/s"))
            return "if it is a position, write derivative=true"
    return error.fix


def wanted_unit(channel: str, source: Source) -> str:
    """Unit that a column has to be converted to: the channel's, or of its integral."""
    unit = unit_of(channel)
    return unit.removesuffix("/s") if source.derivative else unit


def _refuse_twice(sources: Mapping[str, Source]) -> None:
    seen: dict[str, str] = {}
    for channel, source in sources.items():
        other = seen.setdefault(source.column, channel) if source.column else channel
        if other != channel:
            raise BadInputError(
                f"column '{printable(source.column, 40)}' is both '{other}' and '{channel}'",
                where=OPTION,
                fix="give each channel its own column, or leave one out",
            )
