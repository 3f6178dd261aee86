"""Exported units, and what FMPy makes of them."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import zipfile
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest

from hil.cli._app import guarded
from hil.core.model import load_model
from hil.fmu import Axle
from tests.benches_for_tests import SIM
from tests.hil.fmu.test_axle import CONTROLLER, gap, stepped
from tests.readers.tools import PLACE, NotHereError, ran

MODEL = SIM.simulation.model
IN_FMPY = """import json, sys
import fmpy.validation, numpy
unit, asked, out = sys.argv[1:]
assert not fmpy.validation.validate_fmu(unit)
time = numpy.arange(0, 2.001, 1e-3)
torque = numpy.where(time > 0.2, 20.0 if asked.startswith("motor") else 200.0, 0.0)
rows = numpy.array(list(zip(time, torque)), dtype=[("time", float), (asked, float)])
found = fmpy.simulate_fmu(unit, stop_time=2.0, step_size=1e-3, output_interval=1e-3, input=rows)
json.dump({name: found[name].tolist() for name in found.dtype.names}, open(out, "w"))
"""


def command(*arguments: object) -> int:
    return int(guarded([*map(str, arguments)]))


def test_a_unit_holds_what_it_needs(tmp_path: Path, capsys) -> None:
    out = tmp_path / "axle.fmu"
    assert command("export", MODEL, "--controller", CONTROLLER, "--out", out, "--json") == 0
    assert json.loads(capsys.readouterr().out)["input"] == "driving_torque_ref_nm"
    with zipfile.ZipFile(out) as unit:
        names = unit.namelist()
        description = unit.read("modelDescription.xml").decode()
    assert {"resources/model.toml", "resources/controller.toml", "binaries/linux64/EAxle.so"} <= set(names)
    assert 'fmiVersion="2.0"' in description
    assert 'stopTime="10.0" stepSize="0.001"' in description
    root = ElementTree.fromstring(description)
    defined = {unit.attrib["name"] for unit in root.iterfind("UnitDefinitions/Unit")}
    used = {variable[0].attrib["unit"] for variable in root.iterfind("ModelVariables/ScalarVariable")}
    assert used == defined
    assert root.find("ModelVariables/ScalarVariable[@name='shaft_torque_nm']/Real[@unit='N.m']") is not None
    assert "needs Python with the package eaxle-hil" in description
    assert command("export", MODEL, "--out", out) == 2
    assert [path.name for path in tmp_path.iterdir()] == ["axle.fmu"]


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        ((MODEL, "--out", "axle.zip"), "give a name that ends in .fmu"),
        (("none.toml", "--out", "axle.fmu"), "none.toml"),
        ((MODEL, "--controller", MODEL, "--out", "axle.fmu"), "three_inertia.toml"),
    ],
)
def test_bad_input_is_one_message(tmp_path: Path, capsys, arguments, said: str) -> None:
    named = [tmp_path / str(a) if str(a).startswith("axle") else a for a in arguments]
    assert command("export", *named) == 2
    assert said in capsys.readouterr().err
    assert not list(tmp_path.iterdir())


@pytest.mark.slow
@pytest.mark.parametrize("controlled", [False, True])
def test_fmpy_computes_what_our_kernel_does(tmp_path: Path, controlled: bool) -> None:
    folder = PLACE / "fmpy"
    try:
        if not (folder / "fmpy").is_dir():
            ran(sys.executable, "-m", "pip", "install", "--quiet", "--target", folder, "fmpy")
    except NotHereError as error:
        pytest.skip(str(error))
    unit, found = tmp_path / "axle.fmu", tmp_path / "found.json"
    options = ("--controller", CONTROLLER) if controlled else ()
    assert command("export", MODEL, *options, "--out", unit) == 0
    asked = "driving_torque_ref_nm" if controlled else "motor_torque_ref_nm"
    done = subprocess.run(
        [sys.executable, "-c", IN_FMPY, str(unit), asked, str(found)],
        env={**os.environ, "PYTHONPATH": str(folder)}, capture_output=True, text=True, timeout=120,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    theirs = json.loads(found.read_text())
    from hil.core.controller import load_controller

    axle = Axle(load_model(MODEL), load_controller(CONTROLLER) if controlled else None)
    time_s = np.arange(0, 2.001, 1e-3)
    ours = stepped(axle, np.where(time_s > 0.2, 200.0 if controlled else 20.0, 0.0))
    for name in ("motor_speed_rad_s", "wheel_speed_rad_s", "shaft_torque_nm", "vehicle_speed_m_s"):
        right = np.array(ours[name])[: len(theirs[name])]
        assert gap(np.array(theirs[name]), right) < 1e-3
