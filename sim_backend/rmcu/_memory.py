"""The emulated RMCU's memory as its symbols say: variables of every sample, and the name of the software."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from hil.core.can.symbols import Symbol
from hil.plant.closed_loop import tick as T

#: What the emulated RMCU has in its memory, by channel: the column of a bench row.
INTERNALS = {
    "dfc_torque_nm": T.FEEDFORWARD_TORQUE,  # T_m(DFC)*
    "wsc_torque_nm": T.FEEDBACK_TORQUE,  # T_m(WSC)*
    "wheel_speed_ref_rad_s": T.WHEEL_REFERENCE,  # ω_l*
    "slip_ref": T.SLIP_INTEGRAL,  # y
    "wsc_integral_nm": T.SPEED_INTEGRAL,
    "observed_torque_nm": T.OBSERVED_FORCE,  # rF̂_d as the observer has it, also where no frame shows it
    "followed_request_nm": T.FOLLOWED_REQUEST,  # what gradients and slip leave of rF_d*
    "twist_ref_rad": T.TWIST_REFERENCE,  # φ of the play crossing
    "observer_torque_state_nm": T.OBSERVER_TORQUE,
    "observer_speed_state_nm": T.OBSERVER_SPEED,
    "rmcu_motor_speed_rad_s": T.MOTOR_SPEED,
    "rmcu_torque_ref_nm": T.TORQUE_REF,
}


@dataclass(frozen=True)
class RamSettings:
    """What can be looked at in the emulated RMCU by XCP.

    Attributes:
        bus: of the simulated bench, on which it answers.
        bit_rate: of that bus, bit/s.
        variables: by channel, of `INTERNALS`.
        order: "<" or ">".
        software, software_address: a text in its memory.
    """

    bus: str
    bit_rate: int
    request_id: int
    answer_id: int
    variables: Mapping[str, Symbol] = field(default_factory=dict)
    order: str = "<"
    software: str = ""
    software_address: int | None = None


class RmcuMemory:
    """Bytes by address; one image for each row of the bench."""

    def __init__(self, settings: RamSettings) -> None:
        self._order = settings.order
        self._shown = [(symbol, INTERNALS[channel]) for channel, symbol in settings.variables.items()]
        self._places: dict[int, int] = {}
        size = 0
        for symbol, _ in self._shown:
            size = self._put(symbol.address, symbol.size, size)
        self._text = np.frombuffer(settings.software.encode("ascii", errors="replace"), np.uint8)
        if settings.software_address is not None:
            self._put(settings.software_address, len(self._text), size)

    def _put(self, address: int, size: int, place: int) -> int:
        for byte in range(size):
            self._places.setdefault(address + byte, place + byte)
        return place + size

    def has(self, address: int, size: int) -> bool:
        """Whether all of these bytes are there."""
        return all(address + byte in self._places for byte in range(size))

    def places(self, pieces: Iterable[tuple[int, int]]) -> npt.NDArray[np.int64]:
        """Where in an image the bytes of (address, size) lie, one behind the other."""
        return np.array([self._places[a + byte] for a, size in pieces for byte in range(size)], np.int64)

    def images(self, rows: npt.NDArray[np.float64]) -> npt.NDArray[np.uint8]:
        """All bytes at each row of the bench, shape (n, bytes)."""
        parts = [symbol.raw(rows[:, column], self._order) for symbol, column in self._shown]
        return np.hstack([*parts, np.broadcast_to(self._text, (len(rows), len(self._text)))])

    def stamps(self, ticks: npt.NDArray[np.int64], size: int) -> npt.NDArray[np.uint8]:
        """Time stamps as bytes, shape (n, size)."""
        return ticks.astype(f"{self._order}u{size}").view(np.uint8).reshape(-1, size)

    def read(self, row: npt.NDArray[np.float64], address: int, size: int) -> bytes:
        """Bytes of memory after a sample."""
        return bytes(self.images(row[None])[0, self.places([(address, size)])])
