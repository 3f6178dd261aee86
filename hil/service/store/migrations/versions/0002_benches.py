"""Which service drives a bench, and which has started a run: several may share a database."""

from __future__ import annotations

import sqlalchemy as sa
from alembic import op

revision = "0002"
down_revision = "0001"
branch_labels = None
depends_on = None


def upgrade() -> None:
    """Make the table, and the column."""
    op.create_table(
        "benches",
        sa.Column("bench", sa.String(64), primary_key=True),
        sa.Column("service", sa.String(40), nullable=False),
        sa.Column("place", sa.String(300), nullable=False),
        sa.Column("until", sa.DateTime(timezone=True), nullable=False),
    )
    op.add_column("runs", sa.Column("service", sa.String(40), nullable=False, server_default=""))
