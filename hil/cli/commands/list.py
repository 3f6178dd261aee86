"""`hil list`: what there is to choose from."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from dataclasses import fields
from typing import Any

from pydantic import BaseModel
from rich.markup import escape

from hil.cli.listed_runs import list_runs
from hil.cli.options.files import List
from hil.cli.output import console, plain_table, print_json
from hil.core.effects import EFFECTS
from hil.core.errors import BadInputError
from hil.core.errors.wording import did_you_mean, printable
from hil.core.files.shipped import shipped_file, shipped_names
from hil.core.model import load_model
from hil.engine import load_bench
from hil.engine.bench.bench_file import shipped_benches
from hil.engine.bench.device_kinds import KINDS
from test_plans import METRICS, STEPS, estimate_duration_s, library_plans, load_plan
from test_plans.building import key_names
from test_plans.registry import Registry

Row = dict[str, Any]


def execute(options: List) -> int:
    """Execute the command; its exit code."""
    what = options.what
    if what == "runs":
        return list_runs(options)
    if what not in _LISTS:
        fix = did_you_mean(what, [*_LISTS, "runs"])
        raise BadInputError(f"there is no list of '{printable(what, 60)}'", fix=fix)
    _refuse_beside(options)
    rows = _LISTS[what]()
    if options.as_json:
        print_json({what: rows})
    else:
        _tell(rows)
    return 0


def _refuse_beside(options: List) -> None:
    """Raises:
    BadInputError: an argument or option that only runs have.
    """
    for field in fields(options):
        name = field.name
        if name not in ("what", "as_json") and getattr(options, name) != field.default:
            option = "DIR" if name == "folder" else f"--{name}"
            raise BadInputError(f"{option} goes with `hil list runs`", where=option, fix="leave it out")


def _plans() -> list[Row]:
    plans = [load_plan(name) for name in library_plans()]
    return [
        {
            "name": plan.source.stem,
            "title": plan.title,
            "duration_s": round(estimate_duration_s(plan), 1),
            "segments": [segment.id for segment in plan.segments],
        }
        for plan in plans
    ]


def _benches() -> list[Row]:
    benches = {name: load_bench(name) for name in shipped_benches()}
    return [
        {"name": name, "title": bench.title, "simulated": bench.simulation is not None}
        for name, bench in benches.items()
    ]


def _models() -> list[Row]:
    models = {name: load_model(shipped_file(name, "model")) for name in shipped_names("model")}
    return [
        {
            "name": name,
            "title": _heading(name),
            "kind": model.kind,
            "effects": [use.id for use in model.effects],
        }
        for name, model in models.items()
    ]


def _heading(name: str) -> str:
    """What a shipped model's file says in its first line."""
    text = shipped_file(name, "model").read_text("utf-8")
    return text.partition("\n")[0].removeprefix("# ")


def _effects() -> list[Row]:
    return [
        {
            "name": effect.id,
            "title": effect.title,
            "parameters": [
                *effect.text_parameters,
                *(f"{p.name}{'?' if p.optional else ''}" for p in effect.parameters),
            ],
            "models": list(effect.needs),
        }
        for effect in EFFECTS.values()
    ]


def _classes(registry: Registry[Any], left_out: tuple[str, ...] = ()) -> list[Row]:
    """Each class of a registry with what it is for and the keys of its table."""
    return [
        {
            "name": name,
            "title": (inspect.getdoc(found) or "").partition("\n")[0],
            "keys": [key for key in _keys(found) if key not in left_out],
        }
        for name in registry.names()
        for found in [registry.find(name)]
    ]


def _keys(found: type[BaseModel] | None) -> list[str]:
    if found is None:
        return []
    required = [field.is_required() for field in found.model_fields.values()]
    named = zip(key_names(found), required, strict=True)
    return [name if needed else f"{name}?" for name, needed in named]


_LISTS: dict[str, Callable[[], list[Row]]] = {
    "plans": _plans,
    "benches": _benches,
    "models": _models,
    "effects": _effects,
    "steps": lambda: _classes(STEPS),
    "metrics": lambda: _classes(METRICS),
    "devices": lambda: _classes(KINDS, ("kind", "kind?")),
}


def _tell(rows: list[Row]) -> None:
    table = plain_table()
    for key in rows[0]:
        table.add_column(key.replace("_s", ", s"), no_wrap=key == "name")
    for row in rows:
        table.add_row(*(_cell(value) for value in row.values()))
    page = console()
    page.print(table)
    if "keys" in rows[0] or "parameters" in rows[0]:
        page.print("\n?: optional", style="dim", highlight=False)


def _cell(value: object) -> str:
    if isinstance(value, bool):
        return "yes" if value else "no"
    return escape(", ".join(value) if isinstance(value, list) else str(value))
