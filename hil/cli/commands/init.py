"""`hil init`: a folder of one's own, ready to run."""

from __future__ import annotations

import shlex
from pathlib import Path

from hil.app.results_folder import results_in
from hil.app.samples import sample_files
from hil.cli.options.files import Init
from hil.cli.output import print_json, progress
from hil.core.errors import BadInputError
from hil.engine.bench.bench_file import DEFAULT_BENCH, shipped
from test_plans.loading import LIBRARY

_STARTER = Path(__file__).parents[1] / "starter"
_OWN = ("README.md", "plan.yaml")
_NAME = "my_bench"
_SHIPPED_MODEL = "three_inertia.toml"


def execute(options: Init) -> int:
    """Execute the command; its exit code."""
    folder = options.folder
    _refuse_used(folder)
    files = _files()
    if options.samples:
        with progress("samples") as show:
            files |= sample_files(_STARTER / "samples.yaml", lambda share, text: show(text, share))
    with results_in(folder, files) as place:
        place.write(files)
    if options.as_json:
        print_json({"folder": str(folder), "files": list(files)})
    else:
        print(f"{folder}: {', '.join(files)}")
        print(f"next: cd {shlex.quote(str(folder))} && hil check plan.yaml")
    return 0


def _files() -> dict[str, bytes]:
    """The new folder's files by name."""
    own = {name: (_STARTER / name).read_bytes() for name in _OWN}
    devices = {name: shipped(name).read_bytes() for name in ("rmcu.dbc", "rcs_dyno.eds")}
    return {
        **own,
        "bench.toml": _bench(),
        "model.toml": shipped(_SHIPPED_MODEL).read_bytes(),
        "controller.toml": (LIBRARY / "controllers" / "phase_stabilization.toml").read_bytes(),
        **devices,
    }


def _bench() -> bytes:
    """The shipped simulated bench under a name of its own, with the model beside it."""
    text = shipped(f"{DEFAULT_BENCH}.toml").read_text(encoding="utf-8")
    text = text.replace(f'name = "{DEFAULT_BENCH}"', f'name = "{_NAME}"')
    text = text.replace(f'channel = "{DEFAULT_BENCH}/', f'channel = "{_NAME}/')
    return text.replace(f'model = "{_SHIPPED_MODEL}"', 'model = "model.toml"').encode()


def _refuse_used(folder: Path) -> None:
    if folder.is_dir() and any(folder.iterdir()):
        raise BadInputError("is not empty", where=str(folder), fix="name a new folder")
