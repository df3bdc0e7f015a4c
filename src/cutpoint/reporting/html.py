"""The report as one HTML file that needs nothing else: text escaped, pictures inside."""

import re
from base64 import b64encode
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from html import escape
from pathlib import Path
from string import Template

from cutpoint.reporting.page import Block, Page, Picture, Table

_TEMPLATE = Template((Path(__file__).parent / "template.html").read_text(encoding="utf-8"))


@dataclass(frozen=True)
class Heading:
    """The head of a report: a title, its subject, and paragraphs."""

    title: str
    source: str
    summary: tuple[str, ...]


def html(heading: Heading, pages: Sequence[Page], images: Mapping[str, bytes], versions: Mapping[str, str]) -> str:
    """The whole report; images are PNGs by key of their picture."""
    contents = (f'<li><a href="#{escape(page.key)}">{_text(page.title)}</a></li>' for page in pages)
    return _TEMPLATE.substitute(
        title=_text(heading.title),
        source=_text(heading.source),
        summary="\n".join(f"<p>{_text(words)}</p>" for words in heading.summary),
        contents="\n".join(contents),
        body="\n".join(_section(page, images) for page in pages),
        footer=_text("Computed with " + ", ".join(f"{name} {version}" for name, version in versions.items()) + "."),
    )


def _section(page: Page, images: Mapping[str, bytes]) -> str:
    body = "\n".join(_block(block, images) for block in page.blocks)
    return f'<section id="{escape(page.key)}">\n<h2>{_text(page.title)}</h2>\n{body}\n</section>'


def _block(block: Block, images: Mapping[str, bytes]) -> str:
    if isinstance(block, Table):
        return _table(block)
    if isinstance(block, Picture):
        return _picture(block, images[block.key])
    return f"<p>{_text(block)}</p>"


def _picture(picture: Picture, png: bytes) -> str:
    data = b64encode(png).decode("ascii")
    image = f'<img src="data:image/png;base64,{data}" alt="{escape(picture.label)}">'
    caption = f"<figcaption><b>{_text(picture.label)}.</b> {_text(picture.caption)}</figcaption>"
    return f'<figure id="{escape(picture.key)}">\n{image}\n{caption}\n</figure>'


def _table(table: Table) -> str:
    head = "".join(f"<th>{_text(name)}</th>" for name in table.columns)
    rows = []
    for k, cells in enumerate(table.rows):
        mark = ' class="printed"' if k in table.printed else ""
        rows.append(f"<tr{mark}>" + "".join(f"<td>{_text(cell)}</td>" for cell in cells) + "</tr>")
    caption = f"<caption><b>{_text(table.label)}.</b> {_text(table.caption)}</caption>"
    body = "\n".join(rows)
    content = f"{caption}\n<thead><tr>{head}</tr></thead>\n<tbody>\n{body}\n</tbody>"
    return f'<div class="table" id="{escape(table.key)}"><table>\n{content}\n</table></div>'


def _text(words: str) -> str:
    """Escaped text, with the marks for subscripts, superscripts and code turned into tags."""
    tags = {"_": "sub", "^": "sup"}
    text = re.sub(r"([_^])\{([^}]*)\}", lambda m: f"<{tags[m[1]]}>{m[2]}</{tags[m[1]]}>", escape(words))
    return re.sub(r"`([^`]+)`", r"<code>\1</code>", text)
