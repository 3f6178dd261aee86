"""What there is to choose from, as a table and as JSON."""

from __future__ import annotations

import importlib.metadata
import json

import pytest

from hil.cli._app import guarded
from hil.cli.commands.list import _tell
from hil.core.effects import EFFECTS
from hil.core.files.shipped import shipped_names
from hil.engine.bench.device_kinds import KINDS
from test_plans import METRICS, STEPS, library_plans


def listed(what, capsys):
    assert guarded(["list", what, "--json"]) == 0
    return json.loads(capsys.readouterr().out)[what]


@pytest.mark.parametrize(
    ("what", "names"),
    [
        ("plans", library_plans()),
        ("models", shipped_names("model")),
        ("effects", tuple(EFFECTS)),
        ("steps", STEPS.names()),
        ("metrics", METRICS.names()),
        ("devices", KINDS.names()),
    ],
)
def test_every_one_is_listed_with_what_it_is(what, names, capsys):
    rows = listed(what, capsys)
    assert [row["name"] for row in rows] == list(names)
    assert all(row["title"] for row in rows)
    assert guarded(["list", what]) == 0
    told = capsys.readouterr().out
    assert all(name in told for name in names)


def test_benches_say_which_are_simulated(capsys):
    rows = {row["name"]: row["simulated"] for row in listed("benches", capsys)}
    assert rows["sim"] is True
    assert rows["rear_axle_socketcan"] is False


def test_optional_keys_are_marked(capsys):
    keys = {row["name"]: row["keys"] for row in listed("steps", capsys)}
    assert {"segment", "bias_nm?"} <= set(keys["chirp"])
    assert keys["hold_speed"] == ["speed_km_h", "duration_s"]


def test_a_word_nearly_right_is_answered_with_the_right_one(capsys):
    assert guarded(["list", "plan"]) == 2
    assert "did you mean 'plans'?" in capsys.readouterr().err


def test_the_version(capsys):
    assert guarded(["--version"]) == 0
    assert capsys.readouterr().out == f"hil {importlib.metadata.version('eaxle-hil')}\n"


def test_names_of_tables_are_no_markup(capsys):
    _tell([{"name": "a", "title": "what [rmcu] and [devices.NAME] hold"}])
    assert "what [rmcu] and [devices.NAME] hold" in capsys.readouterr().out
