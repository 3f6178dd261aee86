"""CAN logs of other tools through the bench's decoders: channels and a recording, as of a run."""

from hil.engine.replay._bench import BenchDecoder
from hil.engine.replay._channels import chosen_buses, listed, merged
from hil.engine.replay._dbc import DbcDecoder
from hil.engine.replay._replay import Replayed, ReplayRequest, replay
from hil.engine.replay._segments import segments_from

__all__ = [
    "BenchDecoder",
    "DbcDecoder",
    "ReplayRequest",
    "Replayed",
    "chosen_buses",
    "listed",
    "merged",
    "replay",
    "segments_from",
]
