"""Campaigns: many simulations of a plan, in this process or on dask.distributed, resumed where they were."""

from hil.campaign._batches import BATCH_S, Batch, Carriers, Here, Kept, MakeRows, Row, batch_size
from hil.campaign._execute import Progress, execute
from hil.campaign._parts import FOLDER, STARTED, Parts, begun_batch, write_begun
from hil.campaign._setting import Setting, Source, load_setting
from hil.campaign._simulations import Simulations
from hil.campaign._table import Tally, write_table

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
