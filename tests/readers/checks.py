"""What is read by what: each check gives the tool's version and what it said, or raises AssertionError."""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
import sys
from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

import can
import numpy as np

from hil.core.can_logs import read_can_log
from hil.core.errors import BadInputError
from hil.core.recording import read_as_written
from tests.readers import reports, tools

HERE = Path(__file__).parent


@dataclass(frozen=True)
class Check:
    """An output and who reads it; `read` gives version and result."""

    output: str
    tool: str
    read: Callable[[Path], tuple[str, str]]


def _python(code: str, *files: Path) -> str:
    """What a few lines print in a process that has the tools of PyPI."""
    environment = {**os.environ, "PYTHONPATH": str(tools.python_packages())}
    command = [sys.executable, "-W", "ignore", "-c", code, *map(str, files)]
    done = subprocess.run(command, capture_output=True, text=True, env=environment, timeout=600)
    assert done.returncode == 0, done.stderr[-1000:]
    return done.stdout.strip()


def _polars(kind: str) -> Callable[[Path], tuple[str, str]]:
    code = f"""
import sys, polars as p
t = p.read_{kind}(sys.argv[1])
assert all(d == p.Float64 for d in t.dtypes), t.dtypes
print(p.__version__); print(f"{{t.height}} rows, {{t.width}} columns, all Float64")"""

    def read(folder: Path) -> tuple[str, str]:
        version, said = _python(code, folder / f"table.{kind}").splitlines()
        return version, said

    return read


def _duckdb(kind: str) -> Callable[[Path], tuple[str, str]]:
    code = """
import sys, duckdb
r = duckdb.sql(f"select * from '{sys.argv[1]}'")
assert all(str(t) == "DOUBLE" for t in r.types), r.types
print(duckdb.__version__); print(f"{len(r.fetchall())} rows, {len(r.columns)} columns, all DOUBLE")"""

    def read(folder: Path) -> tuple[str, str]:
        version, said = _python(code, folder / f"table.{kind}").splitlines()
        return version, said

    return read


def _mdfreader(folder: Path) -> tuple[str, str]:
    code = """
import sys, importlib.metadata, mdfreader
m = mdfreader.Mdf(sys.argv[1])
names = [n for n in m if n.endswith(("_nm", "_rad_s", "_m_s"))]
units = [m.get_channel_unit(n) for n in names]
assert names and all(units), list(zip(names, units))
print(importlib.metadata.version("mdfreader"))
print(f"{len(m.get_channel_data(names[0]))} samples, {len(names)} channels, each with its unit")"""
    version, said = _python(code, folder / "table.mf4").splitlines()
    return version, said


def _junit(folder: Path) -> tuple[str, str]:
    code = """
import sys, importlib.metadata, junitparser
x = junitparser.JUnitXml.fromfile(sys.argv[1])
cases = [c for s in x for c in s]
print(importlib.metadata.version("junitparser"))
print(f"{len(cases)} cases, {len({c.classname for c in cases})} classes")"""
    version, said = _python(code, folder / "junit.xml").splitlines()
    return version, said


def _jenkins(folder: Path) -> tuple[str, str]:
    """Jenkins reads properties of test cases; the schema is older than these."""
    code = """
import sys
from lxml import etree
schema, file = etree.XMLSchema(etree.parse(sys.argv[1])), etree.parse(sys.argv[2])
properties = file.findall(".//testcase/properties")
for one in properties:
    one.getparent().remove(one)
schema.assertValid(file)
print(f"valid; not counted: properties of {len(properties)} test cases, which it does not know")"""
    said = _python(code, tools.jenkins_schema(), folder / "junit.xml").strip()
    return "10", said


def _mcap_library(folder: Path) -> tuple[str, str]:
    code = """
import sys, importlib.metadata
from mcap.stream_reader import StreamReader
from mcap.records import Message
last = count = late = 0
with open(sys.argv[1], "rb") as file:
    for r in StreamReader(file, validate_crcs=True).records:
        if isinstance(r, Message):
            count, late, last = count + 1, late + (r.log_time < last), max(last, r.log_time)
assert late == 0 and last > 1.7e18, (late, last)
print(importlib.metadata.version("mcap")); print(f"{count} messages, checksums agree, none out of order")"""
    version, said = _python(code, folder / "recording.mcap").splitlines()
    return version, said


