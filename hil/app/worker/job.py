"""`python -m hil.app.worker.job FOLDER`: one use case for a service or an agent, which starts it.

`request.json` in the folder says what is wanted, and where results go; a forecast is printed. An error is
one message on standard error, and the exit codes are those of the command line.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Callable
from pathlib import Path

from hil.app.interrupts import EXIT_CODE, INTERRUPTS

REQUEST = "request.json"
#: Starts it.
JOB = (sys.executable, "-m", "hil.app.worker.job")


def write_request(folder: Path, request: object) -> None:
    """Leave for the job what is wanted.

    Args:
        request: one of `hil.app.requests` that `execute` knows.

    Raises:
        HilError: it cannot be written.
    """
    import json

    from pydantic import TypeAdapter

    from hil.core.files import write_atomically

    wanted = TypeAdapter(type(request)).dump_python(request, mode="json")
    text = json.dumps({"kind": type(request).__name__, "request": wanted}, indent=1)
    write_atomically(folder / REQUEST, text)


def main() -> None:
    """Execute what is asked for, and exit."""
    INTERRUPTS.raise_from_now_on()
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    os.environ.setdefault("PYTHONWARNINGS", "ignore")
    code = EXIT_CODE
    try:
        from hil.app.worker.lean_imports import import_python_can

        import_python_can()
        code = _guarded(Path(sys.argv[1]))
    except KeyboardInterrupt:
        INTERRUPTS.tell()
    INTERRUPTS.ignore_from_now_on()
    sys.exit(code)


def _guarded(folder: Path) -> int:
    from hil.app.interrupts import error_of

    try:
        return _execute(folder)
    except Exception as error:
        if INTERRUPTS.arrived:
            INTERRUPTS.tell()
            return EXIT_CODE
        found = error_of(error)
        print(f"error: {found}", file=sys.stderr)
        return found.exit_code


def _execute(folder: Path) -> int:
    import json

    from pydantic import TypeAdapter

    from hil.app import requests

    wanted = json.loads((folder / REQUEST).read_bytes())
    kind = getattr(requests, wanted["kind"])
    if wanted["kind"] in _REPORTING:
        return _REPORTING[wanted["kind"]](TypeAdapter(kind).validate_python(wanted["request"]), folder)
    work = _WORK[wanted["kind"]]
    return work(TypeAdapter(kind).validate_python(wanted["request"]))


def _identify(request: object) -> int:
    from hil.app.identify import identify_recordings
    from hil.app.requests import IdentifyRequest

    assert isinstance(request, IdentifyRequest)
    identify_recordings(request)
    return 0


def _diagnose(request: object) -> int:
    from hil.analysis.diagnosis import INTERRUPTED
    from hil.app.diagnose import diagnose_recordings
    from hil.app.requests import DiagnoseRequest

    assert isinstance(request, DiagnoseRequest)
    outcome = diagnose_recordings(request)
    return EXIT_CODE if outcome.found.unfinished == INTERRUPTED else 0


def _campaign(request: object) -> int:
    from hil.app.campaign import CampaignStopped, run_campaign
    from hil.app.requests import CampaignRequest
    from reports.outputs.campaign import passed

    assert isinstance(request, CampaignRequest)
    outcome = run_campaign(request)
    if isinstance(outcome, CampaignStopped):
        return EXIT_CODE
    return int(passed(outcome.found.findings, outcome.found.setting.file.pass_share) is False)


def _check(request: object) -> int:
    from hil.app.check import check_plan
    from hil.app.requests import CheckRequest
    from hil.app.result_file import to_json

    assert isinstance(request, CheckRequest)
    checked = check_plan(request)
    print(to_json(checked.as_json()))
    return 0 if checked.forecast.fits else 1


def _tune(request: object, folder: Path) -> int:
    """A controller that fails a criterion is a result, too."""
    from hil.app.requests import TuneRequest
    from hil.app.tuning.tune import tune_controller
    from hil.app.worker.job_feedback import FileFeedback

    assert isinstance(request, TuneRequest)
    found = tune_controller(request, FileFeedback(folder)).found
    return EXIT_CODE if found.stopped else 0 if found.exit_code == 1 else found.exit_code


def _autotune(request: object, folder: Path) -> int:
    from hil.app.autotune.autotune import autotune
    from hil.app.requests import AutotuneRequest
    from hil.app.worker.job_feedback import FileFeedback

    assert isinstance(request, AutotuneRequest)
    feedback = FileFeedback(folder)
    code = autotune(request, feedback).found.exit_code
    return 0 if code == 1 else code


_REPORTING: dict[str, Callable[[object, Path], int]] = {"TuneRequest": _tune, "AutotuneRequest": _autotune}
_WORK: dict[str, Callable[[object], int]] = {
    "IdentifyRequest": _identify,
    "DiagnoseRequest": _diagnose,
    "CampaignRequest": _campaign,
    "CheckRequest": _check,
}


if __name__ == "__main__":
    main()
