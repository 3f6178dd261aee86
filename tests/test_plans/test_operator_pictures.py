from __future__ import annotations

from pathlib import Path

from test_plans import pictures_of, plan_from_text

PLAN = """
name: asks
steps:
  - operator_prompt: {text: one, picture: cage.svg}
  - repeat:
      times: 2
      steps:
        - operator_prompt: {text: two, picture: door.png}
        - operator_prompt: {text: three}
finally:
  - operator_prompt: {text: four, picture: cage.svg}
"""


def test_all_prompts_are_asked_for_their_pictures_once() -> None:
    assert pictures_of(plan_from_text(PLAN, "asks.yaml", Path())) == ("cage.svg", "door.png")
