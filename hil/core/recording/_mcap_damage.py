"""What is missing from a recording or cannot be trusted, in sentences with times."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np

from hil.core.recording._stored import Times

#: Metadata table that closes a recording: SHA-256 of its samples, and how many they are.
CHANNELS_TABLE = "channels"
#: Metadata table of a recording that was made of a damaged one: what that one lacked, and which it was.
RECOVERY_TABLE = "recovery"


@dataclass
class Findings:
    """What reading saw of the file's state.

    `breaks`: for each broken stretch, how many samples stood before it; `strange`: likewise for records
    of an unknown kind; `data_end`: None if the end of the data was not found, else whether its checksum
    agrees; `named`: what the index says is there (an attachment or a table, and its name);
    `sample_time_s`: the usual distance of `sample_times_s`.
    """

    breaks: list[int] = field(default_factory=list)
    strange: list[int] = field(default_factory=list)
    bad_attachments: list[str] = field(default_factory=list)
    named: list[tuple[bool, str]] = field(default_factory=list)
    attachments: list[str] = field(default_factory=list)
    tables: dict[str, dict[str, str]] = field(default_factory=dict)
    data_end: bool | None = None
    has_footer: bool = False
    has_last_bytes: bool = False
    index_agrees: bool = True
    samples_sha256: str = ""
    sample_times_s: Times = field(default_factory=lambda: np.zeros(0))
    sample_time_s: float = math.nan

    @property
    def broken(self) -> bool:
        """Whether a part of the file could not be read."""
        return bool(self.breaks or self.strange) or self.cut

    @property
    def cut(self) -> bool:
        """Whether the file ends before its end."""
        return not (self.has_footer and self.has_last_bytes)


def damage(findings: Findings) -> list[str]:
    """One sentence for each thing that was lost or cannot be trusted."""
    whole = _samples_are_whole(findings)
    found = _breaks(findings, whole)
    found += [
        f"the attachment '{name}' is damaged (its checksum disagrees) and was left out"
        for name in findings.bad_attachments
    ]
    found += _lost_names(findings)
    if findings.cut:
        found.append(_cut(findings))
    if not found and findings.data_end is None:
        found.append("the mark at the end of the data is damaged: descriptive data may be wrong")
    if not found and findings.data_end is False:
        agree = "; the samples agree with their own hash" if whole else ""
        found.append(f"the checksum of the file disagrees: descriptive data may be wrong{agree}")
    if whole is False and not findings.breaks and not findings.cut:
        found.append(_disagreement(findings))
    return found


def lost_earlier(tables: dict[str, dict[str, str]]) -> list[str]:
    """What the recording lacked from which this one was recovered."""
    table = tables.get(RECOVERY_TABLE, {})
    return [text for key, text in table.items() if key.startswith("lost ")]


def _samples_are_whole(findings: Findings) -> bool | None:
    """Whether number and hash of the samples are those that were written; None if the file tells none."""
    table = findings.tables.get(CHANNELS_TABLE, {})
    if "sha256" not in table:
        return None
    return table["sha256"] == findings.samples_sha256 and _expected(findings) == len(findings.sample_times_s)


def _expected(findings: Findings) -> int | None:
    count = findings.tables.get(CHANNELS_TABLE, {}).get("samples", "")
    return int(count) if count.isascii() and count.isdigit() and len(count) < 19 else None


def _breaks(findings: Findings, whole: bool | None) -> list[str]:
    time = findings.sample_times_s
    lines = []
    for at in dict.fromkeys(findings.breaks):
        if findings.cut and at == len(time):
            continue  # this is where it was cut off
        if whole:
            lines.append(
                f"a block of the file {_near(time, at)} is damaged: raw frames, events or descriptive data "
                "are lost, the samples are complete"
            )
        elif 0 < at < len(time):
            lines.append(_inner_break(findings, at))
        else:
            lines.append(_break_at_an_end(findings, at))
    return lines


def _inner_break(findings: Findings, at: int) -> str:
    before_s, after_s = findings.sample_times_s[at - 1], findings.sample_times_s[at]
    if after_s - before_s > 1.5 * findings.sample_time_s:
        return (
            f"samples between {before_s:.3f} s and {after_s:.3f} s are lost: a block of the file is damaged"
        )
    near = f"near {before_s:.3f} s"
    return f"raw frames, events or descriptive data {near} are lost: a block of the file is damaged"


def _break_at_an_end(findings: Findings, at: int) -> str:
    time = findings.sample_times_s
    side = f"after {time[-1]:.3f} s" if at else f"before {time[0]:.3f} s"
    missing = (_expected(findings) or 0) - len(time)
    if len(set(findings.breaks)) == 1 and missing > 0:
        return f"{missing} samples {side} are lost: a block of the file is damaged"
    return f"samples, raw frames or descriptive data {side} may be lost: a block of the file is damaged"


def _near(time: Times, at: int) -> str:
    return f"near {time[min(at, len(time) - 1)]:.3f} s" if len(time) else "without samples"


def _lost_names(findings: Findings) -> list[str]:
    if not findings.index_agrees:
        return []  # names of a damaged index prove nothing
    lines = []
    for attachment, name in dict.fromkeys(findings.named):
        if attachment and name not in findings.attachments and not findings.bad_attachments:
            lines.append(f"the attachment '{name}' is lost")
        if not attachment and name not in findings.tables:
            lines.append(f"the table '{name}' of descriptive data is lost")
    return lines


def _cut(findings: Findings) -> str:
    last = (
        f"after {findings.sample_times_s[-1]:.3f} s" if len(findings.sample_times_s) else "before any sample"
    )
    if findings.data_end:
        return f"the file was cut off {last}, in its index: the data before it are whole"
    return f"the file was cut off {last}: what followed is lost"


def _disagreement(findings: Findings) -> str:
    time = findings.sample_times_s
    expected = _expected(findings)
    where = "".join(f" {_near(time, at)}" for at in dict.fromkeys(findings.strange))
    if expected is not None and expected != len(time):
        counts = f"{len(time)} samples were read, {expected} were written"
        return f"{counts}: blocks are missing or stand twice{where}"
    return f"the samples do not agree with their hash: they cannot be trusted{where}"
