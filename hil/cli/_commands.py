"""Which commands there are: in groups, with a line each for `hil --help`, and what earlier names became."""

from __future__ import annotations

import difflib
import importlib
from typing import Any

from hil.app.worker.lean_imports import import_python_can
from hil.cli.options import benches, controllers, files, models, runs
from hil.core.errors import BadInputError

#: Name and line of each command, by the topic under which `hil --help` has it. Its options
#: are the class NAME in a module of hil.cli.options, its work is hil.cli.commands.NAME (_ for a blank).
TOPICS: dict[str, dict[str, str]] = {
    "Runs": {
        "run": "Run a test plan on a bench and write its report.",
        "check": "Validate a plan; predict its duration, peaks and criteria.",
        "compare": "Compare runs of a plan or of its copies side by side.",
        "report": "Renew a report from its recording.",
        "export": "Write a recording for other tools, or a model as an FMU.",
        "replay": "Decode CAN logs of other tools to a recording and report on it.",
    },
    "Models": {
        "identify": "Identify frequency responses and model parameters from recordings.",
        "diagnose": "Find where a model and recordings disagree; identify the missing effect and add it.",
        "simulate": "Replay a recording's torque through a model.",
        "explain": "Find model changes that reproduce target values.",
    },
    "Controllers": {
        "design": "Design a controller for a model; show its stability margins.",
        "tune": "Optimise a controller's parameters for a plan's criteria.",
        "autotune": "Identify, diagnose, tune and confirm on a bench, in rounds, unattended.",
        "campaign": "Simulate a plan many times: vary parameters, sample vehicles, compare controllers.",
    },
    "Benches and evidence": {
        "bench": "Examine and operate a bench: doctor, monitor, jog, reset, sim, agent.",
        "evidence": "Prove and mend recordings and reports: verify, sign, recover.",
        "serve": "Run the bench service: run queue, REST API and live page.",
    },
    "Files": {
        "init": "Make a folder that is ready to run: plan, bench, model, controller.",
        "list": "List plans, benches, models, effects, steps, metrics and devices.",
        "schema": "Print the JSON schema of plan, bench, model, controller or campaign files.",
    },
}
_OPTIONS = (runs, models, controllers, benches, files)
#: Commands without a bus: python-can takes a tenth of a second to import, with asammdf half a second.
WITHOUT_CAN = {"design", "diagnose", "identify", "simulate"}
#: Commands of a group.
GROUPS: dict[str, dict[str, str]] = {
    "bench": {
        "doctor": "Check a bench's devices; report faults and remedies.",
        "monitor": "Show decoded channels and bus load live; send nothing.",
        "jog": "Turn the axle at low torque and check the sign of every sensor.",
        "reset": "Reset an emergency stop so that the bench can be armed again.",
        "sim": "Run the simulated bench in its own process, in real time.",
        "agent": "Drive benches of this machine for a bench service on another machine.",
    },
    "evidence": {
        "verify": "Verify that reports match their recording and that no file changed.",
        "sign": "Sign a run's directory as its approver.",
        "recover": "Recover a recording after a crash.",
    },
}
#: Earlier names, which are taken for one release more, and what they are now.
RENAMED = {
    "doctor": "bench doctor",
    "monitor": "bench monitor",
    "jog": "bench jog",
    "reset": "bench reset",
    "sim-bench": "bench sim",
    "agent": "bench agent",
    "verify": "evidence verify",
    "sign": "evidence sign",
    "recover": "evidence recover",
    "export-fmu": "export",
}


def command_names() -> list[str]:
    """All commands, those of a group with its name: "bench doctor"."""
    top = [name for commands in TOPICS.values() for name in commands if name not in GROUPS]
    return [*top, *(f"{group} {name}" for group, commands in GROUPS.items() for name in commands)]


def options_of(name: str) -> type[Any]:
    """The class of a command's options, named as it is (BenchDoctor); `--help` shows its docstring."""
    wanted = name.title().replace("-", "").replace(" ", "")
    found: type[Any] = next(vars(topic)[wanted] for topic in _OPTIONS if wanted in vars(topic))
    return found


def execute(name: str, chosen: object) -> int:
    """Execute a command; its exit code."""
    if name not in WITHOUT_CAN:
        import_python_can()
    code: int = importlib.import_module(f"hil.cli.commands.{_module_name(name)}").execute(chosen)
    return code


def _module_name(name: str) -> str:
    return name.replace("-", "_").replace(" ", "_")


def taken_apart(arguments: list[str]) -> tuple[str, list[str]]:
    """The command that is meant, and what stands behind its name; a group alone is its own name.

    Raises:
        BadInputError: there is no such command.
    """
    name, rest = arguments[0], arguments[1:]
    name = RENAMED.get(name, name)
    if name in GROUPS and rest and not rest[0].startswith("-"):
        commands = GROUPS[name]
        if rest[0] not in commands:
            raise _unknown(f"{name} {rest[0]}", rest[0], list(commands), f"hil {name} --help")
        return f"{name} {rest[0]}", rest[1:]
    if name in GROUPS or name in command_names():
        return name, rest
    within = next((f"{group} {name}" for group, commands in GROUPS.items() if name in commands), "")
    if within:
        raise BadInputError(f"there is no command '{name}'", fix=f"did you mean '{within}'?")
    raise _unknown(name, name, [name for commands in TOPICS.values() for name in commands], "hil --help")


def help_text() -> str:
    """What `hil --help` prints."""
    width = max(len(name) for commands in TOPICS.values() for name in commands)
    lines = ["Usage: hil COMMAND [ARGS]...", "", "Hardware-in-the-loop bench service for electric axles."]
    for topic, commands in TOPICS.items():
        lines += ["", f"{topic}:", *_rows(commands, width)]
    return "\n".join([*lines, "", _MORE])


def group_help(group: str) -> str:
    """What `hil GROUP --help` prints."""
    commands = GROUPS[group]
    line = next(commands[group] for commands in TOPICS.values() if group in commands).partition(":")[0]
    rows = _rows(commands, max(map(len, commands)))
    more = f"hil {group} COMMAND --help describes a command."
    return "\n".join(
        [f"Usage: hil {group} COMMAND [ARGS]...", "", f"{line}.", "", "Commands:", *rows, "", more]
    )


_MORE = "hil COMMAND --help describes a command. hil --version prints the version."


def _rows(commands: dict[str, str], width: int) -> list[str]:
    return [f"  {name:<{width}}  {text}" for name, text in commands.items()]


def _unknown(name: str, typed: str, known: list[str], see: str) -> BadInputError:
    near = difflib.get_close_matches(typed, known, 1)
    return BadInputError(
        f"there is no command '{name}'", fix=f"did you mean '{near[0]}'?" if near else f"see {see}"
    )
