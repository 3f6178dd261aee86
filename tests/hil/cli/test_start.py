"""Commands start fast: each imports what it needs, when it needs it."""

import importlib
import inspect
import pkgutil
import subprocess
import sys

import pytest

from hil.analysis.control_design import DesignSpec
from hil.analysis.identification import ORDERS
from hil.cli import commands
from hil.cli._app import guarded
from hil.cli._commands import GROUPS, RENAMED, TOPICS, WITHOUT_CAN, command_names, options_of
from hil.core.channels import INPUT
from tests.hil.cli.test_commands import hil

SLOW = {
    "numpy",
    "scipy",
    "numba",
    "pandas",
    "pyarrow",
    "pydantic",
    "can",
    "asammdf",
    "matplotlib",
    "plotly",
    "rich",
}
_SHOW_MODULES = (
    "import sys; sys.argv[0] = 'hil'\n"
    "from hil.cli import main\n"
    "try: main()\n"
    "finally: print('\\n'.join(sys.modules), file=sys.stderr)"
)


def modules_of(*arguments):
    """What a command's process has imported when it ends."""
    done = subprocess.run(
        [sys.executable, "-c", _SHOW_MODULES, *arguments], capture_output=True, text=True, check=True
    )
    return set(done.stderr.split())


def test_every_command_is_listed_and_every_listed_one_is_there(capsys):
    modules = {name.replace("-", "_").replace(" ", "_") for name in command_names()}
    there = {module.name for module in pkgutil.iter_modules(commands.__path__)}
    assert modules == {name for name in there if not name.startswith("_")}
    assert guarded(["--help"]) == 0
    told = capsys.readouterr().out
    assert guarded([]) == 0
    assert capsys.readouterr().out == told
    listed = [(name, text) for commands in TOPICS.values() for name, text in commands.items()]
    assert all(f"  {name} " in told and text in told for name, text in listed)
    assert len(listed) <= 20


@pytest.mark.parametrize("group", GROUPS)
def test_a_group_lists_its_commands(group, capsys):
    for arguments in ([group], [group, "--help"]):
        assert guarded(arguments) == 0
        told = capsys.readouterr().out
        assert f"Usage: hil {group} COMMAND" in told
        assert all(f"  {name} " in told and text in told for name, text in GROUPS[group].items())
    assert guarded([group, "docter"]) == 2
    assert f"there is no command '{group} docter'" in capsys.readouterr().err
    assert guarded([next(iter(GROUPS[group])), "--help"]) == 0  # its name alone was a command


@pytest.mark.parametrize(("earlier", "name"), RENAMED.items())
def test_an_earlier_name_works_and_tells_the_new_one(earlier, name, capsys):
    assert guarded([earlier, "--help"]) == 0
    told = capsys.readouterr()
    assert f"Usage: hil {name} " in told.out
    assert f"note: 'hil {earlier}' is now 'hil {name}'" in told.err


@pytest.mark.parametrize("name", command_names())
def test_the_work_takes_the_options_of_its_command(name):
    work = inspect.signature(
        importlib.import_module(f"hil.cli.commands.{name.replace('-', '_').replace(' ', '_')}").execute
    )
    assert [one.annotation for one in work.parameters.values()] == [options_of(name).__name__]


@pytest.mark.parametrize("name", command_names())
def test_help_imports_nothing_slow(name, capsys):
    assert guarded([*name.split(), "--help"]) == 0
    assert f"hil {name}" in capsys.readouterr().out


def test_help_of_a_run_imports_nothing_slow():
    assert not modules_of("run", "--help") & SLOW


def test_options_say_the_defaults_that_the_work_would_take():
    def defaults(name):
        options = inspect.signature(options_of(name)).parameters
        return {key: option.default for key, option in options.items()}

    paper, given = DesignSpec(), defaults("design")
    for option in ("lead_deg", "lead_hz", "normalisation", "notch_width", "notch_depth", "objective"):
        assert given[option] == getattr(paper, option)
    assert given["pole"] == paper.pole_rad_s
    assert given["torque_limit"] == paper.torque_limit_nm
    assert given["largest_sensitivity"] == paper.limits.sensitivity_peak
    assert defaults("identify")["input_channel"] == INPUT
    for order in (ORDERS[0] - 1, ORDERS[-1] + 1):
        assert guarded(["identify", "x.csv", "--out", "x", "--order", str(order)]) == 2


def test_checking_a_plan_leaves_out_what_it_does_not_use(tmp_path):
    plan = tmp_path / "p.yaml"
    plan.write_text("name: p\nsteps:\n  - wait: {duration_s: 0.1}\n")
    hil("check", plan)  # the kernels are in the cache from here on
    modules = modules_of("check", str(plan))
    assert "can" in modules
    for name in ("asammdf", "pandas", "pyarrow", "matplotlib", "plotly", "typst", "jinja2"):
        assert name not in modules
    assert "numba.np.arraymath" not in modules, "what is loaded needs none of numba's implementations"


@pytest.mark.parametrize("name", sorted(WITHOUT_CAN))
def test_commands_without_a_bus_import_no_python_can(name):
    code = f"import hil.cli.commands.{name}, sys; print(' '.join(sys.modules))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert not {"can", "asammdf"} & {*done.stdout.split()}


def test_asammdf_can_be_imported_after_python_can(tmp_path):
    code = (
        "from hil.app.worker.lean_imports import import_python_can as i; i()\n"
        "import can, sys; assert 'asammdf' not in sys.modules\n"
        "import asammdf; print(asammdf.MDF.__name__)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout == "MDF\n"
