"""What a recording says about where it comes from."""

from __future__ import annotations

import importlib.metadata
import platform
import subprocess
from pathlib import Path

import pytest

from hil.core.runtime.versions import versions
from hil.engine.run.run_files import hashes


def test_attachments_have_the_digests_that_the_standard_gives() -> None:
    # FIPS 180-2, appendix B.1, and the empty message
    found = hashes({"b.txt": b"abc", "a.txt": b""})
    assert found == {
        "a.txt": "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855",
        "b.txt": "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad",
    }
    assert list(found) == ["a.txt", "b.txt"]


def test_versions_are_those_that_are_installed() -> None:
    found = versions()
    assert found["python"] == platform.python_version()
    for name in ("eaxle-hil", "numpy", "scipy", "numba", "python-can", "canopen", "cantools", "mcap"):
        assert found[name] == importlib.metadata.version(name)


def test_the_revision_is_gits() -> None:
    root = Path(__file__).parents[4]
    if not (root / ".git").exists():
        pytest.skip("not a clone")
    asked = subprocess.run(
        ["git", "rev-parse", "HEAD"], cwd=root, capture_output=True, text=True, check=True
    ).stdout.strip()
    revision = versions()["git_revision"].removesuffix("-dirty")
    assert len(revision) >= 12
    assert asked.startswith(revision.rpartition("-g")[2])  # a tag may stand before it
