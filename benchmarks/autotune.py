"""`hil autotune` on a simulated bench, in virtual time, that hides backlash and dead time from the model.

    python -m benchmarks.autotune [FOLDER]

What the loop decides is reported as it goes; results go to FOLDER (out/autotune-hidden).
"""

from __future__ import annotations

import sys
import time
from pathlib import Path

from hil.cli._app import guarded
from hil.core.model import load_model, model_to_toml
from hil.engine.commissioning.sim_bench import with_hidden

BENCHES = Path(__file__).parents[1] / "benches"
HIDDEN = {"backlash": "0.01", "dead_time": "0.003"}


def bench_that_hides(folder: Path) -> Path:
    """The shipped simulated bench with effects in its axle that the shipped model has not; its file."""
    folder.mkdir(parents=True, exist_ok=True)
    model = with_hidden(load_model(BENCHES / "three_inertia.toml"), HIDDEN)
    (folder / "hidden_axle.toml").write_text(model_to_toml(model), encoding="utf-8")
    text = (BENCHES / "sim.toml").read_text("utf-8").replace("three_inertia.toml", "hidden_axle.toml")
    for name in ("rmcu.dbc", "rcs_dyno.eds"):
        text = text.replace(name, str(BENCHES / name))
    (folder / "hidden_bench.toml").write_text(text, encoding="utf-8")
    return folder / "hidden_bench.toml"


def main() -> int:
    folder = Path(sys.argv[1] if len(sys.argv) > 1 else "out/autotune-hidden")
    bench = bench_that_hides(folder)
    began_s = time.perf_counter()
    options = ["--bench", str(bench), "--out", str(folder), "--overwrite"]
    code = guarded(["autotune", "--model", str(BENCHES / "three_inertia.toml"), *options])
    print(f"{time.perf_counter() - began_s:.0f} s, exit code {code}")
    return code


if __name__ == "__main__":
    sys.exit(main())
