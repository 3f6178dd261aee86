"""Rates, lost samples and drift, from what devices send by themselves."""

import numpy as np
import pytest

from drivers import Counting, Samples, Stream
from hil.engine.commissioning.doctor._buses import Listener

STATUS = Stream("status", "bus 'rmcu'", ("speed_rad_s",), ("rad/s",), 0.001, counting=Counting("8 bits", 256))


class Source:
    """Hands out samples whose clock goes wrong by `drift`, without those that are lost."""

    def __init__(self, drift=0.0, lost=()):
        numbers = np.array([k for k in range(1000) if k not in lost])
        times = 3.0 + numbers * 0.001 * (1 + drift)
        self.streams = (STATUS,)
        self._pieces = [
            Samples(STATUS, times[i : i + 10], np.zeros((len(times[i : i + 10]), 1)), numbers[i : i + 10])
            for i in range(0, len(numbers), 10)
        ]

    def samples(self):
        pieces, self._pieces = self._pieces, []
        return pieces


def heard(**changes):
    listener = Listener([Source(**changes)])
    listener.take()
    return listener


def test_a_clock_that_goes_well():
    listener = heard()
    (clock,), findings = listener.clocks()
    assert (clock.lost, findings) == (0, [])
    assert clock.drift_ppm == pytest.approx(0.0, abs=1.0)
    assert list(listener.findings_of_rates(1.0)) == []


def test_drift_is_told():
    (clock,), _ = heard(drift=200e-6).clocks()
    assert clock.drift_ppm == pytest.approx(200.0, abs=5.0)


def test_lost_samples_are_a_fault():
    (clock,), (finding,) = heard(lost={400, 401}).clocks()
    assert clock.lost == 2
    assert (finding.severity, finding.what) == ("fault", "2 samples of status are lost")


def test_another_rate_is_a_fault():
    (finding,) = heard().findings_of_rates(2.0)
    assert finding.what == "status comes 500 times a second, 1000 are expected"


@pytest.mark.parametrize(
    ("duration_s", "reported"), [(0.96, False), (1.04, False), (0.94, True), (1.06, True)]
)
def test_a_rate_may_be_a_twentieth_off(duration_s, reported):
    assert bool(list(heard().findings_of_rates(duration_s))) is reported


def test_what_came_before_is_forgotten():
    listener = Listener([Source()])
    listener.forget()
    listener.take()
    assert listener.clocks() == ([], [])
