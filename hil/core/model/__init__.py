"""Model files (docs/reference/models.md): a plant's equations by kind, its parameters, its effects."""

from __future__ import annotations

import logging
from pathlib import Path
from typing import Any

import tomli_w

from hil.core.chain import WHEEL_RADIUS_M
from hil.core.errors import BadInputError
from hil.core.files import write_atomically
from hil.core.files.shipped import shipped_file
from hil.core.files.toml_file import FORMAT, parse_toml, toml_text
from hil.core.model._reading import model_from_dict
from hil.core.model._types import (
    LOAD_INPUTS,
    MODEL_KINDS,
    SPEED_INPUT,
    WHEEL_RADII_M,
    EffectUse,
    Model,
    TransferFunction,
    kind_of,
    parameter_names,
    parameter_of_effect,
    parameter_unit,
)

logger = logging.getLogger(__name__)


def load_model(path: Path) -> Model:
    """Read a model file, or a shipped one by its name.

    Raises:
        BadInputError: not readable, not TOML, or every key that is unknown, missing or not physical.
    """
    path = shipped_file(path, "model")
    text = toml_text(path)
    model = model_from_dict(parse_toml(text, str(path)), str(path), text)
    effects = ", ".join(use.id for use in model.effects) or "none"
    logger.debug("model %s: %s, effects: %s", path, model.kind, effects)
    return model


def save_model(model: Model, path: Path) -> None:
    """Write a model file that `load_model` reads back to the same model."""
    write_atomically(path, model_to_toml(model))


def model_to_toml(model: Model) -> str:
    """The text of a model file."""
    data: dict[str, Any] = {"format": FORMAT, "kind": model.kind}
    if model.wheel_radius_m != WHEEL_RADIUS_M:
        data["wheel_radius_m"] = model.wheel_radius_m
    if model.load_input:
        data["load_input"] = model.load_input
    if model.parameters:
        data["parameters"] = dict(model.parameters)
    if model.tolerance:
        data["tolerance"] = dict(model.tolerance)
    if model.transfer_functions:
        data["transfer_functions"] = {
            name: {"numerator": list(f.numerator), "denominator": list(f.denominator), "delay": f.delay_s}
            for name, f in model.transfer_functions.items()
        }
    if model.effects:
        data["effects"] = [{"id": use.id, **use.values} for use in model.effects]
    if model.meta:
        data["meta"] = model.meta
    return tomli_w.dumps(data)


def refuse_without_vehicle(model: Model, where: str, fix: str) -> None:
    """Refuse a model that takes its load from recordings where the vehicle is needed; `fix` is what to do.

    Raises:
        BadInputError: it has a `load_input`.
    """
    if model.load_input:
        raise BadInputError(
            f"the model takes {model.load_input} from recordings and does not hold the vehicle",
            where=where,
            fix=f"{fix} with a model of axle and vehicle, without load_input",
        )


__all__ = [
    "LOAD_INPUTS",
    "MODEL_KINDS",
    "SPEED_INPUT",
    "WHEEL_RADII_M",
    "EffectUse",
    "Model",
    "TransferFunction",
    "kind_of",
    "load_model",
    "model_from_dict",
    "model_to_toml",
    "parameter_names",
    "parameter_of_effect",
    "parameter_unit",
    "refuse_without_vehicle",
    "save_model",
]
