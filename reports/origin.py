"""What a report of an analysis was made from: when, by which software, from which files."""

from __future__ import annotations

import datetime
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from hil.core.files import sha256_of
from hil.core.runtime.versions import versions
from reports import labels
from reports.parts import Part, Table


@dataclass(frozen=True)
class Source:
    """A file, what it was used as, its size in bytes and SHA-256."""

    role: str
    name: str
    size: int
    sha256: str


@dataclass(frozen=True)
class Origin:
    """Moment, software, files, and how files of other tools were read: their names, a sentence each."""

    made_at: datetime.datetime
    versions: Mapping[str, str]
    sources: tuple[Source, ...]
    reading: tuple[tuple[str, str], ...] = ()

    @property
    def mark(self) -> str:
        """One line for the head and the foot of every page."""
        software = f"eaxle-hil {self.versions.get('eaxle-hil', '')}".strip()
        revision = self.versions.get("git_revision", "")
        first = self.sources[:1]
        files = "".join(f" · {source.name} SHA-256 {source.sha256[:12]}" for source in first)
        more = f" and {len(self.sources) - 1} more" if len(self.sources) > 1 else ""
        made = f"{self.made_at:%Y-%m-%d %H:%M:%S} UTC"
        return f"{made} · {software}{f' ({revision})' if revision else ''}{files}{more}"

    @property
    def part(self) -> Part:
        """The section that says it in full."""
        files = tuple((s.name, s.role, labels.file_size(s.size), s.sha256) for s in self.sources)
        software = tuple((name, version) for name, version in self.versions.items() if version)
        tables = (
            Table(("file", "used as", "size", "SHA-256"), files, 2, 3),
            *((Table(("file", "as read"), self.reading, numbers_from=9),) if self.reading else ()),
            Table(("software", "version"), software, numbers_from=9),
        )
        return Part("provenance", "Provenance", f"Made at {self.made_at:%Y-%m-%d %H:%M:%S} UTC.", tables)


def origin_of(files: Mapping[str, list[Path]], read: Mapping[str, Mapping[str, Any]] | None = None) -> Origin:
    """The origin of what is made now from files, by what they are used as ('model', 'recording', …).

    Args:
        read: by file, `notes` on how it was read.

    Raises:
        BadInputError: a file cannot be read.
    """
    now = datetime.datetime.now(datetime.UTC).replace(microsecond=0)
    sources = tuple(
        Source(role, path.name, path.stat().st_size, sha256_of(path))
        for role, paths in files.items()
        for path in paths
    )
    reading = tuple((Path(file).name, note) for file, of in (read or {}).items() for note in of["notes"])
    return Origin(now, versions(), sources, reading)
