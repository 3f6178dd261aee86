"""When the first transient after a step is over, and whether the request turned back meanwhile.

An order of the wheel can raise a response again long after the step: a window that ends with the first
transient judges the step, the whole window judges the order as well.
"""

from __future__ import annotations

import numpy as np

from hil.core.channels import TIME
from hil.core.recording import Recording
from hil.core.result import Segment
from hil.core.runtime.compiled import compiled
from test_plans.metrics._low_pass import low_passed
from test_plans.metrics._metric import NoValueError
from test_plans.metrics._orders import orders_removed
from test_plans.metrics._samples import step_size

#: A transient is over when the torque stays within so much of the step for so long.
BAND_PERCENT, HOLD_S = 5.0, 0.5
_MOVED = 0.5  # of the step: before that much of it was made there was no transient
_LOW_PASS_HZ = 50.0
_TURNED = 0.05  # of the step: so far a request may go back, which is noise and not a reversal
_LATEST_S = 0.005  # the next request may show in a segment's last samples
#: The torque that answers a step, and the channel that asked for it.
FOLLOWS = {"driving_torque": "shaft_torque_nm", "motor_torque": "motor_torque_nm", "": "shaft_torque_nm"}
_REQUESTS = {"driving_torque": "driving_torque_ref_nm", "motor_torque": "motor_torque_ref_nm"}


def transient_end_s(recording: Recording, segment: Segment) -> float:
    """When the first transient has been over for half a second, on the recording's time.

    The torque that was asked for, low-pass filtered at 50 Hz and without declared orders of the wheel, has
    kept within ±5 % of the step's size for that long. The window holds that time as well: what follows the
    orders takes a little of a transient with them, and the last swing must not be cut off.

    Raises:
        NoValueError: no step, no transient, one that does not end within the segment, or missing samples.
    """
    size = step_size(segment, None)
    channel = FOLLOWS[segment.quantity]
    spacing_s, values = orders_removed(recording, segment, channel, segment.step_s, segment.end_s)
    if 2 * _LOW_PASS_HZ * spacing_s < 1:
        values = low_passed(values, _LOW_PASS_HZ, spacing_s)
    moved = np.flatnonzero(np.abs(values - segment.reference_before) >= _MOVED * size)
    if not moved.size:
        raise NoValueError(
            f"the window has no transient: {channel} moves by less than {100 * _MOVED:.0f} % of the step"
        )
    first = int(moved[0])
    calm = _calm(values[first:], BAND_PERCENT / 50 * size, round(HOLD_S / spacing_s))
    if calm < 0:
        raise NoValueError(
            f"the first transient is not over within the segment: {channel} never keeps within "
            f"±{BAND_PERCENT:g} % of the step's size for {HOLD_S:g} s"
        )
    return float(segment.step_s + (first + calm) * spacing_s + HOLD_S)


def refuse_reversal(recording: Recording, segment: Segment) -> None:
    """Refuse a segment in which the request goes back on the way: one step has no single direction then.

    Raises:
        NoValueError: says when, and from and to which torque.
    """
    size = segment.reference_after - segment.reference_before
    request = _REQUESTS.get(segment.quantity, "")
    if size == 0 or request not in recording:
        return
    first = recording.rows_before(segment.step_s)
    rows = recording.rows(first, recording.rows_before(segment.end_s - _LATEST_S), (TIME, request))
    asked = rows[request][np.isfinite(rows[request])]
    time = rows[TIME][np.isfinite(rows[request])]
    progress = asked / size
    back = np.maximum.accumulate(progress) - progress if asked.size else progress
    turned = np.flatnonzero(back > _TURNED)
    if turned.size:
        place = int(turned[0])
        farthest = asked[int(np.argmax(progress[: place + 1]))]
        raise NoValueError(
            f"the request reverses within the window, {time[place] - segment.step_s:.3g} s after the step, "
            f"from {farthest:.4g} to {asked[place]:.4g} N m: give each direction a step of its own"
        )


@compiled
def _calm(values, width, length):  # type: ignore[no-untyped-def]
    """Where the first `length` samples begin whose range is at most `width`; -1 if nowhere."""
    begin = 0
    low = high = values[0]
    for i in range(values.shape[0]):
        x = values[i]
        if x - low > width or high - x > width:
            k = i
            while k > begin and abs(values[k - 1] - x) <= width:
                k -= 1
            begin = k
            low = high = x
            for j in range(k, i):
                low = min(low, values[j])
                high = max(high, values[j])
        else:
            low = min(low, x)
            high = max(high, x)
        if i - begin + 1 >= length:
            return begin
    return -1


def transient_in_words() -> str:
    """The end of such a window."""
    calm = f"has kept within ±{BAND_PERCENT:g} % of the step's size for {HOLD_S:g} s"
    return (
        f"the end of the first transient (the step's torque, low-pass filtered at {_LOW_PASS_HZ:g} Hz and "
        f"without declared orders, {calm})"
    )