def _doctor(folder: Path) -> tuple[str, str]:
    """The official command line, where somebody has built it from its source."""
    done = subprocess.run(
        [_there("mcap"), "doctor", "--strict-message-order", folder / "recording.mcap"],
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr[-1000:]
    assert "Warning" not in done.stderr, done.stderr[-1000:]
    return tools.ran("mcap", "version").strip() or "built from source", "no error, no warning"


def _there(name: str) -> str:
    found = shutil.which(name)
    if found is None:
        raise tools.NotHereError(f"there is no {name}")
    return found


def _verapdf(flavour: str) -> Callable[[Path], tuple[str, str]]:
    def read(folder: Path) -> tuple[str, str]:
        main = "org.verapdf.apps.GreenfieldCliWrapper"
        jar = next(tools.jars().glob("greenfield-apps-*.jar"))
        said = tools.ran(
            "java", "-cp", jar, main, "-f", flavour, "--format", "text", folder / "report.pdf", allowed=(0, 1)
        )
        assert said.splitlines()[-1].startswith("PASS"), said
        return tools.version_of("greenfield-apps"), "passes"

    return read


def _nu(folder: Path) -> tuple[str, str]:
    main = "nu.validator.client.SimpleCommandLineValidator"
    page = folder / "report.html"
    said = tools.ran(
        "java", "-cp", f"{tools.jars()}/*", main, "--format", "json", "--stdout", page, allowed=(0, 1)
    )
    found = Counter(message["message"] for message in json.loads(said)["messages"])
    assert not found, found.most_common(5)
    return tools.version_of("validator"), "no error, no warning"


def _axe(folder: Path) -> tuple[str, str]:
    modules, chromium = tools.node_modules(), _there("chromium")
    script = modules / "page.js"
    shutil.copy(HERE / "page.js", script)
    versions = set()
    for width in ("1280", "420"):
        for scheme in ("light", "dark"):
            told = tools.ran("node", script, folder / "report.html", width, scheme, chromium, cwd=modules)
            found = json.loads(told)
            versions.add(found["version"])
            assert not found["violations"], (width, scheme, found["violations"])
            assert not found["errors"], found["errors"]
            assert found["wider"] <= 0, (width, found["wider"])
    browser = re.search(r"[\d.]+", tools.ran(chromium, "--version"))
    where = f"in Chromium {browser[0].split('.')[0] if browser else ''}"
    return (
        f"{versions.pop()} {where}",
        "no violation at 1280 and 420 px, light and dark; nothing wider than those",
    )


def _python_can(ending: str) -> Callable[[Path], tuple[str, str]]:
    code = """
import sys, can
buses = {}
for m in can.LogReader(sys.argv[1]):
    buses[m.channel] = buses.get(m.channel, 0) + 1
print(can.__version__); print(", ".join(f"{n} frames of {b}" for b, n in buses.items()))"""

    def read(folder: Path) -> tuple[str, str]:
        version, said = _python(code, folder / f"frames.{ending}").splitlines()
        return version, said

    return read


def _replayed(log: Path, run: Path, *arguments: str) -> str:
    """What `hil replay` says of a log of the run's frames, whose channels are held against the run's own."""
    out = log.with_suffix("")
    hil = Path(sys.executable).parent / "hil"
    command: list[str | Path] = [
        hil,
        "replay",
        log,
        "--bench",
        "sim",
        "--out",
        out,
        "--overwrite",
        *arguments,
    ]
    done = subprocess.run(command, capture_output=True, text=True, timeout=600)
    assert done.returncode == 0, done.stderr[-1000:]
    ours, theirs = read_as_written(out / "recording.mcap"), read_as_written(run)
    count = len(theirs.time_s)
    speed, wanted = ours["motor_speed_rad_s"], theirs["motor_speed_rad_s"]
    first = next(k for k in range(len(speed)) if np.array_equal(speed[k : k + count], wanted))
    for name, values in theirs.channels.items():
        if name != "time_s":
            assert np.array_equal(ours[name][first : first + count], values, equal_nan=True), name
    return f"replayed: {len(theirs.channels) - 1} channels of {count} samples, each value the run's"


def _can_utils(kind: str) -> Callable[[Path], tuple[str, str]]:
    """Logs that log2asc (ASC) and asc2log (candump) of can-utils have written."""

    def read(folder: Path) -> tuple[str, str]:
        asc = folder / "can_utils.asc"
        tools.ran("log2asc", "-I", folder / "frames.log", "-O", asc, "rmcu", "dyno")
        if kind == "log":
            tools.ran("asc2log", "-I", asc, "-O", folder / "can_utils.log")
        version = re.search(r"Version: (\S+)", tools.ran("dpkg", "-s", "can-utils"))
        return version[1] if version else "–", _replayed(
            folder / f"can_utils.{kind}", folder / "recording.mcap"
        )

    return read


def _logs_of_python_can(folder: Path) -> tuple[str, str]:
    """The logs of Vector's and PEAK's tools that python-can is tested with: none of their frames is lost."""
    del folder
    found = Counter[str]()
    source = tools.python_can_source()
    for path in sorted((source / "test/data").iterdir()):
        if path.suffix not in (".asc", ".blf", ".trc"):
            continue
        try:
            log = read_can_log(path)
            counts = log.count + sum(log.left_out.values())
        except BadInputError as error:  # only what a recording has no place for
            assert "has no data frames" in error.what, error
            counts = sum(map(int, re.findall(r"(\d+) (?:remote|CAN FD|frames)", error.fix)))
        with can.LogReader(path) as reader:
            wanted = len(list(reader))
        assert counts == wanted, (path.name, counts, wanted)
        found[path.suffix] += 1
    return can.__version__, ", ".join(
        f"{n} logs in {kind}" for kind, n in found.items()
    ) + ": every frame counted"


def _validated(command: str) -> Callable[[Path], tuple[str, str]]:
    def read(folder: Path) -> tuple[str, str]:
        if not (folder / "mine").exists():
            reports.inputs(folder)
        mine = reports.written(folder, command)
        versions = [check(mine)[0] for check in (_nu, _axe, _verapdf("2a"), _verapdf("ua1"))]
        return ", ".join(dict.fromkeys(versions)), "all pass, as the run's"

    return read


def checks_of_reports() -> Iterator[Check]:
    """Of the reports that other commands write; they take minutes to make."""
    for command in reports.REPORTS:
        yield Check(
            f"report of `hil {command}`",
            "Nu HTML checker, axe-core, veraPDF 2a and UA-1",
            _validated(command),
        )


def checks() -> Iterator[Check]:
    """All that is written of a run, by output."""
    yield Check("recording.mcap", "mcap (PyPI)", _mcap_library)
    yield Check("recording.mcap", "mcap doctor --strict-message-order", _doctor)
    for kind in ("csv", "parquet"):
        yield Check(f"export to .{kind}", "polars", _polars(kind))
        yield Check(f"export to .{kind}", "duckdb", _duckdb(kind))
    yield Check("export to .mf4", "mdfreader", _mdfreader)
    for ending, name in (("blf", "BLF"), ("asc", "ASC"), ("log", "candump"), ("mf4", "MDF4 bus logging")):
        yield Check(f"frames as {name}", "python-can", _python_can(ending))
    yield Check("logs of others, replayed", "can-utils log2asc", _can_utils("asc"))
    yield Check("logs of others, replayed", "can-utils asc2log", _can_utils("log"))
    yield Check("logs of others, read", "python-can's test logs", _logs_of_python_can)
    for flavour, name in (("2a", "PDF/A-2a"), ("2b", "PDF/A-2b"), ("ua1", "PDF/UA-1")):
        yield Check("report.pdf", f"veraPDF, {name}", _verapdf(flavour))
    yield Check("report.html", "Nu HTML checker", _nu)
    yield Check("report.html", "axe-core", _axe)
    yield Check("junit.xml", "junitparser", _junit)
    yield Check("junit.xml", "schema of Jenkins' xUnit plugin", _jenkins)
