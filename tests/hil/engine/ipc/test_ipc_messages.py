"""What passes between the processes of a run comes out as it went in, whatever the texts in it are."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from hil.core.errors import BadInputError, BenchError, EmergencyStopError, HilError, InterruptError
from hil.core.result import RunResult
from hil.engine.ipc.ipc_messages import (
    Concluded,
    Ended,
    ErrorData,
    Here,
    Logged,
    OperatorText,
    Progressed,
    Refused,
    RunAsked,
    StopAsked,
    Turned,
    Typed,
    from_line,
    to_line,
)

#: Also what file names hold that are no Unicode (surrogates).
TEXT = st.text(st.characters(), max_size=40) | st.just("out-\udc80-\n\0")
TEXTS = st.lists(TEXT, max_size=3).map(tuple)
NUMBER = st.floats(allow_nan=False)
ERRORS = st.builds(
    ErrorData, kind=st.sampled_from(["BadInputError", "BenchError"]), what=TEXT, where=TEXT, fix=TEXT
)
RESULT = RunResult(
    verdict="error", plan="p", bench="b", real_time_factor=1, bench_time_s=2, safe_state="confirmed"
)
MESSAGES = st.one_of(
    st.builds(RunAsked, plan=TEXT, plan_source=TEXT, bench=TEXT, bench_source=TEXT, out=TEXT,
              model=st.none() | TEXT, operator=TEXT, operator_is_there=st.booleans(), confirmed_by=TEXT,
              hazard_confirmed_by=TEXT,
              accept_expired=TEXT, replaces=TEXTS),
    st.sampled_from([Here(), Turned()]),
    st.builds(StopAsked, times=st.integers(0, 9)),
    st.builds(Typed, line=TEXT),
    st.builds(Progressed, share=NUMBER, text=TEXT),
    st.builds(OperatorText, text=TEXT),
    st.builds(Logged, logger=TEXT, level=st.integers(0, 50), text=TEXT, traceback=TEXT),
    st.builds(Concluded, armed=st.booleans(), unsafe=TEXTS),
    st.builds(Refused, error=ERRORS),
    st.builds(Ended, result=st.builds(lambda reason: RESULT.model_copy(update={"reason": reason}), TEXT),
              recording=TEXT, error=st.none() | ERRORS,
              largest=st.dictionaries(TEXT, NUMBER, max_size=3), made=TEXTS),
)  # fmt: skip


@given(MESSAGES)
def test_a_message_comes_out_as_it_went_in(message):
    line = to_line(message)
    assert line.count(b"\n") == 1
    assert from_line(line) == message


def test_what_is_not_known_passes_too():
    passed = from_line(to_line(Ended(result=RESULT, recording="r", largest={"x": math.nan, "y": math.inf})))
    assert isinstance(passed, Ended)
    assert math.isnan(passed.largest["x"])
    assert passed.largest["y"] == math.inf


@given(
    st.binary(max_size=60)
    | st.sampled_from([b"{}", b'{"kind": "turned", "more": 1}', b'{"kind": "eval"}', b"[" * 99])
)
def test_what_is_no_message_is_refused_in_words(line):
    with pytest.raises(BenchError, match="cannot be understood"):
        from_line(line)


class OwnError(BadInputError):
    """An error of another package."""


@pytest.mark.parametrize(
    ("error", "kind"),
    [
        (OwnError("a", where="b", fix="c"), BadInputError),
        (BenchError("a", where="b", fix="c"), BenchError),
        (InterruptError("a", where="b", fix="c"), InterruptError),
        (EmergencyStopError("a", by="somebody", where="b", fix="c"), EmergencyStopError),
    ],
)
def test_an_error_passes_as_what_it_is(error: HilError, kind):
    passed = from_line(to_line(Refused(error=ErrorData.of(error)))).error.as_error()
    assert type(passed) is kind
    assert (str(passed), passed.exit_code) == (str(error), error.exit_code)
    assert getattr(passed, "by", "") == getattr(error, "by", "")
