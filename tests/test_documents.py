"""Every Python block in the documents runs, in order, as a reader would paste it."""

import re
from pathlib import Path

import pytest

from c_builds import build, run
from cutpoint.control import Fault

ROOT = Path(__file__).parent.parent
DOCUMENTS = [p for p in (ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))) if "```python" in p.read_text()]


@pytest.mark.parametrize("document", DOCUMENTS, ids=lambda p: p.name)
def test_every_example_runs(document: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    scope: dict[str, object] = {}
    for block in re.findall(r"```python\n(.*?)```", document.read_text(), re.DOTALL):
        exec(compile(block, str(document), "exec"), scope)


def test_the_exported_law_is_called_as_the_document_shows(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    document = (ROOT / "docs" / "deploy.md").read_text()
    exec(re.findall(r"```python\n(.*?)```", document, re.DOTALL)[0], {})
    (shown,) = re.findall(r"```c\n(.*?)```", document, re.DOTALL)
    calls = """
#include <stdio.h>
int main(void)
{
  const double still[6] = {0}, reference[5][6] = {{0}}, times[4] = {7.0, 7.001, 7.01, 7.011};
  double torque[6];
  for (int k = 0; k < 4; k++) {
    if (k % 3 == 0) start();
    printf("%d ", step(times[k], still, still, still, still, reference, torque));
  }
  return 0;
}
"""
    folder = tmp_path / "deployed" / "law"
    (folder / "use.c").write_text(f"{shown}{calls}")
    build(folder, "use.c", "control_step.c", "-o", "check")
    assert run(folder) == (0, f"0 0 {int(Fault.DEADLINE)} 0 ")  # one period late, then from anew


def test_the_map_of_the_house_names_every_room() -> None:
    rooms = {f"`{path.parent.name}/`" for path in ROOT.glob("src/cutpoint/*/*") if path.suffix in (".py", ".yaml")}
    assert len(rooms) > 10 and not {room for room in rooms if room not in (ROOT / "CONTRIBUTING.md").read_text()}


@pytest.mark.parametrize("example", sorted((ROOT / "examples").glob("*.py")), ids=lambda p: p.name)
def test_every_example_file_runs(example: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    exec(compile(example.read_text(), str(example), "exec"), {"__name__": "__main__"})


@pytest.mark.parametrize("document", sorted((*ROOT.glob("*.md"), *ROOT.glob("docs/*.md"))), ids=lambda p: p.name)
def test_every_link_to_a_document_arrives(document: Path) -> None:
    links = re.findall(r"\]\((?!https?:)([^)#\s]*)(?:#([^)\s]*))?\)", document.read_text())
    assert not [(path, anchor) for path, anchor in links if not _arrives(document.parent / path, document, anchor)]


def _arrives(target: Path, document: Path, anchor: str) -> bool:
    page = document if target == document.parent else target
    return page.exists() and (not anchor or anchor in _anchors(page))


def _anchors(page: Path) -> set[str]:
    """As most viewers make them of headings: in lower case, letters, digits and hyphens for blanks."""
    titles = re.findall(r"(?m)^#+ (.*)$", page.read_text())
    return {re.sub(r"[^\w -]", "", title.lower()).replace(" ", "-") for title in titles}
