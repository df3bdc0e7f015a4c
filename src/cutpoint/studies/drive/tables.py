"""Output of `cutpoint drive`."""

from itertools import groupby

from rich.console import Console
from rich.table import Table
from rich.text import Text

from cutpoint.formats.catalogue.catalogue import catalogue_gear, catalogue_names
from cutpoint.formats.catalogue.sheets import CatalogueGear, Source
from cutpoint.reporting.fitting import print_table
from cutpoint.studies.drive.measured import Specimen
from cutpoint.studies.drive.rows import derived, printed
from cutpoint.studies.drive.text import estimate_note

_STATUS = {"verified": "green", "estimate": "yellow"}


def catalogue_table() -> Table:
    """Series, with the sizes that come in the same ratios on one line."""
    table = _table("drive catalogue", "series", "maker", "sizes", "ratios", "for example")
    gears = [catalogue_gear(name) for name in catalogue_names()]
    for (series, maker), members in groupby(gears, lambda gear: (gear.series, gear.maker)):
        own = list(members)
        ratios = {size: tuple(g.ratio for g in own if g.size == size) for size in dict.fromkeys(g.size for g in own)}
        for common in dict.fromkeys(ratios.values()):
            sizes = [size for size, found in ratios.items() if found == common]
            example = next(g.name for g in reversed(own) if g.size == sizes[0])
            table.add_row(series, maker, _listed(sizes), _listed(common), example)
    table.caption = "cutpoint drive NAME prints one of them; in a drive file it is called `catalogue: NAME`"
    return table


def print_drive(name: str, console: Console) -> None:
    """Sheet, what the laws give back, and the sources.  Raises ModelError for a name that is not in the catalogue."""
    specimen = Specimen(name)
    for table in (_sheet(specimen), _laws(specimen)):
        if table.row_count:
            print_table(table, console)
    if note := estimate_note(name):
        console.print(Text(note, style="yellow"))
    for source in _sources(specimen.gear):
        console.print(Text.assemble((source.key, "bold"), f": {_citation(source)}"))


def _sheet(specimen: Specimen) -> Table:
    gear = specimen.gear
    title = f"{gear.name}: {gear.maker} {gear.series}, size {gear.size}, ratio {gear.ratio}"
    table = _table(title, "group", "quantity", "value", "unit", "source", "status")
    table.columns[1].justify = "left"
    before = ""
    for line in printed(specimen):
        group = line.group if line.group != before else ""
        status = Text(line.status, style=_STATUS.get(line.status, "dim"))
        table.add_row(group, line.quantity, line.value, line.unit, line.source, status)
        before = line.group
    return table


def _laws(specimen: Specimen) -> Table:
    table = _table("what the laws give back", "quantity", "laws", "sheet", "unit", "remark")
    for line in derived(specimen):
        table.add_row(*line[:-1], Text(line.remark, style=_STATUS.get(line.remark, "default")))
    return table


def _sources(gear: CatalogueGear) -> list[Source]:
    found = {group.source.key: group.source for group in gear.groups.values()}
    return list(found.values())


def _citation(source: Source) -> str:
    pages = f"page {source.pages}" if source.pages else ""
    how = f"read from a {source.read}" if source.read else ""
    return "; ".join(filter(None, (source.title, source.document, pages, how, source.address)))


def _listed(numbers: list[int] | tuple[int, ...]) -> str:
    return ", ".join(map(str, numbers))


def _table(title: str, *columns: str) -> Table:
    table = Table(title=title, title_justify="left")
    for k, column in enumerate(columns):
        right = column in ("value", "laws", "sheet")
        table.add_column(column, justify="right" if right else "left", overflow="fold", no_wrap=k == 0)
    return table
