"""MJCF files that include others: the robot is that of one file that holds all; nothing leaves the folder."""

import re
from pathlib import Path

import pytest
from beside_mujoco import assert_torques_are_mujocos, read

from cutpoint.errors import ModelError
from cutpoint.formats.mjcf.includes import MAXIMUM_FILES

SCENE = """<mujoco model="scene">
  <include file="common/options.xml"/>
  <worldbody>
    <geom type="plane" size="1 1 1"/>
    <include file="arm.xml"/>
  </worldbody>
  <include file="./common/defaults.xml"/>
</mujoco>"""
FILES = {
    "scene.xml": SCENE,
    "common/options.xml": '<mujoco><option gravity="0.3 -0.2 -9.7"/><visual/></mujoco>',
    "common/defaults.xml": '<anything><default><joint armature="0.1"/></default></anything>',
    "arm.xml": """<mujocoinclude>
        <body name="upper" pos="0 0 1"><joint name="shoulder" axis="0 1 0"/><geom size="0.1" mass="1" pos="0.2 0 0"/>
          <include file="forearm.xml"/></body></mujocoinclude>""",
    "forearm.xml": """<mujoco><body name="lower" pos="0.4 0 0"><joint name="elbow" axis="0 1 0.1"/>
        <geom size="0.1" mass="0.5" pos="0.2 0 0"/></body></mujoco>""",
}


def folder(at: Path, **changes: str | None) -> Path:
    """The files, some of them changed or left out; the scene's path."""
    for name, text in {**FILES, **{f"{name}.xml": text for name, text in changes.items()}}.items():
        (at / name).parent.mkdir(exist_ok=True)
        if text is not None:
            (at / name).write_text(text)
    return at / "scene.xml"


def test_it_is_the_robot_that_mujoco_reads(tmp_path: Path) -> None:
    path = folder(tmp_path)
    robot = read(path)
    assert robot.name == "scene" and [*robot.joints] == ["shoulder", "elbow"]
    assert_torques_are_mujocos(robot, path)


def test_links_to_one_file_are_files_of_their_own(tmp_path: Path) -> None:
    """The Shadow Hand's fingers share their geoms so."""
    ball = '<geom size="0.1" mass="1" pos="0.2 0 0" contype="0"/>'
    finger = '<body name="{0}"><joint name="{0}" axis="0 1 0"/><include file="{0}.xml"/></body>'
    path = tmp_path / "hand.xml"
    path.write_text(f"<mujoco><worldbody>{finger.format('first')}{finger.format('second')}</worldbody></mujoco>")
    (tmp_path / "first.xml").write_text(f"<mujoco>{ball}</mujoco>")
    (tmp_path / "second.xml").symlink_to("first.xml")
    robot = read(path)
    assert [*robot.joints] == ["first", "second"]
    assert_torques_are_mujocos(robot, path)


