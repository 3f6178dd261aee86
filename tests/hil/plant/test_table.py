"""The tables of slots and states."""

import pytest

from hil.core.effects import EFFECTS
from hil.core.model import parameter_names
from hil.plant.slots import SLOTS, Table
from hil.plant.states import LINEAR_STATES, STATES


def test_a_number_gets_the_next_place_and_stands_once():
    table = Table()
    assert [table.place("speed", "rad/s", "a"), table.place("torque", "N m", "b")] == [0, 1]
    assert table.names == ("speed", "torque")
    with pytest.raises(ValueError, match="'speed' stands twice"):
        table.place("speed", "rad/s", "again")


def test_slots_carry_the_units_of_the_effects_registry():
    units = {
        f"{effect.id}.{parameter.name}": parameter.unit
        for effect in EFFECTS.values()
        for parameter in effect.parameters
    }
    slots = {entry.name: entry.unit for entry in SLOTS.entries if "." in entry.name}
    assert slots == {name: units[name] for name in slots}


@pytest.mark.parametrize("kind", ["rigid", "two_inertia", "three_inertia"])
def test_every_parameter_of_a_chain_has_a_slot(kind):
    for name in parameter_names(kind):
        assert name in SLOTS.names or name == "viscous_drag"


def test_the_linear_states_stand_first():
    assert STATES.names[:LINEAR_STATES][-1] == "housing_speed"
    assert len(STATES) == 9 + sum(effect.memory is not None for effect in EFFECTS.values())
