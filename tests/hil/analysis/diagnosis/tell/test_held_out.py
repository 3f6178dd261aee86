"""Recordings that no fit has seen: how much of them may stay."""

from hil.analysis.diagnosis.data._gap import ChannelGap
from hil.analysis.diagnosis.tell._held_out import disagreeing, words_on


def gaps(**noises: float) -> dict[str, ChannelGap]:
    return {channel: ChannelGap(0.01 * n, 0.01) for channel, n in noises.items()}


def test_without_a_name_more_than_noise_is_too_much_however_large_the_gap_was() -> None:
    assert disagreeing(gaps(a=1.4, b=1.6)) == ("b",)


def test_beside_a_name_a_tenth_of_the_gap_may_stay() -> None:
    before = gaps(a=20.0, b=20.0, c=1.0)
    assert disagreeing(gaps(a=6.0, b=7.0, c=1.6), before) == ("b", "c")


def test_it_is_said_how_much_stays_and_what_to_do() -> None:
    said = words_on(("b",), gaps(a=1.0, b=10.0))
    assert said.startswith("held-out recordings leave 10 times its noise in b: something is missing")
    assert said.endswith("give those held out as recordings too, and hold others out")
