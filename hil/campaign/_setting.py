"""A campaign with everything that it names: read, checked, and distinguished from any other by a digest."""

from __future__ import annotations

import hashlib
import importlib.metadata
import json
from dataclasses import dataclass
from pathlib import Path

from hil.analysis.campaigns import (
    CampaignFile,
    Cases,
    axes_of,
    controller_file,
    load_campaign_file,
    varied,
)
from hil.analysis.tuning import differing, driven_by, refuse_model
from hil.core.controller import Controller, load_controller
from hil.core.errors import BadInputError
from hil.core.errors.wording import did_you_mean
from hil.core.files import is_file, sha256_of
from hil.core.files.shipped import shipped_file
from hil.core.model import Model, load_model
from hil.engine import BenchFile, load_bench
from hil.engine.prediction.batch_prediction import controller_files
from test_plans import Criterion, Plan, load_plan


@dataclass(frozen=True)
class Source:
    """A file that a campaign is made from, what it is used as, and its SHA-256."""

    role: str
    path: Path
    sha256: str


@dataclass(frozen=True)
class Setting:
    """A checked campaign.

    Attributes:
        replaced: the plan's controller file that is replaced or varied; None where none drives a segment.
        controllers: what stands in its place, by name.
        cases: every simulation.
        criteria: those of the plan that count.
        sources: the files.
    """

    file: CampaignFile
    plan: Plan
    bench: BenchFile
    model: Model
    replaced: Path | None
    controllers: tuple[tuple[str, Controller | None], ...]
    cases: Cases
    criteria: tuple[Criterion, ...]
    sources: tuple[Source, ...]

    @property
    def identity(self) -> dict[str, str]:
        """What makes it this campaign: the files' hashes by what they are used as, and the software."""
        found = {f"{one.role} {one.path.name}": one.sha256 for one in self.sources}
        return {**found, "eaxle-hil": importlib.metadata.version("eaxle-hil")}

    @property
    def digest(self) -> str:
        """SHA-256 of the identity: the same on every machine that has the same files and software."""
        return hashlib.sha256(json.dumps(self.identity, sort_keys=True).encode()).hexdigest()


def load_setting(name_or_path: str | Path) -> Setting:
    """Read a campaign file and everything that it names.

    Raises:
        BadInputError: something cannot be read or does not fit; file, line, key, and what to do.
    """
    file = load_campaign_file(name_or_path)
    plan = load_plan(file.beside(file.plan) or file.plan)
    bench = load_bench(file.beside(file.bench) or file.bench)
    model_file = _model_file(file, bench)
    model = load_model(model_file)
    refuse_model(model, str(model_file))
    replaced = _replaced(file, plan)
    files = tuple(controller_file(file, name) for name in file.controllers)
    controllers = _controllers(file, files, bench)
    axes = axes_of(file, plan, model, controlled=replaced is not None)
    used = [path for path in controller_files(plan, bench) if path != replaced or not files]
    named = {
        "campaign": [file.source],
        "plan": [plan.source],
        "bench": [bench.source],
        "device": [path for table in bench.device_tables.values() for path in table.files()],
        "model": [model_file],
        "controller": [*used, *files],
    }
    sources = tuple(
        Source(role, path, sha256_of(path)) for role, paths in named.items() for path in dict.fromkeys(paths)
    )
    cases = Cases(axes, len(controllers), file.draws)
    _refuse_same_cars(file, model, cases)
    counted = _criteria(file, plan)
    return Setting(file, plan, bench, model, replaced, controllers, cases, counted, sources)


def _model_file(file: CampaignFile, bench: BenchFile) -> Path:
    where = file.document.place(("model",))
    if not file.model:
        if bench.simulation is None:
            what = f"the bench '{bench.name}' has no model of its own"
            raise BadInputError(what, where=where, fix="model: FILE, a chain as hil identify writes it")
        return bench.simulation.model
    found = file.beside(file.model, Path())
    try:
        found = found or shipped_file(file.model, "model", file.source.parent)
    except BadInputError as error:
        raise BadInputError(error.what, where=where, fix=error.fix) from None
    if not is_file(found):
        fix = (
            "name a model file beside the campaign's or a shipped model, or leave it out for the bench's own"
        )
        raise BadInputError(f"there is no file '{file.model}'", where=where, fix=fix)
    return found


def _replaced(file: CampaignFile, plan: Plan) -> Path | None:
    """The controller of the plan that is replaced or varied; None where nothing asks for one."""
    asked = file.controller or file.controllers or any(n.startswith("controller.") for n in file.vary)
    try:
        return driven_by(plan, file.controller).file
    except BadInputError as error:
        if asked:
            raise BadInputError(error.what, where=str(file.source), fix=error.fix) from None
        return None


def _controllers(
    file: CampaignFile, files: tuple[Path, ...], bench: BenchFile
) -> tuple[tuple[str, Controller | None], ...]:
    """By the names of their files; the plan's own by none."""
    if not files:
        return (("", None),)
    names = [path.stem for path in files]
    limit = bench.limits.motor_torque_nm
    found = []
    for number, path in enumerate(files):
        where = file.document.place(("controllers", number))
        if names[number] in names[:number]:
            raise BadInputError(f"'{names[number]}' stands twice", where=where, fix="give each another name")
        loaded = load_controller(path)
        if loaded.torque_limit_nm > limit:
            what = f"torque_limit_nm = {loaded.torque_limit_nm:g} is above the bench's {limit:g} N m"
            raise BadInputError(what, where=str(path), fix="lower it")
        found.append((path.stem, loaded))
    return tuple(found)


def _criteria(file: CampaignFile, plan: Plan) -> tuple[Criterion, ...]:
    known = {criterion.id: criterion for criterion in plan.criteria}
    for number, name in enumerate(file.criteria):
        if name not in known:
            where = file.document.place(("criteria", number))
            what = f"plan '{plan.name}' has no criterion '{name}'"
            raise BadInputError(what, where=where, fix=did_you_mean(name, known))
    found = tuple(known[name] for name in dict.fromkeys(file.criteria)) or plan.criteria
    if not any(c.upper is not None or c.lower is not None or c.below is not None for c in found):
        fix = "give a limit to one of them, or name others under criteria"
        raise BadInputError(
            "no criterion has a limit, so no simulation can be judged", where=str(file.source), fix=fix
        )
    return found


def _refuse_same_cars(file: CampaignFile, model: Model, cases: Cases) -> None:
    """Refuse a tolerance of a number that the model has not, and cars that would all be the model itself."""
    if not file.draws:
        return
    first = cases[0].values
    car = varied(model, first["model"], first["effect"])
    try:
        differs = differing(car, file.tolerance)
    except BadInputError as error:
        key = error.what.partition(":")[0].removeprefix("tolerance.")
        raise BadInputError(
            error.what, where=file.document.place(("tolerance", key)), fix=error.fix
        ) from None
    if not differs:
        raise BadInputError(
            f"{file.draws} vehicles are to be sampled, but no parameter varies between them",
            where=file.document.place(("draws",)),
            fix="give parameters under tolerance (vehicle_inertia: 0.1), or a model with standard errors; "
            "or omit draws",
        )
