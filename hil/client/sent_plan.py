"""A plan that a service is given travels with the files that it names: the service knows no path of here."""

from __future__ import annotations

import hashlib
import json
import re
from pathlib import Path

from hil.client import Client, RefusedError
from hil.core.files import read_bytes, read_text
from test_plans import MOST_PICTURE_BYTES, Plan, named_controllers, pictures_of
from test_plans.yaml_document import read_yaml

_TAKEN = 409
_LONGEST = 40


def give_plan(client: Client, plan: Plan) -> str:
    """Give a service a plan with the controllers and pictures that lie here; its name there.

    The plan says there what each controller is called there; in all else it is the same.

    Raises:
        RefusedError: the service refuses the plan, a controller or a picture.
        BadInputError: a controller or a picture cannot be read.
    """
    document = read_yaml(plan.text, str(plan.source))
    changes: dict[tuple[int, int], str] = {}
    for place, name in named_controllers(document).items():
        file = plan.source.parent / name
        if file.is_file():  # else it is built in, there as here
            changes[document.spans[place]] = json.dumps(f"{_given(client, file)}.toml")
    for picture in pictures_of(plan):
        client.give_picture(picture, read_bytes(plan.source.parent / picture, MOST_PICTURE_BYTES))
    text = plan.text
    for start, end in sorted(changes, reverse=True):
        text = text[:start] + changes[start, end] + text[end:]
    return client.give_plan(plan.name, text).name


def _given(client: Client, file: Path) -> str:
    """Its name there: its own, or with its hash where that stands for another content."""
    text = read_text(file)
    name = re.sub("[^A-Za-z0-9_-]+", "-", file.stem).strip("-")[:_LONGEST] or "controller"
    try:
        return client.give_controller(name, text).name
    except RefusedError as error:
        if error.status != _TAKEN:
            raise
    return client.give_controller(f"{name}-{hashlib.sha256(text.encode()).hexdigest()[:12]}", text).name
