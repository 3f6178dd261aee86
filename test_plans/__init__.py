"""Test plans: what a plan is, the stimuli it plays, the metrics and criteria it is judged by."""

from test_plans.conductor import PROMPT_TIMEOUT_S, Array, Conductor, PlannedSegment, Quantity, Work
from test_plans.criteria import Criterion
from test_plans.device_checks import CHECKS
from test_plans.judging import Judgement, judge, not_checked, rejudged
from test_plans.loading import library_controllers, library_plans, load_plan, plan_from_text
from test_plans.metrics import METRICS, Metric, NoValueError
from test_plans.operator_pictures import MOST_PICTURE_BYTES, pictures_of
from test_plans.pace import Outlook, Pace
from test_plans.plan import Plan, estimate_duration_s, largest_requests_nm
from test_plans.schema import plan_schema
from test_plans.sequence import Sequence, library_sequences, load_sequence
from test_plans.steps import PICTURE, STEPS, Step
from test_plans.variables import Choices, controller_choices, named_controllers

__all__ = [
    "CHECKS",
    "METRICS",
    "MOST_PICTURE_BYTES",
    "PICTURE",
    "PROMPT_TIMEOUT_S",
    "STEPS",
    "Array",
    "Choices",
    "Conductor",
    "Criterion",
    "Judgement",
    "Metric",
    "NoValueError",
    "Outlook",
    "Pace",
    "Plan",
    "PlannedSegment",
    "Quantity",
    "Sequence",
    "Step",
    "Work",
    "controller_choices",
    "estimate_duration_s",
    "judge",
    "largest_requests_nm",
    "library_controllers",
    "library_plans",
    "library_sequences",
    "load_plan",
    "load_sequence",
    "named_controllers",
    "not_checked",
    "pictures_of",
    "plan_from_text",
    "plan_schema",
    "rejudged",
]
