"""Every command line of the documents is a command line; and executed, it does what the page says.

The files that a page speaks of are there under its names, but short: `acceptance` and `identification` in the
folder of the test stand for the built-in plans.
"""

from __future__ import annotations

import base64
import shutil
import signal
import subprocess
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
import typer
from cryptography.hazmat.primitives.asymmetric.ed25519 import Ed25519PrivateKey
from cryptography.hazmat.primitives.serialization import Encoding, NoEncryption, PrivateFormat, PublicFormat
from nptdms import ChannelObject, TdmsWriter

from hil.cli._app import app_of
from hil.cli._commands import command_names, taken_apart
from hil.core.recording import read_recording
from tests.docs.documented import ROOT, Documented, blocks_of, documented
from tests.docs.test_own_plan import PLANS as PLANS_OF_PAGE
from tests.hil.cli.test_commands import HIL, hil

STEP = "quantity: driving_torque, from_nm: 0, to_nm: 200, before_s: 0.5, after_s: 2"
CHIRP = "quantity: motor_torque, from_hz: 0.5, to_hz: 30, duration_s: 15, amplitude_nm: 15"
PLANS = {
    "acceptance": f"""
name: acceptance
steps:
  - set_controller: {{file: gain_stabilization.toml}}
  - step: {{segment: gain_0kmh, {STEP}}}
  - hold_speed: {{speed_km_h: 20, duration_s: 0.5}}
  - set_controller: {{file: phase_stabilization.toml}}
  - step: {{segment: gain_20kmh, {STEP}}}
finally: [ramp_down: {{duration_s: 0.5}}]
criteria:
  - {{segment: gain_0kmh, metric: peak_shaft_torque, upper: 500, unit: N m}}
  - {{segment: gain_20kmh, metric: peak_shaft_torque, upper: 500, unit: N m}}
""",
    "identification": f"""
name: identification
steps:
  - hold_speed: {{speed_km_h: 20, duration_s: 0.5}}
  - chirp: {{segment: chirp_high, {CHIRP}}}
finally: [ramp_down: {{duration_s: 0.5}}]
""",
}
SEQUENCE = "name: mine\nidentify: identification\naccept: acceptance\nrounds: 1\nruns: 1\nstarts: 0\n"
TARGETS = '[targets]\n"gain_0kmh.peak_shaft_torque" = 300.0\n'
SEGMENTS = '{"segments": [{"id": "gain_0kmh", "start_s": 1.0, "step_s": 1.5, "end_s": 2.5}]}'
#: Without end, or with a question: ended by Ctrl-C, or answered by no one.
ENDLESS = ("bench monitor", "bench sim")
#: What an exit code other than 0 says of the simulated stand-ins.
CODES = {
    ("explain",): (0, 1),
    ("campaign",): (0, 1),  # its pass share is not reached by every controller
    ("evidence verify",): (0, 1),  # no one has signed yet
    ("replay",): (0, 1),  # segments of one of two criteria
    ("report",): (0, 1),  # of a run that crashed: it never passes
    ("bench monitor",): (0, 2, 130),  # a simulated bench has nothing to monitor
    ("bench jog",): (0, 1),
    ("autotune",): (0, 1),
    ("tune",): (0, 1),  # the short plan's runs would leave the envelope of its own controller
}
LINES = documented()
#: Pages whose commands take minutes: searches, and a bench in wall-clock time at a fifth of its rate.
LONG = (
    "autotune",
    "campaigns",
    "compare-runs",
    "diagnose",
    "explain",
    "identify-and-design",
    "sim-bench",
    "tune",
)
PAGES = [
    pytest.param(page, marks=pytest.mark.hunt if Path(page).stem in LONG else pytest.mark.slow)
    for page in sorted({line.page for line in LINES})
]


@pytest.mark.parametrize("line", LINES, ids=str)
def test_it_is_a_command_line(line: Documented) -> None:
    words = list(line.arguments)
    if words[0] == "--server":  # with its URL, before the command
        words = words[2:]
    if words[0] in ("--install-completion", "--version"):
        return
    name, arguments = taken_apart(words)
    assert name in command_names()
    command = typer.main.get_command(app_of(name))
    several = [argument for argument in arguments if argument != "--holdout"]
    command.make_context(name, several)


