"""A whole recording from what a crash, a power cut or a bad disk left of one."""

from __future__ import annotations

import hashlib
import logging
import os
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from hil.core.channels import TIME
from hil.core.files import open_regular, replacing, sha256_of
from hil.core.recording import _mcap_records as mcap
from hil.core.recording._growing_file import GrowingFile
from hil.core.recording._mcap_damage import CHANNELS_TABLE, RECOVERY_TABLE
from hil.core.recording._mcap_file import McapFile
from hil.core.recording._mcap_reader import Definitions, definitions_of, read_mcap
from hil.core.recording._mcap_walk import MAGIC, records, records_inside
from hil.core.recording._mcap_writer import CHANNELS_TOPIC, CHUNK_BYTES
from hil.core.recording._table import Recording

logger = logging.getLogger(__name__)


@dataclass(frozen=True)
class Missing:
    """What a recording lacks.

    `gaps_s` are stretches between two samples; `until_s` is the last sample's time (NaN: there is none);
    `channels` tells of which share nothing was measured; `files` are attachments that a run stores.
    """

    gaps_s: tuple[tuple[float, float], ...]
    until_s: float
    channels: dict[str, float]
    files: tuple[str, ...]

    @property
    def seconds(self) -> float:
        """How much is missing before the last sample."""
        return sum(after - before for before, after in self.gaps_s)


def missing_of(recording: Recording) -> Missing:
    """Stretches, shares of channels and files that are missing."""
    gaps, lacking = [], dict.fromkeys(recording.channels, 0)
    widest_s = 1.5 * recording.sample_time_s if recording.samples > 1 else np.inf
    last_s = np.zeros(0)
    for _, rows in recording.blocks():
        time = np.concatenate([last_s, rows[TIME]])
        gaps += [(float(time[at]), float(time[at + 1])) for at in np.flatnonzero(np.diff(time) > widest_s)]
        last_s = time[-1:]
        for name, values in rows.items():
            lacking[name] += int(np.count_nonzero(~np.isfinite(values)))
    shares = {
        name: count / recording.samples if recording.samples else 1.0 for name, count in lacking.items()
    }
    expected = ("plan.yaml", "bench.toml", "run.json")
    hashed = recording.metadata.get("hashes", {})
    return Missing(
        gaps_s=tuple(gaps),
        until_s=recording.last_s if recording.samples else float("nan"),
        channels={name: share for name, share in shares.items() if share > 0.0},
        files=tuple(n for n in dict.fromkeys((*expected, *hashed)) if n not in recording.attachments),
    )


def recover_recording(source: Path, out: Path) -> Recording:
    """Write all that is whole of an MCAP recording to another file; what was lost stands in its `damage`.

    Every record is taken whose checksum agrees, and nothing else: of a torn block a part could be unpacked,
    but nothing would say that it is right.

    Raises:
        BadInputError: nothing can be read of it, or `out` cannot be written.
        BenchError: the disk is full.
    """
    recording = read_mcap(source)
    with open_regular(source) as file:
        size = os.fstat(file.fileno()).st_size
    lost = {f"lost {number}": text for number, text in enumerate(recording.damage, 1)}
    facts = {"from": source.name, "from_sha256": sha256_of(source), "from_bytes": str(size), **lost}
    with replacing(out) as temporary:
        target = GrowingFile(temporary)
        try:
            copy = _Copy(
                McapFile(target, library="eaxle-hil", chunk_bytes=CHUNK_BYTES), definitions_of(source)
            )
            with open_regular(source) as file:
                file.seek(len(MAGIC))
                for record in records(file, size):
                    copy.take(record)
            copy.finish(facts)
        finally:
            target.close()
    logger.info("recovered %s from %s", out, source)
    return read_mcap(out)


class _Copy:
    """Takes the records of one file into another."""

    def __init__(self, file: McapFile, definitions: Definitions) -> None:
        self._file = file
        self._over = False
        self._samples = 0
        self._hash = hashlib.sha256()
        schemas, channels = definitions
        ids = {old: file.schema(schema.name, schema.encoding, schema.data) for old, schema in schemas.items()}
        self._channels = {
            old: file.channel(channel.topic, channel.encoding, ids.get(channel.schema_id, 0))
            for old, channel in channels.items()
        }
        self._rows_come_by = {old for old, channel in channels.items() if channel.topic == CHANNELS_TOPIC}

    def take(self, record: mcap.Record) -> None:
        """Take what stands in the file itself; what follows the data is made anew."""
        match record:
            case mcap.DataEnd():
                self._over = True
            case _ if self._over:
                pass
            case mcap.Chunk():
                for inside in records_inside(record.content):
                    self._take_messages(inside)
            case mcap.Attachment(name, content, media_type, stored_ns) if content is not None:
                self._file.attach(name, media_type, content, stored_ns)
            case mcap.Metadata(name, table) if name not in (CHANNELS_TABLE, RECOVERY_TABLE):
                self._file.describe(name, table)
            case _:
                self._take_messages(record)

    def finish(self, description: dict[str, str]) -> None:
        """Close the file with `description`, and with number and hash of the samples that are in it."""
        self._file.describe(RECOVERY_TABLE, description)
        channels = {"sha256": self._hash.hexdigest(), "samples": str(self._samples)}
        self._file.describe(CHANNELS_TABLE, channels)
        self._file.finish()

    def _take_messages(self, record: mcap.Record) -> None:
        if not isinstance(record, mcap.Messages) or record.channel_id not in self._channels:
            return
        self._file.add(self._channels[record.channel_id], record.times, record.payloads)
        if record.channel_id in self._rows_come_by:
            self._hash.update(record.payloads.tobytes())
            self._samples += len(record.payloads)
