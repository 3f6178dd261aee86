"""`make release`: wheel and sdist into dist/, tried in an empty environment, with a list of what is inside.

The wheel is installed with the versions of requirements/all.txt into an environment of its own, without
extras, and has to run the acceptance plan in an empty folder. The sdist has to make the same wheel. The list
of components (CycloneDX) is of that environment.
"""

from __future__ import annotations

import hashlib
import re
import subprocess
import sys
import tempfile
import tomllib
import zipfile
from pathlib import Path

ROOT = Path(__file__).parents[1]
DIST = ROOT / "dist"
UV = Path(sys.executable).parent / "uv"
_PAGE = "hil/service/frontend/built/index.html"


def main() -> int:
    """Build, try, list; the exit code."""
    version = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]["version"]
    if not re.search(rf"^## {re.escape(version)} ", (ROOT / "CHANGELOG.md").read_text("utf-8"), re.MULTILINE):
        print(f"CHANGELOG.md has no heading '## {version} - DATE': write it first", file=sys.stderr)
        return 2
    for old in DIST.glob("*"):
        old.unlink()
    _run(UV, "build", "--quiet", "--out-dir", DIST, ROOT)
    (wheel,), (sdist,) = DIST.glob("*.whl"), DIST.glob("*.tar.gz")
    if _PAGE not in _contents(wheel):
        raise SystemExit(f"{wheel.name} has no page: make page")
    with tempfile.TemporaryDirectory() as folder:
        place = Path(folder)
        _same_from_sdist(wheel, sdist, place / "from-sdist")
        python = _installed(wheel, place / "environment")
        count, size_mb = _size(place / "environment")
        (place / "empty").mkdir()
        _run(python.parent / "hil", "run", "acceptance", "--out", "out", cwd=place / "empty")
        _run(
            Path(sys.executable).parent / "cyclonedx-py",
            "environment",
            "--output-reproducible",
            "--output-file",
            DIST / f"eaxle-hil-{version}.cdx.json",
            python,
        )
    for made in sorted(DIST.iterdir()):
        if made.name != ".gitignore":
            print(f"{hashlib.sha256(made.read_bytes()).hexdigest()}  dist/{made.name}")
    print(f"base install: {count} packages, {size_mb:.0f} MB")
    return 0


def _same_from_sdist(wheel: Path, sdist: Path, place: Path) -> None:
    _run(UV, "build", "--quiet", "--wheel", "--out-dir", place, sdist)
    (again,) = place.glob("*.whl")
    if _contents(wheel) != _contents(again):
        raise SystemExit(f"{sdist.name} makes another wheel than {wheel.name}")


def _contents(wheel: Path) -> dict[str, int]:
    with zipfile.ZipFile(wheel) as archive:
        return {one.filename: one.CRC for one in archive.infolist()}


def _installed(wheel: Path, place: Path) -> Path:
    """The interpreter of an environment that has the wheel, and nothing but what it needs."""
    _run(UV, "venv", "--quiet", "--python", sys.executable, place)
    python = place / "bin" / "python"
    pinned = ROOT / "requirements/all.txt"
    _run(UV, "pip", "install", "--quiet", "--compile-bytecode", "--python", python, "-c", pinned, wheel)
    return python


def _size(environment: Path) -> tuple[int, float]:
    """Packages, and MB of their files."""
    sites = next(environment.glob("lib/python*/site-packages"))
    size = sum(file.stat().st_size for file in sites.rglob("*") if file.is_file())
    return len(list(sites.glob("*.dist-info"))), size / 1e6


def _run(*command: object, cwd: Path = ROOT) -> None:
    print("+", *command, flush=True)
    if subprocess.run([str(part) for part in command], cwd=cwd, check=False).returncode:
        raise SystemExit(f"failed: {command[0]}")


if __name__ == "__main__":
    sys.exit(main())
