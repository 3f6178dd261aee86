"""A channel is recorded late."""

from hil.core.effects._effect import Effect, Parameter, Stage

EFFECT = Effect(
    id="channel_skew",
    title="Channel skew",
    stage=Stage.SENSOR,
    summary="A channel is recorded late.",
    signature="Phase lag in proportion to frequency on one channel only.",
    shown_by="A chirp up to 30 Hz.",
    parameters=(Parameter("delay_s", "s", -0.5, 0.5, "how late the channel is"),),
    text_parameters=("channel",),
    needs=("rigid", "two_inertia", "three_inertia", "transfer_function"),
)
