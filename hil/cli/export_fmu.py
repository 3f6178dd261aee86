"""`hil export-fmu`: a model with its controller for other simulation tools."""

from __future__ import annotations

from hil.app.results_folder import refuse_file
from hil.cli._output import console, print_json
from hil.cli.commands.export_fmu import ExportFmu
from hil.core.controller import load_controller
from hil.core.errors import BadInputError
from hil.core.files import read_text
from hil.core.model import load_model
from hil.fmu import export_fmu


def carry_out(options: ExportFmu) -> int:
    """Carry the command out; its exit code."""
    out = options.out
    if out.suffix.lower() != ".fmu":
        raise BadInputError("is not the name of an FMU", where=str(out), fix="give a name that ends in .fmu")
    refuse_file(
        out,
        [options.model, *([options.controller] if options.controller else [])],
        overwrite=options.overwrite,
    )
    chosen = load_model(options.model)
    loaded = (
        (load_controller(options.controller), read_text(options.controller)) if options.controller else None
    )
    export_fmu(chosen, out, loaded)
    asked = "driving_torque_ref_nm" if options.controller else "motor_torque_ref_nm"
    if options.as_json:
        print_json({"file": str(out), "fmi": "2.0", "kind": "co-simulation", "input": asked})
        return 0
    console().print(
        f"{out}: FMI 2, co-simulation; input {asked}; computes where eaxle-hil is installed",
        highlight=False,
        soft_wrap=True,
        markup=False,
    )
    return 0
