"""What the cases start from: a short plan, a bench, a model, recordings; and how files get damaged."""

from __future__ import annotations

import shutil
import subprocess
import sys
from pathlib import Path

HIL = str(Path(sys.executable).parent / "hil")
_COMPILED_S = 900  # the first command on a machine compiles the simulation
SHIPPED = Path(__file__).parents[2] / "benches"

PLAN = """\
name: short
steps:
  - chirp: {segment: c, quantity: motor_torque, from_hz: 1, to_hz: 30, duration_s: 2, amplitude_nm: 10}
finally: [{ramp_down: {duration_s: 0.1}}]
criteria:
  - {segment: c, metric: peak_shaft_torque, upper: 300, unit: N m}
"""
CAMPAIGN = """\
name: short
plan: plan.yaml
bench: bench.toml
draws: 2
tolerance: {sensor_noise: 1}
"""
NOTICES = """\
[[webhook]]
url = "https://chat.example.org/hook"
"""
SIGN_IN = """\
address = "https://bench.example.org"
issuer = "https://login.example.org"
client_id = "bench"

[roles]
everybody = "viewer"
"""
#: Every input by name; `done` is the folder of a run.
NAMES = (
    "plan.yaml",
    "campaign.yaml",
    "bench.toml",
    "rmcu.dbc",
    "rcs_dyno.eds",
    "model.toml",
    "recording.mcap",
    "torn.mcap",
    "short.csv",
    "frames.log",
    "done",
    "key.pem",
    "notices.toml",
    "sign-in.toml",
)
#: An Ed25519 key of these tests; it signs nothing else.
KEY = """\
-----BEGIN PRIVATE KEY-----
MC4CAQAwBQYDK2VwBCIEIHXkafbv4yTeFFg44pBKRuOhNOMCJx5ULLY6gRu16kZo
-----END PRIVATE KEY-----
"""


def make_inputs(folder: Path) -> None:
    """Write every input into `folder`, the recordings by a run of the program itself."""
    folder.mkdir(parents=True, exist_ok=True)
    for source, target in (
        ("sim.toml", "bench.toml"),
        ("rmcu.dbc", "rmcu.dbc"),
        ("rcs_dyno.eds", "rcs_dyno.eds"),
        ("three_inertia.toml", "model.toml"),
    ):
        shutil.copy(SHIPPED / source, folder / target)
    bench = (folder / "bench.toml").read_text("utf-8").replace('"three_inertia.toml"', '"model.toml"')
    (folder / "bench.toml").write_text(bench, "utf-8")
    (folder / "key.pem").write_text(KEY, "utf-8")
    (folder / "notices.toml").write_text(NOTICES, "utf-8")
    (folder / "sign-in.toml").write_text(SIGN_IN, "utf-8")
    (folder / "plan.yaml").write_text(PLAN, "utf-8")
    (folder / "campaign.yaml").write_text(CAMPAIGN, "utf-8")
    _hil(folder, "run", "plan.yaml", "--bench", "bench.toml", "--out", "whole")
    _hil(folder, "export", "whole/recording.mcap", "--out", "short.csv")
    _hil(folder, "export", "whole/recording.mcap", "--out", "frames.log")
    (folder / "done").mkdir()
    for name in ("recording.mcap", "result.json", "junit.xml", "report.html", "report.pdf"):
        shutil.copy(folder / "whole" / name, folder / "done" / name)
    shutil.copy(folder / "whole" / "recording.mcap", folder / "recording.mcap")
    shutil.copy(folder / "whole" / "recording.mcap", folder / "torn.mcap")
    cut(folder / "torn.mcap")
    shutil.rmtree(folder / "whole")
    for sidecar in folder.glob("short.csv.*"):
        sidecar.unlink()


def copy_inputs(inputs: Path, folder: Path) -> None:
    """The same inputs in a folder of a case's own."""
    folder.mkdir(parents=True)
    for name in NAMES:
        source = inputs / name
        (shutil.copytree if source.is_dir() else shutil.copy)(source, folder / name)


def cut(path: Path) -> None:
    """Leave the first half of a file."""
    content = path.read_bytes()
    path.write_bytes(content[: len(content) // 2])


def flip_bits(path: Path) -> None:
    """Turn a bit over in each of a few places, spread over the file."""
    content = bytearray(path.read_bytes())
    for part in range(1, 8):
        content[part * len(content) // 8] ^= 1 << part
    path.write_bytes(bytes(content))


def make_empty(path: Path) -> None:
    """Leave nothing of a file."""
    path.write_bytes(b"")


def make_binary(path: Path) -> None:
    """Bytes that are no text and no format of ours."""
    path.write_bytes(bytes((31 * k * k + 7 * k) % 256 for k in range(4000)))


def make_directory(path: Path) -> None:
    """A directory where a file is needed."""
    path.unlink()
    path.mkdir()


def make_text(path: Path) -> None:
    """Words, with what would colour a terminal."""
    path.write_text("hello \x1b[31mthere\n, this is\tno such file: [1, 2\n", "utf-8")


def _hil(folder: Path, *arguments: str) -> None:
    subprocess.run([HIL, *arguments], cwd=folder, check=True, capture_output=True, timeout=_COMPILED_S)
