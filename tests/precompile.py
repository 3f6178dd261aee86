"""`python -m tests.precompile`: compiles the plant before the tests, its two halves side by side.

Otherwise each of the processes that run tests compiles all of it, since both need it at about the same time.
"""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import numpy as np

from hil.core.model import load_model
from hil.plant import ideal_sensors, pack, simulate, simulate_many

_BENCHES = Path(__file__).parents[1] / "benches"
_DT = 1e-3


def main() -> int:
    """The closed loop in a process of its own, the kernel of fits here, then what both share."""
    check = "import sys; from hil.cli import main; sys.argv[1:] = ['check', 'acceptance', '--json']; main()"
    loop = subprocess.Popen([sys.executable, "-c", check], stdout=subprocess.DEVNULL)
    model, torque = load_model(_BENCHES / "three_inertia.toml"), np.zeros(20)
    start, sensors, slots = np.zeros((1, 3)), ideal_sensors(1), pack(model)[None]
    simulate_many(slots, torque, _DT, start, sensors)
    simulate_many(slots, torque, _DT, start, sensors, load_nm=torque)
    code = loop.wait()
    simulate(model, torque, _DT)
    return code


if __name__ == "__main__":
    sys.exit(main())