@pytest.fixture(scope="module")
def files(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """What the pages begin with."""
    folder = tmp_path_factory.mktemp("pages")
    hil("init", folder / "mine", "--samples")
    for path in (folder / "mine").iterdir():
        shutil.move(path, folder / path.name)
    (folder / "mine").rmdir()
    shutil.copytree(ROOT / "benches", folder / "benches")
    (folder / "paper_targets").write_text(TARGETS)
    for name, text in PLANS.items():
        (folder / name).write_text(text)
    (folder / "mine.yaml").write_text(SEQUENCE)
    for name in ("my_bench.toml", "net.toml"):
        shutil.copy(folder / "bench.toml", folder / name)
    shutil.copy(folder / "axle.toml", folder / "base.toml")
    return folder


@pytest.fixture
def stage(files: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    folder = tmp_path / "stage"
    shutil.copytree(files, folder)
    monkeypatch.chdir(folder)
    monkeypatch.setenv("BENCH_SIGN_IN_SECRET", "of a client")
    monkeypatch.setenv("BENCH_HOOK_SECRET", f"whsec_{base64.b64encode(bytes(32)).decode()}")
    monkeypatch.setenv("BENCH_MAIL_PASSWORD", "of a mail server")
    return folder


def prepare(page: str, stage: Path) -> None:
    """What a page speaks of as if it were there, beyond what all begin with."""
    if page.endswith("keep-evidence.md"):
        shutil.copy("bench.toml", "axle.toml")  # there it is a bench
        for name in ("acceptance-001", "endurance-003"):
            hil("run", "acceptance", "--out", f"out/{name}")
        for name in ("report.pdf", "recording.mcap"):
            shutil.copy(f"out/acceptance-001/{name}", name)
        torn = Path("out/endurance-003/recording.mcap")
        for report in torn.parent.iterdir():  # a run that crashed has none
            if report != torn:
                report.unlink()
        torn.write_bytes(torn.read_bytes()[: torn.stat().st_size // 2])
        _make_key(stage / "bench_key")
    if page.endswith("replay.md"):
        hil("run", "acceptance", "--out", "done")
        shutil.copy("done/recording.mcap", "recording.mcap")
        for log in ("drive.blf", "drive.asc"):
            hil("export", "recording.mcap", "--out", log)
        for dbc in ("vehicle.dbc", "chassis.dbc", "engine.dbc"):
            shutil.copy("rmcu.dbc", dbc)
        Path("segments.json").write_text(SEGMENTS)
    if page.endswith("sign-in.md"):
        Path("sign-in.toml").write_text(blocks_of(page, "toml")[0])
    if page.endswith("first-run.md"):
        hil("run", "acceptance", "--out", "out/acceptance")
    if page.endswith("model-to-fmu.md"):
        Path("why").mkdir()
        shutil.copy("axle.toml", "why/model.toml")
    if page.endswith("autotune.md"):  # what is best for a full step asks for more than this bench's envelope
        acceptance = Path("acceptance").read_text()
        Path("acceptance").write_text(acceptance.replace("to_nm: 200", "to_nm: 150"))
    if page.endswith("campaigns.md"):
        Path("acceptance").unlink()  # the built-in one has the criteria that the page names
        Path("lead_or_notch.yaml").write_text(blocks_of(page, "yaml")[0])
    if page.endswith("diagnose.md"):
        Path("why").mkdir()
        shutil.copy("identification", "why/separate_running_resistance.yaml")
    if page.endswith("notices.md"):
        shutil.copy("bench.toml", "rig.toml")
        Path("notices.toml").write_text(blocks_of(page, "toml")[0])
    if page.endswith("other-tools.md"):
        Path("columns.toml").write_text(blocks_of(page, "toml")[0])
        _write_as_other_tools("chirp_low.csv")
    if page.endswith("own-plan.md"):
        shutil.copy("plan.yaml", "tip-in.yaml")
        Path("plan.yaml").write_text(PLANS_OF_PAGE[1])


def _write_as_other_tools(csv: str) -> None:
    """A recording as LabVIEW and a TDMS writer have it, under other names; speed in rpm, inverted."""
    recording = read_recording(Path(csv))
    time_s, torque = recording.time_s, recording["motor_torque_ref_nm"]
    rpm = recording["motor_speed_rad_s"] * -60.0 / (2.0 * np.pi)
    head = "LabVIEW Measurement\t\nSeparator\tTab\n***End_of_Header***\t\nX_Value\tT_req\tn_EM\n"
    rows = zip(time_s, torque, rpm, strict=True)
    body = "".join(f"{t:.6f}\t{nm:.9g}\t{n:.9g}\n" for t, nm, n in rows)
    Path("drive.lvm").write_text(head + body)
    with TdmsWriter("drive.tdms") as writer:
        columns = {"t": 1e3 * time_s, "T_req": torque, "n_EM": rpm}
        writer.write_segment([ChannelObject("drive", name, values) for name, values in columns.items()])


def _make_key(path: Path) -> None:
    key = Ed25519PrivateKey.generate()
    path.write_bytes(key.private_bytes(Encoding.PEM, PrivateFormat.OpenSSH, NoEncryption()))
    public = key.public_key().public_bytes(Encoding.OpenSSH, PublicFormat.OpenSSH)
    path.with_suffix(".pub").write_bytes(public)


@pytest.fixture
def served() -> Iterator[list[subprocess.Popen[str]]]:
    processes: list[subprocess.Popen[str]] = []
    yield processes
    for process in processes:
        process.send_signal(signal.SIGINT)
        process.communicate(timeout=60)


@pytest.mark.parametrize("page", PAGES)
def test_the_commands_of_a_page_work_one_after_the_other(page, stage, served):
    prepare(page, stage)
    for line in (line for line in LINES if line.page == page):
        if line.arguments[0] in ("--install-completion", "--server"):
            continue  # test_completion.py has the script, test_client.py the service; neither is set up here
        name, arguments = taken_apart(list(line.arguments))
        began = time.monotonic()
        if name == "bench sim":
            _end(served)
            served.append(_served(line.arguments))
        elif name == "bench monitor":
            assert _interrupted(line.arguments) in CODES["bench monitor",]
        elif name == "serve" and "--test-notices" in arguments:
            _execute(name, arguments, (0, 3))  # nobody takes them here
        elif name == "serve" and "--add-token" not in arguments:
            assert _interrupted((*line.arguments, "--port", "0")) == 130
        elif name == "bench agent":
            assert _interrupted(line.arguments) == 130
        else:
            _execute(name, arguments)
        print(f"{time.monotonic() - began:6.1f} s  {line}")


def _execute(name: str, arguments: list[str], codes: tuple[int, ...] = (0,)) -> None:
    done = subprocess.run(
        [HIL, *name.split(), *arguments],
        capture_output=True,
        text=True,
        stdin=subprocess.DEVNULL,
        timeout=600,
    )
    assert "Traceback" not in done.stderr
    assert done.returncode in CODES.get((name,), codes), done.stdout + done.stderr


def _served(arguments: tuple[str, ...]) -> subprocess.Popen[str]:
    """The simulated bench, once its file is there."""
    Path("net.toml").unlink(missing_ok=True)
    process = subprocess.Popen([HIL, *arguments, "--port", "0"], stdout=subprocess.PIPE, text=True)
    while not Path("net.toml").exists():
        assert process.poll() is None
        time.sleep(0.1)
    return process


def _end(served: list[subprocess.Popen[str]]) -> None:
    for process in served:
        process.send_signal(signal.SIGINT)
        process.communicate(timeout=60)
    served.clear()


def _interrupted(arguments: tuple[str, ...]) -> int:
    process = subprocess.Popen([HIL, *arguments], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    time.sleep(4)
    if process.poll() is None:
        process.send_signal(signal.SIGINT)
    return process.wait(timeout=60)
