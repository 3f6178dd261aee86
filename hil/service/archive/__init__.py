"""Where files of runs are kept for good, beside the folder in which they are made: a folder or S3 by URL."""

from hil.service.archive._archive import Archive, ArchiveAwayError, Kept
from hil.service.archive._keeper import Keeper, Rounds

__all__ = ["Archive", "ArchiveAwayError", "Keeper", "Kept", "Rounds"]
