"""Where samples of slower messages stand on the rows of the one that comes most often."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from hil.core.can.frames import frames, joined
from hil.core.recording import read_recording
from hil.engine.replay._channels import Frames
from hil.engine.replay._dbc import DbcDecoder

DBC = """VERSION ""
NS_ :
BS_:
BU_: A
BO_ 1 Fast: 1 A
 SG_ Value : 0|8@1+ (1,0) [0|0] "" A
BO_ 2 Slow: 1 A
 SG_ Value : 0|8@1+ (1,0) [0|0] "m" A
"""


def test_a_sample_stands_once_in_the_row_nearest_to_it(tmp_path: Path) -> None:
    dbc = tmp_path / "a.dbc"
    dbc.write_text(DBC)
    block = joined(
        [
            frames(1, np.arange(5, dtype=np.uint64), 1, np.array([0.0, 0.1, 0.2, 0.3, 0.3])),
            frames(2, np.array([7, 8, 9], np.uint64), 1, np.array([0.14, 0.16, 5.0])),  # 5 s: near no row
        ]
    )
    decoder = DbcDecoder(Frames({("a.log", "can0"): block}, None), {"": dbc})
    writer = decoder.write(tmp_path / "a.mcap", 0)
    writer.describe("replay", {})
    writer.close()
    recording = read_recording(tmp_path / "a.mcap", allow_missing=True, any_replay=True)
    np.testing.assert_allclose(recording.time_s, [0.0, 0.1, 0.2, 0.3])
    np.testing.assert_array_equal(recording["Slow_Value"], [np.nan, 7.0, 8.0, np.nan])
    assert decoder.units == {"Fast_Value": "", "Slow_Value": "m"}
    assert decoder.remarks[0].startswith("2 samples were discarded")
    assert decoder.remarks[1] == "the time base is the frames of 'Fast'"
