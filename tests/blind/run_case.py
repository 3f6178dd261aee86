"""One case of the blind set, from its draw to its score."""

from __future__ import annotations

import shutil
import tempfile
from pathlib import Path

from tests.blind.casefiles import OpenFiles, drawn_case, open_answer, seal_answer, write_case
from tests.blind.diagnosing import Diagnose
from tests.blind.draws import draw
from tests.blind.scoring import Score, score
from tests.blind.specs import Spec


def run_case(
    seed: int, spec: Spec, diagnose: Diagnose, keep: Path | None = None, length: float = 1.0
) -> Score:
    """Draw, measure, ask, open the answer, judge. With `keep`, what was drawn stays and is used again."""
    with tempfile.TemporaryDirectory(prefix="blind-") as place:
        drawn = Path(place) / "drawn"
        if keep is not None:
            name = spec.key.replace("/", "-").replace(":", "-")
            drawn = keep / f"seed-{seed}-length-{length:g}" / name
        files = drawn_case(drawn) or _draw(seed, spec, length, drawn)
        reply = diagnose(files, Path(place) / "out")
        kind, answer = open_answer(drawn)
        return score(spec, kind, answer, reply)


def _draw(seed: int, spec: Spec, length: float, directory: Path) -> OpenFiles:
    shutil.rmtree(directory, ignore_errors=True)
    directory.mkdir(parents=True)
    case = draw(seed, spec, length)
    files, answer = write_case(case, directory)
    seal_answer(directory, case.truth.kind, answer)
    return files
