"""What becomes of rF_d* before the control follows it: gradients, and what the road does not bear."""

from __future__ import annotations

from collections.abc import Mapping

from hil.core.runtime.compiled import compiled
from hil.plant.controller import memory as M


class RequestGovernor:
    """Gradient limits, and withdrawal of a request at whose slip limit the wheels run; each off at 0."""

    def __init__(self, parameters: Mapping[str, float]) -> None:
        p = parameters
        self._gains = {
            M.REQUEST_RISE: p["request_rise"],
            M.REQUEST_FALL: p["request_fall"],
            M.ZERO_BAND: p["zero_band"],
            M.ZERO_GRADIENT: p["zero_gradient"],
            M.SLIP_ALLOWED: p["slip_allowed"],
            M.SLIP_RECOVERY: p["slip_recovery"],
        }
        if min(self._gains.values()) < 0.0:
            raise ValueError("a gradient or a slip is negative")

    def load(self, memory: M.Memory) -> None:
        """Put the numbers into the firmware's memory."""
        for index, value in self._gains.items():
            memory.gains[index] = value


@compiled
def govern(k, s, request, v_hat, w_m):  # type: ignore[no-untyped-def]
    """The request that the control follows, N m."""
    if k[M.REQUEST_RISE] > 0.0 or k[M.REQUEST_FALL] > 0.0 or k[M.ZERO_GRADIENT] > 0.0:
        request = _limit_gradient(k, s, request)
    s[M.REQUEST] = request
    if k[M.SLIP_ALLOWED] > 0.0:
        request = _withdraw(k, s, request, v_hat, w_m)
    return request


@compiled
def _limit_gradient(k, s, request):  # type: ignore[no-untyped-def]
    """Move towards the request: REQUEST_RISE upwards, REQUEST_FALL downwards, ZERO_GRADIENT around zero.

    A step that would pass the border of the band around zero ends there.
    """
    before = s[M.REQUEST]
    upwards = request > before
    limit = k[M.REQUEST_RISE] if upwards else k[M.REQUEST_FALL]
    band = k[M.ZERO_BAND]
    if k[M.ZERO_GRADIENT] > 0.0:
        inside = -band <= before < band if upwards else -band < before <= band
        if inside:
            limit = k[M.ZERO_GRADIENT] if limit == 0.0 else min(limit, k[M.ZERO_GRADIENT])
        elif upwards and before < -band:
            request = min(request, -band)
        elif not upwards and before > band:
            request = max(request, band)
    if limit == 0.0:
        return request
    reach = limit * k[M.SAMPLE_TIME]
    return before + min(max(request - before, -reach), reach)


@compiled
def _withdraw(k, s, request, v_hat, w_m):  # type: ignore[no-untyped-def]
    """Ask no more than the observer sees on the road while the wheels run beyond the slip of (1)(2).

    Afterwards as much more as SLIP_RECOVERY allows, until it is all that is asked for.
    """
    way = 1.0 if request >= 0.0 else -1.0
    base = v_hat if v_hat >= k[M.SIGMA] else k[M.SIGMA]
    ahead = way * (w_m / k[M.GEAR_RATIO] * k[M.RADIUS] - v_hat)
    size = abs(request)
    if ahead > k[M.SLIP_ALLOWED] * base:
        s[M.ROAD_LIMIT] = min(s[M.ROAD_LIMIT], max(0.0, way * s[M.ESTIMATE]))
    else:
        s[M.ROAD_LIMIT] += k[M.SLIP_RECOVERY] * k[M.SAMPLE_TIME]
    if s[M.ROAD_LIMIT] > size:
        s[M.ROAD_LIMIT] = M.NO_LIMIT
        return request
    return way * s[M.ROAD_LIMIT]
