"""Campaigns: many simulations of a plan, in this process or on dask.distributed, resumed where they were."""

from hil.campaign._execute import (
    BATCH_S,
    Batch,
    Carriers,
    Here,
    Kept,
    MakeRows,
    Progress,
    Row,
    batch_size,
    execute,
)
from hil.campaign._setting import Setting, Source, load_setting
from hil.campaign._simulations import Simulations
from hil.campaign._table import FOLDER, STARTED, Parts, Tally, begun_batch, write_begun, write_table

__all__ = [
    "BATCH_S",
    "FOLDER",
    "STARTED",
    "Batch",
    "Carriers",
    "Here",
    "Kept",
    "MakeRows",
    "Parts",
    "Progress",
    "Row",
    "Setting",
    "Simulations",
    "Source",
    "Tally",
    "batch_size",
    "begun_batch",
    "execute",
    "load_setting",
    "write_begun",
    "write_table",
]
