"""A disk image with Python's library and the packages of this environment, for the emulated machine.

There, files of the machine outside are read over 9p, which takes minutes for the thousands that Python opens.
"""

from __future__ import annotations

import hashlib
import shutil
import subprocess
import sys
import sysconfig
import tempfile
from pathlib import Path

_NOT_NEEDED = shutil.ignore_patterns(
    "test", "tests", "idlelib", "turtledemo", "ensurepip", "lib2to3", "config-3*", "*.a", "typst", "mypy",
    "mypyc", "*__mypyc*", "pip", "uv", "ruff", "plotly", "sklearn", "aiohttp",
)  # fmt: skip
_ROOM = 1.15


def places() -> list[Path]:
    """Folders that the image holds, in their order."""
    library = Path(sysconfig.get_path("stdlib")).resolve()
    packages = Path(sysconfig.get_path("purelib")).resolve()
    return [library, packages]


def made(root: Path, cache: Path) -> Path:
    """The image, made anew if packages have changed; `root`: of the project."""
    digest = hashlib.sha256((root / "requirements" / "all.txt").read_bytes() + sys.version.encode())
    digest.update(Path(__file__).read_bytes() + str(places()).encode())
    image = cache / f"python-{digest.hexdigest()[:16]}.img"
    if image.exists():
        return image
    for old in cache.glob("python-*.img"):
        old.unlink()
    with tempfile.TemporaryDirectory(dir=cache) as folder:
        for number, place in enumerate(places()):
            skipped = _without_packages if number == 0 else _NOT_NEEDED
            shutil.copytree(place, Path(folder, str(number)), symlinks=True, ignore=skipped)
        files = [path for path in Path(folder).rglob("*") if path.is_file() and not path.is_symlink()]
        size = sum(-(-path.stat().st_size // 4096) * 4096 for path in files)
        part = image.with_suffix(".part")
        part.unlink(missing_ok=True)
        kib = int(_ROOM * (size + 4096 * len(files)) / 1024) + 32_768
        command = [
            "mke2fs",
            "-q",
            "-t",
            "ext4",
            "-O",
            "^has_journal",
            "-m",
            "0",
            "-N",
            str(2 * len(files) + 5000),
        ]
        subprocess.run([*command, "-d", folder, str(part), f"{kib}k"], check=True)
        part.rename(image)
    return image


def _without_packages(folder: str, names: list[str]) -> set[str]:
    return _NOT_NEEDED(folder, names) | ({"site-packages", "dist-packages"} & set(names))


if __name__ == "__main__":
    print(made(Path(sys.argv[1]), Path(sys.argv[2])))
