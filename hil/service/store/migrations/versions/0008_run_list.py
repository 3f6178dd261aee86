"""The tested device of a run, what the list of runs is chosen by, and plots that people chose."""

from __future__ import annotations

import sqlalchemy as sa
from alembic import op

revision = "0008"
down_revision = "0007"
branch_labels = None
depends_on = None

_DUT = """
UPDATE runs SET dut = COALESCE((SELECT MAX(criteria.dut) FROM criteria WHERE criteria.run = runs.id), '')
"""

_LISTED = ["plan", "title", "bench", "verdict", "dut", "requested_by", "state", "ended_at", "queued_at"]


def upgrade() -> None:
    """Add the column, filled from the criteria of earlier runs, indexes and the table."""
    op.add_column("runs", sa.Column("dut", sa.String(200), nullable=False, server_default=""))
    op.execute(_DUT)
    op.create_index("runs_listed", "runs", _LISTED)
    op.create_index("runs_by_end", "runs", ["ended_at"])
    op.create_index("criteria_by_id", "criteria", ["id", "run", "value"])
    op.create_table(
        "layouts",
        sa.Column("person", sa.String(100), primary_key=True),
        sa.Column("plan", sa.String(64), primary_key=True),
        sa.Column("text", sa.Text, nullable=False),
        sa.Column("kept_at", sa.DateTime(timezone=True), nullable=False),
    )
