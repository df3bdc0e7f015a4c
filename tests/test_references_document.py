"""docs/references.md lists all of the paper's references, and every file that it names is there."""

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent
TEXT = (ROOT / "docs" / "references.md").read_text(encoding="utf-8")
ROWS = re.findall(r"^\| \[(\d+)\] \| (.*) \| (.*) \|$", TEXT, re.MULTILINE)


def test_all_thirty_references_are_there_in_order():
    assert [int(number) for number, *_ in ROWS] == [*range(1, 31)]


@pytest.mark.parametrize(("reference", "here"), [row[1:] for row in ROWS], ids=[f"[{row[0]}]" for row in ROWS])
def test_each_reference_says_who_when_and_what_became_of_it(reference, here):
    assert re.search(r"^\S.*: .*\. .*\b(19|20)\d\d\b", reference)
    paths = re.findall(r"`([^`]+)`", here)
    assert paths or "not built yet" in here or "out of scope, because" in here
    for path in paths:
        assert (ROOT / "src" / "cutpoint" / path).is_file(), f"there is no {path}"
