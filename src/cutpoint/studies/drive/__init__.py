"""One drive of the catalogue: the maker's data, the laws' results, and a figure of both."""

from cutpoint.studies.drive.figure import save_picture
from cutpoint.studies.drive.tables import catalogue_table, print_drive
from cutpoint.studies.drive.text import entry_text

__all__ = ["catalogue_table", "entry_text", "print_drive", "save_picture"]
