"""The RC-S's panel on a serial line, in the style of the AK protocol."""

from drivers.panel._panel import Panel
from drivers.panel._table import PanelTable

__all__ = ["Panel", "PanelTable"]
