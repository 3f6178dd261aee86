"""Which bench is meant where none is named."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

from hil.core.errors import BadInputError
from hil.engine.bench.bench_file import folders_of, found_bench, refuse_hardware
from tests.hil.core.model.test_schemas import BENCHES


def test_the_bench_beside_the_plan_goes_before_the_one_in_the_current_folder(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "plans").mkdir()
    plan = tmp_path / "plans" / "p.yaml"
    plan.write_text("name: p")
    monkeypatch.chdir(tmp_path)
    assert found_bench(folders_of(plan)) is None
    (tmp_path / "bench.toml").touch()
    assert found_bench(folders_of(plan)) == Path("bench.toml")
    (tmp_path / "plans" / "bench.toml").touch()
    assert found_bench(folders_of(plan)) == tmp_path / "plans" / "bench.toml"
    assert found_bench(folders_of("acceptance")) == Path("bench.toml")  # a shipped plan has no folder


def test_hardware_is_driven_only_where_it_is_named(tmp_path: Path) -> None:
    for name in ("rmcu.dbc", "rcs_dyno.eds", "three_inertia.toml"):
        shutil.copy(BENCHES / name, tmp_path)
    own = tmp_path / "bench.toml"
    shutil.copy(BENCHES / "sim.toml", own)
    refuse_hardware(own)
    shutil.copy(BENCHES / "rear_axle_socketcan.toml", own)
    with pytest.raises(BadInputError, match="describes hardware, which is driven only if it is named"):
        refuse_hardware(own)
