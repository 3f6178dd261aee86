"""Which software made something: this one, the interpreter and the libraries that matter."""

from __future__ import annotations

import contextlib
import importlib.metadata
import platform
import subprocess
from pathlib import Path

_LIBRARIES = ("numpy", "scipy", "numba", "python-can", "canopen", "cantools", "mcap")


def versions() -> dict[str, str]:
    """This software, the interpreter, the libraries that matter, and the git revision if there is one."""
    found = {"eaxle-hil": importlib.metadata.version("eaxle-hil"), "python": platform.python_version()}
    for name in _LIBRARIES:
        with contextlib.suppress(importlib.metadata.PackageNotFoundError):  # an extra brings it
            found[name] = importlib.metadata.version(name)
    found["git_revision"] = _git_revision()
    return found


def _git_revision() -> str:
    root = Path(__file__).resolve().parents[3]
    if not (root / ".git").exists():
        return ""
    try:
        answer = subprocess.run(
            ["git", "describe", "--always", "--dirty", "--abbrev=12"],
            cwd=root,
            capture_output=True,
            text=True,
            timeout=5,
            check=True,
        )
    except (OSError, subprocess.SubprocessError):
        return ""
    return answer.stdout.strip()
