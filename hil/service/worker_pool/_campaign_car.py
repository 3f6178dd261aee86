"""A simulation of a campaign as files of the service, so that its car can be run on a simulated bench."""

from __future__ import annotations

import json
import tomllib
from pathlib import Path
from typing import Any

import tomli_w

from hil.campaign import Simulations, load_setting
from hil.core.controller import controller_to_toml
from hil.core.errors import BadInputError
from hil.core.model import model_to_toml
from hil.engine import BenchFile
from hil.service.worker_pool._campaigning import CAMPAIGN
from hil.service.worker_pool.plan_reading import renamed
from test_plans import Choices, Plan
from test_plans.yaml_document import read_yaml

_AXLE = "-axle"  # a bench file and the model beside it cannot have one name


def files(folder: str, simulation: int, name: str) -> dict[str, Any]:
    """Fields of `SimulationFiles` for a number of the campaign whose files lie in `folder`.

    Args:
        name: of bench, plan and controller; the model's is made of it.

    Raises:
        BadInputError: there is no such simulation, or its bench cannot be simulated in a process.
    """
    setting = load_setting(Path(folder) / CAMPAIGN)
    if simulation >= len(setting.cases):
        what = f"there is no simulation {simulation}: the campaign has {len(setting.cases)}"
        raise BadInputError(what, where="campaign", fix="choose one from 0 to the last")
    plan, car, controller = Simulations(setting).made_of(simulation)
    bench = _bench(setting.bench, name, car.noise, car.seed)
    named = None if controller is None else controller.model_copy(update={"name": name})
    return {
        "name": name,
        "model_name": f"{name}{_AXLE}",
        "plan": _plan_text(plan, name, None if named is None else setting.replaced),
        "model": model_to_toml(car.model),
        "bench": bench,
        "controller": None if named is None else controller_to_toml(named),
    }


def _bench(bench: BenchFile, name: str, noise: float, seed: int) -> str:
    """The campaign's bench with the car in place of its model, and noise as in the simulation."""
    if bench.simulation is None:
        what = f"the bench '{bench.name}' is not simulated"
        raise BadInputError(what, where="bench", fix="take a simulated bench for the campaign")
    data = tomllib.loads(bench.text)
    sensors = bench.simulation.noise.model_dump()
    data["name"] = name
    for bus in data["buses"].values():  # a simulated bus is called by its bench
        bus["channel"] = f"{name}/{str(bus['channel']).rpartition('/')[2]}"
    data["simulation"] |= {
        "model": f"{name}{_AXLE}.toml",
        "seed": seed,
        "noise": {channel: noise * deviation for channel, deviation in sensors.items()},
    }
    return tomli_w.dumps(data)


def _plan_text(plan: Plan, name: str, replaced: Path | None) -> str:
    """The plan with the car's controller in place of one, found beside it by name."""
    text = plan.text
    if replaced is not None:
        target = plan.source.parent / f"{name}.toml"
        loaded = next((one for one in (str(replaced), replaced.name) if one in text), replaced.name)
        text = Choices(controllers={loaded: target}).applied(text, read_yaml(text, str(plan.source)))
        text = text.replace(json.dumps(str(target), ensure_ascii=False), json.dumps(target.name))
    return renamed(text, name)
