"""benchmarks/plant.c, compiled for this machine with the places of the kernels' own table of parameters."""

from __future__ import annotations

import ctypes
import re
import subprocess
from collections.abc import Callable
from pathlib import Path

import numpy as np
import numpy.typing as npt

from benchmarks.answers import OtherAnswerError
from hil.plant import slots

Array = npt.NDArray[np.float64]
SOURCE = Path(__file__).with_name("plant.c")


def header() -> str:
    """slots.h: where each number stands in the vector, under its name in the table."""
    places = enumerate(slots.SLOTS.names)
    return "".join(f"#define AT_{name.replace('.', '_')} {place}\n" for place, name in places)


def refuse_more(vector: Array) -> None:
    """Refuse a vector of another kind than three inertias, or with anything on that the C side does not have.

    Raises:
        OtherAnswerError: it would compute something else.
    """
    read = set(re.findall(r"\bAT_(\w+)", SOURCE.read_text("utf-8")))
    neutral = slots.pack_nothing()
    neutral[slots.KIND] = slots.THREE_INERTIA
    more = [
        name
        for place, name in enumerate(slots.SLOTS.names)
        if name.replace(".", "_") not in read and vector[place] != neutral[place]
    ]
    if more:
        raise OtherAnswerError(f"plant.c has no {', '.join(more)}")


def compiled_c(directory: Path, dt: float, step: float) -> Callable[[Array, Array, Array], None]:
    """`run(torque, vector, out)` by C at -O3; samples of `dt` and steps of `step` seconds."""
    (directory / "slots.h").write_text(header())
    library = directory / "plant.so"
    command = [
        "cc",
        "-O3",
        "-march=native",
        "-shared",
        "-fPIC",
        f"-I{directory}",
        SOURCE,
        "-o",
        library,
        "-lm",
    ]
    subprocess.run(list(map(str, command)), check=True)
    function = ctypes.CDLL(str(library)).run

    def run(torque: Array, vector: Array, out: Array) -> None:
        function(
            torque.ctypes.data_as(ctypes.c_void_p),
            ctypes.c_long(len(torque)),
            ctypes.c_double(dt),
            vector.ctypes.data_as(ctypes.c_void_p),
            ctypes.c_double(step),
            out.ctypes.data_as(ctypes.c_void_p),
        )

    return run
