"""What reads files and frames of others, each with whole ones to begin from."""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np
import numpy.typing as npt

from drivers import read_rmcu
from hil.core.can.eds import read_eds
from hil.core.can.frames import FRAME
from hil.core.can_logs import read_can_log
from hil.core.controller import load_controller
from hil.core.model import load_model
from hil.core.recording import Recording, read_recording, recover_recording, write_frames, write_recording
from hil.engine import RunRequest, load_bench, run_plan
from test_plans import load_plan
from tests.benches_for_tests import SIM, plan, running, sim_bench
from tests.fuzz import further_targets

_BENCHES, _LIBRARY = SIM.source.parent, Path(load_plan("acceptance").source).parent


@dataclass(frozen=True)
class Target:
    """A parser: `parse` may raise a HilError and nothing else."""

    seeds: Callable[[], list[bytes]]
    suffix: str
    parse: Callable[[Path], object]


def of_files(*paths: Path) -> Callable[[], list[bytes]]:
    return lambda: [path.read_bytes() for path in paths]


@cache
def recordings(suffix: str) -> list[bytes]:
    """A small recording in each form."""
    time_s: npt.NDArray[np.float64] = np.arange(50.0) * 1e-3
    table = {"time_s": time_s, "motor_torque_ref_nm": np.sin(time_s), "motor_speed_rad_s": np.cos(time_s)}
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / f"r{suffix}"
        write_recording(Recording(table, path), path)
        return [path.read_bytes()]


@cache
def of_a_run() -> list[bytes]:
    """The recording of a short run."""
    with tempfile.TemporaryDirectory() as folder:
        short = plan("[{hold_speed: {speed_km_h: 1, duration_s: 0.1}}]")
        done = run_plan(RunRequest(short, sim_bench("fuzzed"), Path(folder)))
        return [done.recording.read_bytes()]


@cache
def logs(ending: str) -> list[bytes]:
    """The frames of a short run as a CAN log."""
    with tempfile.TemporaryDirectory() as folder:
        recording, log = Path(folder) / "r.mcap", Path(folder) / f"r{ending}"
        recording.write_bytes(of_a_run()[0])
        write_frames(read_recording(recording), log)
        return [log.read_bytes()[:20_000]]


def recovered(path: Path) -> object:
    return recover_recording(path, path.with_name("recovered.mcap"))


def beside_its_files(path: Path) -> object:
    """A bench file whose DBC, EDS and model are where they were."""
    text = path.read_bytes()
    for name in ("rmcu.dbc", "rcs_dyno.eds", "three_inertia.toml"):
        text = text.replace(f'"{name}"'.encode(), f'"{_BENCHES / name}"'.encode())
    path.write_bytes(text)
    return load_bench(path)


def on_the_bus(path: Path) -> object:
    """Twelve bytes a frame: identifier, length, flags, payload; to all who listen on the buses."""
    data = path.read_bytes()[: 12 * 200]
    numbers = np.frombuffer(data[: len(data) // 12 * 12], np.uint8).reshape(-1, 12)
    block = np.zeros(len(numbers), FRAME)
    block["id"] = (numbers[:, 0].astype(np.uint32) << 8 | numbers[:, 1]) % 2048
    block["length"], block["flags"] = numbers[:, 2] % 9, numbers[:, 3] % 2
    block["data"] = numbers[:, 4:].copy().view(np.uint64).reshape(-1)
    with running("fuzz") as bench:
        block["time_s"] = bench.loop.clock.now_s()
        for bus in ("dyno", "rmcu"):
            for source in bench.sources:
                if hasattr(source, "take"):
                    source.take(bus, block)
            bench.loop.hand_out(bus, block)
        bench.loop.run_for(0.02)
        return bench.dyno.troubles(), bench.rmcu.troubles()


def _frames() -> list[bytes]:
    ids = (0x110, 0x111, 0x083, 0x183, 0x283, 0x583, 0x584, 0x703, 0x702, 0x080)
    payload = bytes(range(8))
    return [b"".join(bytes([i >> 8, i & 255, 8, 0]) + payload for i in ids), b""]


def of_models(path: Path) -> object:
    """A model file."""
    return load_model(path)


def eds(path: Path) -> object:
    """A device description, for the objects that the dynos need."""
    return read_eds(path, 3, [(0x1017, 0)])


_SYMBOLS = (
    b"symbol,address,type,unit,scale,offset\nspeed,0x2000,UWORD,rad/s,0.5,-10\nraw,8196,FLOAT32_IEEE,,,\n"
)
_MODELS = tuple(_BENCHES / f"{name}.toml" for name in ("three_inertia", "paper_functions"))
_CONTROLLERS = tuple(sorted((_LIBRARY / "controllers").glob("*.toml")))

TARGETS: Mapping[str, Target] = {
    "plan": Target(of_files(*sorted(_LIBRARY.glob("*.yaml"))), ".yaml", lambda path: load_plan(str(path))),
    "bench": Target(of_files(SIM.source, _BENCHES / "rear_axle_socketcan.toml"), ".toml", beside_its_files),
    "model": Target(of_files(*_MODELS), ".toml", of_models),
    "controller": Target(of_files(*_CONTROLLERS), ".toml", load_controller),
    "dbc": Target(of_files(_BENCHES / "rmcu.dbc"), ".dbc", read_rmcu),
    "eds": Target(of_files(_BENCHES / "rcs_dyno.eds"), ".eds", eds),
    "csv": Target(lambda: recordings(".csv"), ".csv", read_recording),
    "columns": Target(lambda: list(further_targets.TABLES), ".txt", further_targets.mapped),
    "lvm": Target(lambda: list(further_targets.TABLES), ".lvm", further_targets.mapped),
    "parquet": Target(lambda: recordings(".parquet"), ".parquet", read_recording),
    "mcap": Target(of_a_run, ".mcap", read_recording),
    "asc": Target(lambda: logs(".asc"), ".asc", read_can_log),
    "blf": Target(lambda: logs(".blf"), ".blf", read_can_log),
    "candump": Target(lambda: logs(".log"), ".log", read_can_log),
    "recover": Target(of_a_run, ".mcap", recovered),
    "a2l": Target(of_files(_BENCHES / "rmcu.a2l"), ".a2l", further_targets.symbols),
    "symbols": Target(lambda: [_SYMBOLS], ".csv", further_targets.symbols),
    "telegrams": Target(further_targets.of_telegrams, ".bin", further_targets.telegrams),
    "xcp-answers": Target(further_targets.from_the_slave, ".bin", further_targets.heard_by_the_monitor),
    "xcp-commands": Target(further_targets.to_the_slave, ".bin", further_targets.heard_by_the_slave),
    "frames": Target(_frames, ".bin", on_the_bus),
}
