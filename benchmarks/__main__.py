"""`make bench`: every figure that the documentation states, printed side by side in one run."""

from __future__ import annotations

import importlib

_PARTS = ("commands", "plant", "virtual_time", "transports", "check", "reports", "identification")


def main() -> None:
    for name in _PARTS:
        print(f"\n== {name.replace('_', ' ')} ==")
        importlib.import_module(f"benchmarks.{name}").main()


if __name__ == "__main__":
    main()
