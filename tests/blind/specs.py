"""Which cases there are: the full set, and a smaller one with the same proportions."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from tests.blind.families import FAMILIES
from tests.blind.later_families import LATER_FAMILIES
from tests.blind.later_groups import LATER_GROUPS, later_specs
from tests.blind.outsiders import LATER_OUTSIDERS, OUTSIDERS

GROUPS = ("single", "pair", "none", "outside", "mismatch", "one_recording", *LATER_GROUPS)

#: gap before over noise floor, by size
SIZES = {"large": 10.0, "clear": 3.0, "middle": 1.8, "edge": 1.3}
_GRADES = ("clear", "middle", "edge")


@dataclass(frozen=True)
class Spec:
    """What a case is about; `turn` tells apart cases that are otherwise alike."""

    group: str
    subject: str
    size: str
    turn: int

    @property
    def key(self) -> str:
        return f"{self.group}/{self.subject}/{self.size}/{self.turn}"


def full_set() -> list[Spec]:
    """Every effect at every size twice, and what else a diagnosis must stand."""
    specs = [Spec("single", id, size, turn) for turn in range(2) for id in FAMILIES for size in _GRADES]
    specs += [Spec("single", id, "large", 0) for id in FAMILIES]
    specs += [Spec("pair", "any", "clear" if turn % 2 else "middle", turn) for turn in range(60)]
    specs += [Spec("none", "none", "none", turn) for turn in range(30)]
    specs += [
        Spec("outside", id, size, turn)
        for turn in range(3)
        for id in (*OUTSIDERS, *LATER_OUTSIDERS)
        for size in ("clear", "middle")
    ]
    specs += [Spec("mismatch", "parameter_mismatch", "any", turn) for turn in range(24)]
    specs += [Spec("one_recording", id, "clear", turn) for turn in range(2) for id in FAMILIES]
    specs += [
        Spec("single", id, size, turn) for turn in range(2) for id in LATER_FAMILIES for size in _GRADES
    ]
    specs += [Spec("single", id, "large", 0) for id in LATER_FAMILIES]
    specs += [
        Spec("pair", id, "clear" if turn % 2 else "middle", turn)
        for turn in range(4)
        for id in LATER_FAMILIES
    ]
    specs += [Spec("one_recording", id, "clear", turn) for turn in range(2) for id in LATER_FAMILIES]
    specs += [Spec(*parts) for parts in later_specs() if parts[0] in LATER_GROUPS]
    return specs


def subset(specs: Sequence[Spec], count: int, seed: int) -> list[Spec]:
    """About `count` of `specs`, every group by its share; more than there are: with further turns."""
    rng = np.random.default_rng([seed, 7])
    rounds = -(-count // len(specs))
    chosen: list[Spec] = []
    for group in GROUPS:
        members = [s for s in specs if s.group == group]
        if not members:
            continue
        many = [
            Spec(s.group, s.subject, s.size, s.turn + 1000 * extra)
            for extra in range(rounds)
            for s in members
        ]
        wanted = max(1, round(count * len(members) / len(specs)))
        order = rng.permutation(len(many)) if rounds == 1 else np.arange(len(many))
        chosen += [many[i] for i in sorted(order[:wanted])]
    return chosen
