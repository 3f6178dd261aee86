"""Studies and campaigns of all services, their numbers, and files of them that the archive has."""

from __future__ import annotations

import sqlalchemy as sa
from alembic import op

revision = "0006"
down_revision = "0005"
branch_labels = None
depends_on = None


def upgrade() -> None:
    """Make the tables."""
    op.create_table(
        "results",
        sa.Column("kind", sa.String(12), primary_key=True),
        sa.Column("id", sa.Integer, primary_key=True, autoincrement=False),
        sa.Column("service", sa.String(40), nullable=False),
        sa.Column("place", sa.String(300), nullable=False),
        sa.Column("facts", sa.Text, nullable=False),
        sa.Column("kept_at", sa.DateTime(timezone=True)),
    )
    op.create_table(
        "result_files",
        sa.Column("kind", sa.String(12), primary_key=True),
        sa.Column("id", sa.Integer, primary_key=True, autoincrement=False),
        sa.Column("name", sa.String(255), primary_key=True),
        sa.Column("size", sa.BigInteger, nullable=False),
        sa.Column("sha256", sa.String(64), nullable=False),
    )
    op.create_table(
        "numbers",
        sa.Column("kind", sa.String(12), primary_key=True),
        sa.Column("last", sa.Integer, nullable=False),
    )
