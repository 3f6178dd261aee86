"""Every combination has one number, and every number one combination."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from hil.analysis.campaigns import Axis, Cases

AXES = st.lists(
    st.tuples(st.sampled_from(["plan", "model", "effect", "controller"]), st.integers(1, 3)), max_size=4
).map(
    lambda found: [
        Axis(group, f"n{place}", "", tuple(map(float, range(size))))
        for place, (group, size) in enumerate(found)
    ]
)


@given(AXES, st.integers(1, 3), st.integers(0, 4))
def test_numbers_and_combinations_are_one_to_one(axes, controllers, draws):
    cases = Cases(axes, controllers, draws)
    seen = set()
    for number in range(len(cases)):
        case = cases[number]
        values = tuple(case.values[axis.group][axis.name] for axis in axes)
        seen.add((values, case.controller, case.draw))
        assert case.number == number
        assert 1 <= case.draw <= draws or case.draw == draws == 0
    assert len(seen) == len(cases)


def test_what_a_car_keeps_changes_slowest():
    cases = Cases([Axis("controller", "a", "", (1.0, 2.0)), Axis("model", "b", "", (3.0, 4.0))], 1, 2)
    order = [
        (c.values["model"]["b"], c.draw, c.values["controller"]["a"])
        for c in map(cases.__getitem__, range(8))
    ]
    assert order == sorted(order)
    with pytest.raises(IndexError):
        cases[8]
