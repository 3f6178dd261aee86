"""Requests smaller than the half width do nothing, larger ones lose it."""

from hil.core.effects._effect import Effect, Parameter, Stage

EFFECT = Effect(
    id="torque_deadband",
    title="Torque dead band",
    stage=Stage.TORQUE_PATH,
    summary="Requests smaller than the half width do nothing, larger ones lose it.",
    signature="Small amplitudes give too little response; odd harmonics.",
    shown_by="Chirp at two amplitudes around zero torque.",
    parameters=(Parameter("half_width_nm", "N m", 0.0, 1e4, "half of the dead band's width"),),
    needs=("rigid", "two_inertia", "three_inertia", "transfer_function"),
)
