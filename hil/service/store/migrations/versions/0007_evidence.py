"""Tokens that end, sessions of the page, and the audit log as a chain."""

from __future__ import annotations

import sqlalchemy as sa
from alembic import op

revision = "0007"
down_revision = "0006"
branch_labels = None
depends_on = None

_MOMENT = sa.DateTime(timezone=True)


def upgrade() -> None:
    """Add columns and a table; adding a column changes no row, so the log's own guard has nothing to say."""
    op.add_column("tokens", sa.Column("expires_at", _MOMENT))
    op.add_column("audit", sa.Column("chain", sa.String(64), nullable=False, server_default=""))
    op.create_table(
        "sessions",
        sa.Column("sha256", sa.String(64), primary_key=True),
        sa.Column("token", sa.Integer, nullable=False),
        sa.Column("until", _MOMENT, nullable=False),
    )
