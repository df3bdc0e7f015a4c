"""One drive of the catalogue: what its maker prints, what the laws make of it, and a picture of both."""

from cutpoint.studies.drive.figure import save_picture
from cutpoint.studies.drive.tables import catalogue_table, print_drive
from cutpoint.studies.drive.text import entry_text

__all__ = ["catalogue_table", "entry_text", "print_drive", "save_picture"]
