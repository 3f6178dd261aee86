"""A bench in memory: plant, drives and the RMCU's control, stepped many milliseconds a call."""

from __future__ import annotations

import copy
from collections.abc import Collection, Mapping

import numpy as np
import numpy.typing as npt

from hil.core.channels import TICK_S
from hil.core.errors import BadInputError, BenchError
from hil.core.model import Model
from hil.plant import LONGEST_STEP_S
from hil.plant.closed_loop import drive as D
from hil.plant.closed_loop import tick as T
from hil.plant.closed_loop._noise import Noise
from hil.plant.closed_loop._state import state_at_rest
from hil.plant.closed_loop.advance import advance
from hil.plant.closed_loop.shown import Wire, rounded
from hil.plant.controller import LARGEST_TORQUE_NM, build, in_range
from hil.plant.controller import memory as M
from hil.plant.controller.parameters import INCOMPLETE, OUT_OF_RANGE

Array = npt.NDArray[np.float64]
SIDES = (0, 1)  # left, right
_FIRST_ROWS, _MOST_SPARE_ROWS = 1 << 14, 1 << 18
_REASONS = {OUT_OF_RANGE: "out_of_range", INCOMPLETE: "incomplete"}


class ClosedLoop:
    """The simulated bench without its wire: the same compiled tick, and numbers rounded as frames round.

    Time passes in `run` only; what drives and RMCU are asked for counts from the next sample on. Sensors have
    no noise but what is given. Parameters in `held` are what the RMCU uses in place of those that it is
    given. `longest_step_s` is the integrator's.

    Raises:
        BadInputError: a model that has no shaft to load or is too stiff for the integrator, an effect that
            stands twice, or a sensor that would read what has not happened.
    """

    def __init__(
        self,
        model: Model,
        wheel_radius_m: float,
        wire: Wire,
        held: Mapping[str, float] | None = None,
        noise: Noise | None = None,
        longest_step_s: float = LONGEST_STEP_S,
    ) -> None:
        if model.kind == "transfer_function":
            raise BadInputError(
                "a 'transfer_function' model cannot be a simulated bench: it has no shaft to load",
                fix="give a rigid, two_inertia or three_inertia model",
            )
        self.wire = wire
        self._held = dict(held or {})
        #: What the drives' vehicle model is reported stands here too.
        self.plant = state_at_rest(model, wheel_radius_m, longest_step_s)
        self._noise = noise
        self._memory = m = M.Memory()
        m.gains[M.SAMPLE_TIME] = TICK_S
        m.gains[M.TORQUE_LIMIT] = LARGEST_TORQUE_NM  # until a controller sets its own
        self._firmware = (m.numerators, m.denominators, m.filter_states, m.gains, m.states)
        self._rows = np.zeros((_FIRST_ROWS, T.COLUMNS))
        self._status = np.zeros(2)
        self.mode = M.OFF
        self.samples = 0
        #: Number of the sample that the first of `rows` is of.
        self.first = 0

    @property
    def rows(self) -> Array:
        """What was measured and commanded, one row a sample from `first` on, columns of `tick`."""
        return self._rows[: self.samples - self.first]

    def forget(self, before: int) -> None:
        """Drop the rows of samples before this one; room that a long request took is given back."""
        kept = self.rows[max(0, before - self.first) :]
        self.first = self.samples - len(kept)
        if len(self._rows) > _MOST_SPARE_ROWS:
            self._rows = np.zeros((max(_FIRST_ROWS, len(kept)), T.COLUMNS))
        self._rows[: len(kept)] = kept

    def free_rows(self) -> None:
        """Free the memory of all rows."""
        self.first, self._rows = self.samples, np.zeros((0, T.COLUMNS))

    def continued(self, room: Array) -> ClosedLoop:
        """A bench of its own that goes on from here.

        Its rows stand in `room` (samples x COLUMNS) where that is long enough.
        """
        if len(room) < len(self.rows):
            room = np.zeros_like(self._rows)
        room[: len(self.rows)] = self.rows
        return copy.deepcopy(self, {id(self._rows): room, id(self.wire): self.wire})

    def set_controller(self, parameters: Mapping[str, float]) -> None:
        """Give the RMCU its parameters (names of the DBC, SI units), rounded as the wire rounds them.

        Raises:
            BenchError: the RMCU would refuse a value, or all of them together.
        """
        values = rounded(self.wire.parameter, list(parameters.values()))
        stored = dict(zip(parameters, map(float, values), strict=True))
        for name, value in stored.items():
            if not in_range(name, value):
                raise BenchError(
                    f"refused parameter '{name}' = {value:g}: {_REASONS[OUT_OF_RANGE]}", where="RMCU"
                )
        result = build(stored | self._held, self._memory)
        if result:
            raise BenchError(f"refused the controller's parameters: {_REASONS[result]}", where="RMCU")

    def set_ramp(self, acceleration_rad_s2: float) -> None:
        """How fast the drives change speed, rad/s²."""
        self.plant.drives[:, D.ACCELERATION] = acceleration_rad_s2

    def target_speed(self, side: int, speed_rad_s: float) -> None:
        """Tell one drive the speed to hold in mode speed, rad/s."""
        self.plant.drives[side, D.TARGET_SPEED] = rounded(self.wire.target_speed, speed_rad_s)[0]

    def drive_mode(self, side: int, mode: int) -> None:
        """Let one drive be FREE, hold a SPEED or be a VEHICLE (names of `drive`)."""
        self.plant.drives[side, D.MODE] = mode

    def off(self) -> None:
        """Torque off."""
        self.mode = M.OFF

    def play(self, mode: int, samples_nm: Array) -> None:
        """Request `samples_nm`, one each sample: motor torque in mode TORQUE, rF_d* in DRIVING_FORCE.

        The mode stays; only `off` leaves it.
        """
        self.mode = mode
        self._advance(rounded(self.wire.request, samples_nm))

    def run(self, samples: int) -> None:
        """Let `samples` milliseconds pass without torque being asked for."""
        self._advance(np.zeros(samples))

    def next_row(self, mode: int, request_nm: float) -> Array:
        """The sample that comes next if this is asked for, shape (columns,); nothing moves."""
        s = self.plant
        row = np.zeros((1, T.COLUMNS))
        modes = np.array([mode], np.int64)
        advance(
            self.samples,
            s.x.copy(),
            s.form,
            s.vector,
            s.scalars.copy(),
            s.torques.copy(),
            tuple(part.copy() for part in self._firmware),
            s.drives.copy(),
            s.sensors,
            s.past.copy(),
            np.tile(s.noise, (1, 1)),
            modes,
            np.array([request_nm]),
            modes,
            self._status,
            row,
        )
        return row.reshape(-1)

    def recorded(self, first: int, last: int, names: Collection[str] | None = None) -> dict[str, Array]:
        """The channels of a recording from sample `first` to before `last`, by name, with `time_s`.

        Args:
            names: those that are wanted; all without it.
        """
        return self.wire.recorded(self.rows[first - self.first : last - self.first], TICK_S, names)

    def _advance(self, requests: Array) -> None:
        begin = self.samples - self.first
        end = begin + len(requests)
        if end > len(self._rows):
            longer = np.zeros((max(end + _FIRST_ROWS, 5 * len(self._rows) // 4), T.COLUMNS))
            longer[:begin] = self.rows
            self._rows = longer
        s = self.plant
        # no fault, and whether parameters are valid is not shown: the code is the mode alone
        modes = np.full(len(requests), self.mode, np.int64)
        advance(
            self.samples,
            s.x,
            s.form,
            s.vector,
            s.scalars,
            s.torques,
            self._firmware,
            s.drives,
            s.sensors,
            s.past,
            self._with_noise(len(requests)),
            modes,
            requests,
            modes,
            self._status,
            self._rows[begin:end],
        )
        self.samples += len(requests)
        s.refuse_diverged(self.samples * TICK_S)

    def _with_noise(self, samples: int) -> Array:
        """What sensors add to each sample, and the tick's scratch room behind it."""
        if self._noise is None:
            return self.plant.noise[None]
        room = np.zeros((samples, len(self.plant.noise)))
        room[:, : T.SENSORS] = self._noise.drawn(samples)
        return room
