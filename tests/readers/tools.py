"""Tools of others, installed by name into a folder of their own; no one needs them to use the project."""

from __future__ import annotations

import shutil
import subprocess
import sys
import tarfile
import tempfile
from pathlib import Path

import can
import pytest

PLACE = Path(tempfile.gettempdir()) / "eaxle-hil-readers"
_NODE = ("axe-core", "puppeteer-core")
_PYTHON = ("polars", "duckdb", "junitparser", "lxml", "mdfreader")
_JARS = {"nu.validator:validator": "26.5.2", "org.verapdf.apps:greenfield-apps": "1.28.2"}
_POM = """<project xmlns="http://maven.apache.org/POM/4.0.0"><modelVersion>4.0.0</modelVersion>
<groupId>r</groupId><artifactId>r</artifactId><version>1</version><dependencies>{}</dependencies></project>"""
_COPY = "org.apache.maven.plugins:maven-dependency-plugin:3.6.1:copy-dependencies"


class NotHereError(Exception):
    """A tool cannot be had on this machine; says which, and why."""


def ran(*command: str | Path, cwd: Path | None = None, allowed: tuple[int, ...] = (0,)) -> str:
    """What a program prints.

    Raises:
        NotHereError: there is no such program, or it fails.
    """
    if shutil.which(str(command[0])) is None:
        raise NotHereError(f"there is no {command[0]}")
    done = subprocess.run([str(c) for c in command], cwd=cwd, capture_output=True, text=True, timeout=600)
    if done.returncode not in allowed:
        raise NotHereError(f"{Path(command[0]).name}: {(done.stderr or done.stdout).strip()[-300:]}")
    return done.stdout


def node_modules() -> Path:
    """A folder with the tools of npm; scripts run in it."""
    folder = PLACE / "node"
    if not (folder / "node_modules/axe-core").is_dir():
        folder.mkdir(parents=True, exist_ok=True)
        ran("npm", "install", "--no-audit", "--no-fund", "--prefix", folder, *_NODE)
    return folder


def python_packages() -> Path:
    """A folder with the tools of PyPI, for PYTHONPATH of a process of its own."""
    folder = PLACE / "python"
    if not (folder / "lxml").is_dir():
        ran(sys.executable, "-m", "pip", "install", "--quiet", "--target", folder, *_PYTHON)
    return folder


def python_can_source() -> Path:
    """The source package of python-can: the logs that it is tested with are in no other."""
    return source_package("python-can", can.__version__)


def jenkins_schema() -> Path:
    """The schema of JUnit files of Jenkins' xUnit plugin; pytest tests its own files with it."""
    return source_package("pytest", pytest.__version__) / "testing/example_scripts/junit-10.xsd"


def source_package(name: str, version: str) -> Path:
    """The source of a package of PyPI, unpacked; it is fetched once."""
    folder = PLACE / f"{name.replace('-', '_')}-{version}"
    if not folder.is_dir():
        PLACE.mkdir(parents=True, exist_ok=True)
        download = (
            "-m",
            "pip",
            "download",
            "--quiet",
            "--no-deps",
            "--no-binary",
            name,
            f"{name}=={version}",
        )
        ran(sys.executable, *download, "--dest", PLACE)
        with tarfile.open(PLACE / f"{folder.name}.tar.gz") as archive:
            archive.extractall(PLACE, filter="data")
    return folder


def jars() -> Path:
    """A folder with the tools of Maven and all that they need."""
    folder = PLACE / "jars"
    if not list(folder.glob("greenfield-apps-*.jar")):
        folder.mkdir(parents=True, exist_ok=True)
        for name, version in _JARS.items():
            group, artifact = name.split(":")
            one = f"<groupId>{group}</groupId><artifactId>{artifact}</artifactId><version>{version}</version>"
            (folder / "pom.xml").write_text(_POM.format(f"<dependency>{one}</dependency>"))
            ran("mvn", "-q", "-B", _COPY, f"-DoutputDirectory={folder}", cwd=folder)
    return folder


def version_of(artifact: str) -> str:
    """Version of a tool of Maven."""
    return next(v for name, v in _JARS.items() if name.endswith(f":{artifact}"))