ARM, LIMB = '<mujoco><include file="{}"/></mujoco>', '<mujoco><body name="x"><geom size="0.1" {}/></body></mujoco>'
REFUSED = {
    "no such file": (
        {"forearm": None},
        "<include> there is no file 'forearm.xml' in '{0}'; put it there ({0}/arm.xml:3)",
    ),
    "no name": ({"arm": "<mujoco><include/></mujoco>"}, '<include> names no file; give it file="..." ({0}/arm.xml:1)'),
    "out of the folder": (
        {"arm": ARM.format("../secret.xml")},
        "<include> '../secret.xml' is not within '{0}', so it is not read, for safety; .* ({0}/arm.xml:1)",
    ),
    "an absolute path": (
        {"arm": ARM.format("/etc/passwd")},
        "<include> '/etc/passwd' is not within '{0}', so it is not read, for safety; .* ({0}/arm.xml:1)",
    ),
    "a circle": (
        {"arm": ARM.format("scene.xml")},
        "<include> 'scene.xml': the file is already part of the model; include it once ({0}/arm.xml:1)",
    ),
    "a file twice": (
        {"arm": ARM.format("common/options.xml")},
        "<include> 'common/options.xml': the file is already part of the model; include it once ({0}/arm.xml:1)",
    ),
    "a long name": ({"arm": ARM.format("x" * 5000)}, f"<include> '{'x' * 80}' cannot be read: .* ({{0}}/arm.xml:1)"),
    "a folder": (
        {"arm": ARM.format("common")},
        "<include> 'common': '{0}/common' is a directory; give the path of a file ({0}/arm.xml:1)",
    ),
    "another format": (
        {"forearm": "<robot/>"},
        "<include> 'forearm.xml' is of another format: its root must be <mujocoinclude>, got <robot> ({0}/arm.xml:3)",
    ),
    "no XML": (
        {"forearm": "\n<mujoco"},
        "XML is not well formed: unclosed token, at column 1: the file ends, maybe cut off, before the tag or comment"
        " that begins here is closed ({0}/forearm.xml:2)",
    ),
    "entities": (
        {"forearm": '<!DOCTYPE m [<!ENTITY a "b">]><mujoco>&a;</mujoco>'},
        "XML with a document type (<!DOCTYPE>) is not read, for safety; remove it ({0}/forearm.xml:1)",
    ),
    "not a number": (
        {"forearm": "<mujoco>\n" + LIMB.format('pos="0 nan 0"')[8:]},
        "<geom> pos '0 nan 0' must not contain nan ({0}/forearm.xml:2)",
    ),
    "other text": (
        {"forearm": '<mujoco><replicate count="9"/></mujoco>'},
        "<replicate> is not read, for safety: .* ({0}/forearm.xml:1)",
    ),
    "what is wrong in MuJoCo's eyes, where it is included": (
        {"forearm": LIMB.format('sise="1"')},
        "MuJoCo cannot compile this file: .*unrecognized attribute: 'sise' Element 'geom', line 5 ({0}/scene.xml)",
    ),
    "an element that holds something": (
        {"arm": '<mujoco>\n<include file="limb.xml"><body/></include></mujoco>'},
        "<include> stands for its file and must be empty, but holds <body> ({0}/arm.xml:2)",
    ),
    "depth": (
        {"forearm": f"<mujoco>{'<body>' * 497}{'</body>' * 497}</mujoco>"},
        "XML holds elements nested more than 499 deep, the limit ({0}/forearm.xml:1)",
    ),
}


@pytest.mark.parametrize("case", REFUSED)
def test_what_is_wrong_or_hostile_is_refused(case: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    changes, message = REFUSED[case]
    (home := tmp_path / "home").mkdir()
    (tmp_path / "secret.xml").write_text("<mujoco/>")
    with pytest.raises(ModelError) as caught:
        read(folder(home, **changes))
    assert re.fullmatch(re.escape(message.format(home)).replace(r"\.\*", ".*"), str(caught.value)), str(caught.value)


def test_a_link_out_of_the_folder_is_refused(tmp_path: Path) -> None:
    (home := tmp_path / "home").mkdir()
    (tmp_path / "secret.xml").write_text(FILES["forearm.xml"])
    path = folder(home, forearm=None)
    (home / "forearm.xml").symlink_to(tmp_path / "secret.xml")
    with pytest.raises(ModelError, match=r"'forearm.xml' is not within"):
        read(path)
    (home / "forearm.xml").unlink()
    (home / "forearm.xml").symlink_to(home / "forearm.xml")
    with pytest.raises(ModelError, match=r"<include> .*'forearm.xml'"):  # in other words from Python 3.13 on
        read(path)


def test_files_are_counted(tmp_path: Path) -> None:
    many = "".join(f'<include file="{k}.xml"/>' for k in range(MAXIMUM_FILES + 1))
    path = folder(tmp_path, arm=f"<mujoco>{many}</mujoco>", **{str(k): "<mujoco/>" for k in range(MAXIMUM_FILES + 1)})
    with pytest.raises(ModelError, match=f"more than {MAXIMUM_FILES} files are included"):
        read(path)


def test_a_scene_may_stand_where_the_process_does(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    folder(tmp_path)
    monkeypatch.chdir(tmp_path)
    assert read(Path("scene.xml")).nv == 2
