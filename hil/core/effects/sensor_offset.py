"""A channel reads the truth plus an offset."""

from hil.core.effects._effect import Effect, Parameter, Stage

EFFECT = Effect(
    id="sensor_offset",
    title="Sensor offset",
    stage=Stage.SENSOR,
    summary="A channel reads the truth plus an offset.",
    signature="One channel off by a constant.",
    shown_by="Any test, best with a stretch at standstill.",
    parameters=(Parameter("offset", "channel's", -1e6, 1e6, "added to the truth"),),
    text_parameters=("channel",),
    needs=("rigid", "two_inertia", "three_inertia", "transfer_function"),
)
