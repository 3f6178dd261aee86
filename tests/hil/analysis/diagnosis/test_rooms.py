"""Every module of the diagnosis has a test that imports it."""

import re
from pathlib import Path

_ROOT = Path(__file__).parents[4]
_MODULES = [
    p for p in sorted((_ROOT / "hil/analysis/diagnosis").rglob("*.py")) if p.name not in ("__init__.py",)
]


def test_every_module_is_imported_by_a_test() -> None:
    tests = "".join(p.read_text(encoding="utf-8") for p in Path(__file__).parent.rglob("test_*.py"))
    known = set(re.findall(r"from hil\.analysis\.diagnosis\.([\w.]+) import", tests))
    names = {
        ".".join(p.relative_to(_ROOT / "hil/analysis/diagnosis").with_suffix("").parts) for p in _MODULES
    }
    assert sorted(names - known - {"_diagnose"}) == []
