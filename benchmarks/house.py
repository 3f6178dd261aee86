"""What the house looks like at commits: `python -m benchmarks.house BEFORE AFTER`.

Files and lines of the product, the spread of files, private modules that another package imports, and words
that left (docs/reference/glossary.md). Read from git, so that any commit can be asked.
"""

from __future__ import annotations

import re
import statistics
import subprocess
import sys
from collections.abc import Mapping

PACKAGES = ("hil", "drivers", "test_plans", "reports", "sim_backend")
_WORDS = re.compile(
    r"(?i)\b(told|said|shel(?:f|ves)|desk|arrivals|cared|foretold|begun|carried|carry_out|nobody|kin)\b"
)
_PRIVATE = re.compile(r"^\s*from ([\w.]+) import", re.MULTILINE)
_SMALL, _LARGE = 40, 400  # lines


def product_at(commit: str) -> dict[str, str]:
    """Texts of the product's modules by path."""
    listed = _git("ls-tree", "-r", "--name-only", commit, *PACKAGES)
    return {path: _git("show", f"{commit}:{path}") for path in listed.split("\n") if path.endswith(".py")}


def private_imports(files: Mapping[str, str]) -> int:
    """How often a module imports from a private module (`_name`) of another package."""
    count = 0
    for path, text in files.items():
        own = path.rpartition("/")[0].replace("/", ".")
        for module in _PRIVATE.findall(text):
            parts = module.split(".")
            private = next(
                (i for i, part in enumerate(parts) if part.startswith("_") and part != "__future__"), None
            )
            count += private is not None and parts[0] in PACKAGES and ".".join(parts[:private]) != own
    return count


def figures_of(files: Mapping[str, str]) -> dict[str, int]:
    """Each figure by its name."""
    lines = [text.count("\n") for path, text in files.items() if not path.endswith("__init__.py")]
    apart = {path: text for path, text in files.items() if "/diagnosis/" not in path}
    return {
        "files": len(files),
        "lines": sum(text.count("\n") for text in files.values()),
        "lines of a file, median": round(statistics.median(lines)),
        "lines of the largest file": max(lines),
        f"files under {_SMALL} lines": sum(count < _SMALL for count in lines),
        f"files over {_LARGE} lines": sum(count > _LARGE for count in lines),
        "imports of a private module of another package": private_imports(files),
        "words that left": sum(len(_WORDS.findall(text)) for text in files.values()),
        "words that left, diagnosis apart": sum(len(_WORDS.findall(text)) for text in apart.values()),
    }


def main() -> None:
    """Print a table, a column a commit."""
    commits = sys.argv[1:] or ["HEAD"]
    columns = [figures_of(product_at(commit)) for commit in commits]
    print("| | " + " | ".join(commits) + " |\n|---|" + "---|" * len(commits))
    for name in columns[0]:
        print(f"| {name} | " + " | ".join(f"{column[name]:,}" for column in columns) + " |")


def _git(*arguments: str) -> str:
    return subprocess.run(["git", *arguments], capture_output=True, text=True, check=True).stdout


if __name__ == "__main__":
    main()
