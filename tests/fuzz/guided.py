"""`python -m tests.fuzz.guided NAME SECONDS SEED DIR`: one parser, inputs chosen by what code they reach.

By atheris (libFuzzer for Python). What is compiled by numba is not instrumented: its bytecode has to stay.
"""

from __future__ import annotations

import hashlib
import logging
import random
import sys
import tempfile
from pathlib import Path

import atheris

from tests.fuzz.damaging import MOST_BYTES, damaged
from tests.fuzz.watched import ON_A_BENCH, PACKAGES, left_alone

HANGS_S, MOST_MB = 20, 3000


def main() -> None:
    """Runs until the time is over or something broke; libFuzzer ends the process."""
    name, seconds, seed, folder = sys.argv[1], int(sys.argv[2]), int(sys.argv[3]), Path(sys.argv[4])
    logging.disable(logging.CRITICAL)
    watched = ON_A_BENCH if name == "frames" else PACKAGES
    with atheris.instrument_imports(include=list(watched), exclude=left_alone()):
        from hil.core.errors import HilError
        from tests.fuzz.targets import TARGETS
    target = TARGETS[name]
    corpus = folder / "corpus"
    corpus.mkdir(parents=True, exist_ok=True)
    for number, whole in enumerate(target.seeds()):
        (corpus / f"whole-{number}").write_bytes(whole)
    place = Path(tempfile.mkdtemp(prefix="fuzz-"))
    path = place / f"{name}{target.suffix}"

    def try_one(data: bytes) -> None:
        path.write_bytes(data)
        try:
            target.parse(path)
        except HilError as error:
            try:
                assert error.what, "a message without words"
                assert len(str(error)) < 5000, "a message that no one reads"
            except AssertionError:
                keep(data)
                raise
        except Exception:
            keep(data)
            raise

    def keep(data: bytes) -> None:
        """Here and not by libFuzzer alone, which an alarm may end before it has."""
        (folder / f"broken-{hashlib.sha256(data).hexdigest()[:16]}").write_bytes(data)

    def another(data: bytes, most: int, chance: int) -> bytes:
        rng = random.Random(chance)
        if rng.random() < 0.3:
            return bytes(atheris.Mutate(data, most))
        return damaged(data, rng)[:most]

    words = [
        sys.argv[0],
        f"-max_total_time={seconds}",
        f"-seed={seed}",
        f"-timeout={HANGS_S}",
        f"-rss_limit_mb={MOST_MB}",
        f"-max_len={MOST_BYTES}",
        f"-artifact_prefix={folder}/",
        "-print_final_stats=1",
        str(corpus),
    ]
    atheris.Setup(words, try_one, custom_mutator=another)
    atheris.Fuzz()


if __name__ == "__main__":
    main()
