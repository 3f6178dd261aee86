"""Every text that people gave, with who and when; what there is begins its history."""

from __future__ import annotations

import sqlalchemy as sa
from alembic import op

revision = "0012"
down_revision = "0011"
branch_labels = None
depends_on = None

_FIRST = """
INSERT INTO given_versions (kind, family, number, name, sha256, text, given_by, given_at)
SELECT kind, name, 1, name, sha256, text, given_by, given_at FROM given
"""


def upgrade() -> None:
    """Make the table and its index, with what is there as first versions."""
    op.create_table(
        "given_versions",
        sa.Column("kind", sa.String(12), primary_key=True),
        sa.Column("family", sa.String(64), primary_key=True),
        sa.Column("number", sa.Integer, primary_key=True, autoincrement=False),
        sa.Column("name", sa.String(64), nullable=False),
        sa.Column("sha256", sa.String(64), nullable=False),
        sa.Column("text", sa.Text, nullable=False),
        sa.Column("given_by", sa.String(100), nullable=False),
        sa.Column("given_at", sa.DateTime(timezone=True), nullable=False),
    )
    op.create_index("given_versions_by_name", "given_versions", ["kind", "name"])
    op.execute(_FIRST)
