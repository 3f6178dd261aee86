"""Campaigns that are given: written down with all they name, counted while they grow."""

from __future__ import annotations

import json
import re
import shutil
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from hil.analysis.campaigns import CampaignFile, campaign_from_text, library_campaigns, load_campaign_file
from hil.campaign import Tally, load_setting, write_table
from hil.core.errors import BadInputError, HilError
from hil.core.errors.wording import did_you_mean, printable
from hil.core.files import make_directory, read_text, write_atomically
from hil.engine.bench.bench_file import shipped, shipped_benches
from hil.execution.data_folder import files_of
from hil.service.worker_pool.drawn_numbers import number
from test_plans import plan_from_text
from test_plans.yaml_document import KeyPath

CAMPAIGN = "campaign.yaml"
_PLAIN = re.compile(r"[A-Za-z0-9][A-Za-z0-9_.-]{0,80}")
_tallies: dict[str, Tally] = {}
_MOST_TALLIES = 8


def given(
    text: str,
    files: Mapping[str, str],
    folder: str,
    plans: str,
    models: Mapping[str, str],
    benches: Mapping[str, str],
) -> dict[str, Any]:
    """Write a campaign and all that it names into a folder, so that it stays what it is, and check it.

    Args:
        files: sent with it, by name; they come before those of the service.
        plans: the folder of the service's plans and controllers; models, benches: its files by name.

    Returns:
        fields of `CampaignData`.

    Raises:
        BadInputError: something is wrong with it, or it names what the service has not.
    """
    place = Path(folder)
    make_directory(place)
    for name, content in files.items():
        write_atomically(place / name, content)
    try:
        file = campaign_from_text(text, Path(CAMPAIGN))
        _bring(file, place, Path(plans), models)
        write_atomically(place / CAMPAIGN, _with_bench(file, benches))
        setting = load_setting(place / CAMPAIGN)
    except HilError as error:
        here = f"{place}/"
        what, where, fix = (text.replace(here, "") for text in (error.what, error.where, error.fix))
        raise type(error)(what, where=where, fix=fix) from None
    return {
        "name": file.name,
        "title": file.title,
        "plan": setting.plan.name,
        "model": next(one.path.stem for one in setting.sources if one.role == "model"),
        "simulations": len(setting.cases),
        "draws": file.draws,
        "pass_share_wanted": file.pass_share,
    }


def so_far(folder: str) -> dict[str, Any]:
    """How many simulations are on disk, and how many of each controller's passed: with exact intervals."""
    if folder not in _tallies:
        while len(_tallies) >= _MOST_TALLIES:
            del _tallies[next(iter(_tallies))]
        _tallies[folder] = Tally(Path(folder))
    found = _tallies[folder].look()
    controllers = [
        {
            "controller": name,
            "passed": share.passed,
            "of": share.of,
            "share": number(share.value),
            "interval": share.interval,
        }
        for name, share in found.items()
    ]
    return {"done": sum(share.of for share in found.values()), "controllers": controllers}


def table(folder: str, file: str) -> dict[str, Any]:
    """Write a campaign's table as one file."""
    return {"rows": write_table(Path(folder), Path(file))}


def examples() -> dict[str, Any]:
    """The built-in campaigns."""
    found = [load_campaign_file(name) for name in library_campaigns()]
    return {"examples": [{"name": one.name, "title": one.title, "text": one.text} for one in found]}


def _bring(file: CampaignFile, place: Path, plans: Path, models: Mapping[str, str]) -> None:
    """Copy what the service has and the campaign names to where the campaign finds it: beside itself.

    Built-in plans and controllers are found by their names as everywhere.
    """
    named: list[tuple[KeyPath, str]] = [(("plan",), file.plan), (("model",), file.model or "model")]
    named += [(("controllers", index), name) for index, name in enumerate(file.controllers)]
    for path, name in named:
        if not _PLAIN.fullmatch(name) or name == CAMPAIGN:
            raise BadInputError(
                f"{printable(repr(name), 100)} is not a plain file name",
                where=file.document.place(path),
                fix="a campaign of a service names files by letters, digits, _, - and ., without paths",
            )
    _copy(plans / f"{_stem(file.plan, '.yaml', '.yml')}.yaml", place / file.plan)
    for name in file.controllers:
        stem = _stem(name, ".toml")
        _copy(plans / f"{stem}.toml", place / f"{stem}.toml")
    model = models.get(_stem(file.model, ".toml"))
    if model is not None:
        _copy(Path(model), place / file.model)
    if (place / file.plan).is_file():
        _bring_controllers(place / file.plan, plans)
    elif file.plan.endswith((".yaml", ".yml")):
        raise BadInputError(
            f"there is no plan '{file.plan}'",
            where=file.document.place(("plan",)),
            fix="send it with the campaign, or upload it to the service first",
        )


def _bring_controllers(plan: Path, plans: Path) -> None:
    where = plan.name
    for file in files_of(plan_from_text(read_text(plan), where, plan.parent, files_required=False)):
        if file.name != str(file):
            raise BadInputError(
                f"loads the file {printable(repr(str(file)), 100)}",
                where=where,
                fix="a plan that is given to the service loads controllers by their names",
            )
        _copy(plans / file, plan.parent / file)


def _copy(source: Path, target: Path) -> None:
    """What was sent comes before what the service has."""
    if not target.exists() and source.is_file():
        shutil.copyfile(source, target)


def _with_bench(file: CampaignFile, benches: Mapping[str, str]) -> str:
    """The campaign's text with a bench of the service named by its path.

    Raises:
        BadInputError: the service has no bench of this name.
    """
    built_in = shipped(f"{file.bench}.toml") if file.bench in shipped_benches() else None
    path = Path(benches[file.bench]) if file.bench in benches else built_in
    if path is None:
        raise BadInputError(
            f"there is no bench {printable(repr(file.bench), 100)}",
            where=file.document.place(("bench",)),
            fix=did_you_mean(file.bench, [*benches, *shipped_benches()]),
        )
    span = file.document.spans.get(("bench",))
    if path == built_in or span is None:
        return file.text
    return file.text[: span[0]] + json.dumps(str(path), ensure_ascii=False) + file.text[span[1] :]


def _stem(name: str, *endings: str) -> str:
    for ending in endings:
        name = name.removesuffix(ending)
    return name
