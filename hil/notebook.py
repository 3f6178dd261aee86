"""The bench from Python, in few lines: docs/how-to/notebook.md.

Runs are executed by the command `hil run` in a process of its own, so that a kernel that is interrupted or
restarted leaves the bench as safe as a terminal would. The rest is computed here.
"""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import pandas as pd

from hil.analysis import control_design, diagnosis, identification
from hil.analysis.control_design import Design, DesignSpec
from hil.analysis.diagnosis import Diagnosis
from hil.analysis.frequency_response import experiments_of
from hil.analysis.identification import Identification
from hil.core.channels import TIME, unit_of
from hil.core.errors import BadInputError, BenchError, HilError, InterruptError
from hil.core.model import Model, load_model
from hil.core.recording import Recording, driven_by_torque, read_recording
from hil.core.result import RunResult

__all__ = ["Run", "design", "diagnose", "frame", "identify", "load_model", "read", "recording_of", "run"]

#: Where the system can, it interrupts the command when the process that called it is killed.
_PARENT = "HIL_CALLED_BY"
_UNTIL_PARENT_ENDS = f"""
import ctypes, os, signal
try:
    ctypes.CDLL(None).prctl(1, signal.SIGINT)  # PR_SET_PDEATHSIG
except (AttributeError, OSError, TypeError):
    pass  # not Linux
else:
    if os.environ.get("{_PARENT}", "") != str(os.getppid()):
        raise SystemExit(130)
"""
_COMMAND = (sys.executable, "-c", _UNTIL_PARENT_ENDS + "from hil.cli import main; main()")
_CODES: tuple[type[HilError], ...] = (BadInputError, BenchError, InterruptError)


@dataclass(frozen=True)
class Run:
    """A run that has ended: its verdict and criteria, and the folder with recording and reports."""

    result: RunResult
    folder: Path

    @property
    def recording(self) -> Recording:
        """What was measured."""
        return read(self.folder / self.result.files["recording"])


def run(
    plan: str | Path,
    out: str | Path,
    bench: str | Path = "",
    *,
    variables: dict[str, float] | None = None,
    options: Sequence[str] = (),
    held: Sequence[int] = (),
) -> Run:
    """Execute a plan, as `hil run` does, and write its reports.

    Args:
        plan: file, or the name of a built-in plan.
        bench: file, or the name of a shipped bench; default: as that of `hil run`.
        out: new folder for recording and reports.
        variables: values of the plan's variables, in their units.
        options: further options of `hil run`, such as `--model FILE` or `--confirm NAME`.
        held: descriptors that the command keeps open until the bench is safe, such as of a lock.

    Raises:
        BadInputError: plan, bench or place cannot be used; nothing was moved.
        BenchError: the bench failed; what was measured until then stands in the folder.
        InterruptError: the kernel was interrupted; the bench was left safe first.
        BaseException: what a timer or a signal raised meanwhile; likewise.
    """
    chosen = [word for name, value in (variables or {}).items() for word in ("--set", f"{name}={value!r}")]
    arguments = [
        *_COMMAND,
        "run",
        str(plan),
        *(("--bench", str(bench)) if bench else ()),
        "--out",
        str(out),
        *chosen,
        *options,
        "--json",
    ]
    process = subprocess.Popen(
        arguments,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        pass_fds=tuple(held),
        env={**os.environ, _PARENT: str(os.getpid())},
    )
    output, complaint = _until_safe(process)
    failure = next((kind for kind in _CODES if kind.exit_code == process.returncode), None)
    if failure is not None:
        raise failure(complaint.strip().removeprefix("error: ") or "the command printed nothing")
    return Run(RunResult.model_validate_json(output), Path(out))


def read(path: str | Path) -> Recording:
    """A recording of any format that the commands read.

    Raises:
        BadInputError: names file, line and column where it can.
    """
    return read_recording(Path(path))


def frame(recording: Recording | str | Path) -> pd.DataFrame:
    """Channels over time: the index is `time_s`, units stand in `attrs["units"]` by channel.

    Args:
        recording: as `read` gives it, or the file, which is read then.

    Raises:
        BadInputError: the file is no recording.
    """
    recording = recording if isinstance(recording, Recording) else read(recording)
    columns = {name: values for name, values in recording.channels.items() if name != TIME}
    found = pd.DataFrame(columns, index=pd.Index(recording.time_s, name=TIME))
    found.attrs["units"] = {name: unit_of(name) for name in columns}
    return found


def recording_of(table: pd.DataFrame, name: str = "notebook") -> Recording:
    """The recording that a frame with the index `time_s` holds.

    Raises:
        BadInputError: a column is not numeric.
    """
    channels = {TIME: table.index.to_numpy(float)}
    for column in table.columns:
        try:
            channels[str(column)] = table[column].to_numpy(float)
        except (TypeError, ValueError) as error:
            raise BadInputError(
                f"column '{column}' is not numeric", where=name, fix="leave it out, or convert it"
            ) from error
    return Recording(channels, Path(name))


def identify(*recordings: Recording, to_hz: float = 30.0) -> Identification:
    """Frequency responses, transfer functions and chain from the chirps and multisines of recordings.

    Raises:
        BadInputError: the data cannot give a frequency response.
    """
    experiments = [one for recording in recordings for one in experiments_of(recording, to_hz=to_hz)]
    return identification.identify(experiments, to_hz=to_hz)


def design(model: Model, spec: DesignSpec | None = None) -> Design:
    """A controller for a model, the paper's choices where `spec` has no others.

    Raises:
        BadInputError: the model has no plant for it, or no stable loop results.
    """
    return control_design.design(model, spec or DesignSpec())


def diagnose(model: Model, *recordings: Recording, holdout: Sequence[Recording] = ()) -> Diagnosis:
    """What the model lacks to explain recordings; of runs, the segments that torque alone drives.

    Raises:
        BadInputError: the recordings cannot belong to the model.
    """
    parts = [part for one in recordings for part in _explainable(model, one)]
    held = [part for one in holdout for part in _explainable(model, one)]
    return diagnosis.diagnose(model, parts, held)


def _explainable(model: Model, recording: Recording) -> list[Recording]:
    return [recording] if model.load_input else driven_by_torque(recording)


def _until_safe(process: subprocess.Popen[str]) -> tuple[str, str]:
    """What the command says. An interrupt is passed on; whatever else is raised here interrupts it too.

    Raises:
        BaseException: what was raised here, such as by a timer of a test, when the bench is safe.
    """
    raised: BaseException | None = None
    while True:
        try:
            output = process.communicate()
        except KeyboardInterrupt:
            process.send_signal(signal.SIGINT)
        except BaseException as error:
            raised = raised or error
            process.send_signal(signal.SIGINT)
        else:
            if raised is not None:
                raise raised
            return output
