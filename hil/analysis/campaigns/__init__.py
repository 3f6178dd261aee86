"""Campaigns: which simulations there are, and what their table says."""

from hil.analysis.campaigns._axes import MOST_SIMULATIONS, MOST_VALUES, Axis, Case, Cases
from hil.analysis.campaigns._file import (
    CampaignFile,
    campaign_from_text,
    campaign_schema,
    controller_file,
    library_campaigns,
    load_campaign_file,
)
from hil.analysis.campaigns._findings import (
    CONFIDENCE,
    Findings,
    OfController,
    OfCriterion,
    Share,
    Worst,
    findings_of,
    rank_correlation,
)
from hil.analysis.campaigns._varied import axes_of, column_units, inputs_of, varied

__all__ = [
    "CONFIDENCE",
    "MOST_SIMULATIONS",
    "MOST_VALUES",
    "Axis",
    "CampaignFile",
    "Case",
    "Cases",
    "Findings",
    "OfController",
    "OfCriterion",
    "Share",
    "Worst",
    "axes_of",
    "campaign_from_text",
    "campaign_schema",
    "column_units",
    "controller_file",
    "findings_of",
    "inputs_of",
    "library_campaigns",
    "load_campaign_file",
    "rank_correlation",
    "varied",
]
