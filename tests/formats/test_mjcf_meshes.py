"""Bodies whose inertia comes from meshes in files: the robot that MuJoCo reads; no other file is opened."""

import re
from pathlib import Path

import numpy as np
import pytest
from beside_mujoco import assert_torques_are_mujocos, read

from cutpoint.errors import ModelError
from cutpoint.formats.mjcf import meshes as mjcf_meshes

CORNERS = np.array([[0.0, 0.0, 0.0], [0.3, 0.0, 0.0], [0.1, 0.2, 0.0], [0.05, 0.1, 0.5]])
FACES = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])


def stl(corners: np.ndarray = CORNERS) -> bytes:
    """A tetrahedron in binary STL."""
    facet = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("more", "<u2")])
    facets = np.zeros(len(FACES), facet)
    facets["corners"] = corners[FACES]
    return bytes(80) + np.uint32(len(FACES)).tobytes() + facets.tobytes()


def obj(corners: np.ndarray = CORNERS) -> bytes:
    lines = [f"v {x} {y} {z}" for x, y, z in corners] + [f"f {i} {j} {k}" for i, j, k in FACES + 1]
    return "\n".join(lines).encode()


def arm(mesh: str = '<mesh name="upper" file="upper.stl"/>', compiler: str = "", geom: str = "") -> str:
    return f"""<mujoco><compiler {compiler}/>
      <default><default class="small"><mesh scale="0.5 0.5 0.4"/></default></default>
      <asset>{mesh}<mesh name="seen" file="nowhere.stl"/></asset>
      <worldbody><body name="link"><joint name="elbow" axis="0 1 0.2"/>
        <geom type="mesh" mesh="upper" quat="1 0.2 0 0" pos="0.1 0 0" contype="0" conaffinity="0" {geom}/>
        <geom type="mesh" mesh="seen" mass="0" contype="0" conaffinity="0"/>
      </body></worldbody></mujoco>"""


CLOUD = " ".join(f"{x:.3f}" for x in np.random.default_rng(0).normal(size=90))

ROBOTS: dict[str, tuple[str, dict[str, bytes]]] = {
    "STL": (arm(), {"upper.stl": stl()}),
    "OBJ, by its density": (arm('<mesh file="upper.obj"/>', geom='density="300"'), {"upper.obj": obj()}),
    "a capital ending": (arm('<mesh name="upper" file="U.STL"/>'), {"U.STL": stl()}),
    "a scale of a class": (arm('<mesh class="small" name="upper" file="upper.stl"/>'), {"upper.stl": stl()}),
    "meshdir": (arm(compiler='meshdir="shapes/fine"'), {"shapes/fine/upper.stl": stl()}),
    "assetdir": (arm(compiler='assetdir="./shapes"'), {"shapes/upper.stl": stl()}),
    "meshdir before assetdir": (
        arm(compiler='assetdir="other" meshdir="shapes"'),
        {"shapes/upper.stl": stl(), "other/upper.stl": stl(2.0 * CORNERS)},
    ),
    "strippath": (
        arm('<mesh file="far/away/upper.stl"/>', compiler='strippath="true" meshdir="shapes"'),
        {"shapes/upper.stl": stl()},
    ),
    "a box around it": (arm(geom='type="box"').replace('type="mesh" mesh="u', 'mesh="u'), {"upper.stl": stl()}),
    "points, of whose hull few count": (arm(f'<mesh name="upper" vertex="{CLOUD}" maxhullvert="6"/>'), {"u.stl": b"-"}),
    "an inertia of its surface": (
        arm('<mesh name="upper" inertia="shell" file="upper.stl"/>'),
        {"upper.stl": stl()},
    ),
}  # fmt: skip


def written(folder: Path, text: str, files: dict[str, bytes]) -> Path:
    for name, content in {"arm.xml": text.encode(), **files}.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_bytes(content)
    return folder / "arm.xml"


def assert_it_is_mujocos(path: Path) -> None:
    robot = read(path)
    for shape in [*path.parent.rglob("[uU]*.*")]:
        (shape.parent / "nowhere.stl").write_bytes(stl())  # MuJoCo opens it
    assert_torques_are_mujocos(robot, path)


@pytest.mark.parametrize("case", ROBOTS)
def test_it_is_the_robot_that_mujoco_reads(case: str, tmp_path: Path) -> None:
    assert_it_is_mujocos(written(tmp_path, *ROBOTS[case]))


def test_a_mesh_of_an_included_file_is_beside_the_first(tmp_path: Path) -> None:
    whole = arm()
    assets = re.search("<asset>.*</asset>", whole)
    assert assets
    files = {"parts/assets.xml": f"<mujoco>{assets[0]}</mujoco>".encode(), "upper.stl": stl()}
    assert_it_is_mujocos(written(tmp_path, whole.replace(assets[0], '<include file="parts/assets.xml"/>'), files))


REFUSED: dict[str, tuple[str, dict[str, bytes], str]] = {
    "missing": (
        arm(compiler='meshdir="shapes"'), {},
        "mesh 'upper', which gives a body its inertia: there is no file 'shapes/upper.stl' in '{0}'; put it "
        "there ({0}/arm.xml:3)",
    ),
    "outside": (
        arm(compiler='meshdir="../shapes"'), {"../shapes/upper.stl": stl()},
        "'../shapes/upper.stl' is not within '{0}', so it is not read, for safety; put the file there, or give its "
        "bodies an <inertial>; MuJoCo writes one if MjSpec.compiler.saveinertial is true ({0}/arm.xml:3)",
    ),
    "from the root": (arm('<mesh name="upper" file="/etc/shape.stl"/>'), {}, "'/etc/shape.stl' is not within '{0}'"),
    "another format": (
        arm('<mesh name="upper" file="upper.dae"/>'), {"upper.dae": b"x"},
        "'upper.dae' does not end in .stl, .obj, .msh; give its bodies an <inertial>",
    ),
    "cut short": (
        arm(compiler='meshdir="shapes"'), {"shapes/upper.stl": stl()[:-20]},
        "MuJoCo cannot compile this file: Error: stl_decoder: STL file 'shapes/upper.stl' has wrong size",
    ),
    "a folder": (arm(), {"upper.stl/x": b"x"}, "is a directory; give the path of a file"),
}  # fmt: skip


@pytest.mark.parametrize("case", REFUSED)
def test_what_cannot_be_read_is_told(case: str, tmp_path: Path) -> None:
    text, files, told = REFUSED[case]
    folder = tmp_path / "robot"
    with pytest.raises(ModelError, match=re.escape(told.format(folder))):
        read(written(folder, text, files))


def test_a_link_out_of_the_folder_is_not_followed(tmp_path: Path) -> None:
    (tmp_path / "secret.stl").write_bytes(stl())
    path = written(tmp_path / "robot", arm(), {})
    (path.parent / "upper.stl").symlink_to(tmp_path / "secret.stl")
    with pytest.raises(ModelError, match=r"'upper\.stl' is not within"):
        read(path)


def test_all_meshes_together_are_bounded(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    twice = arm().replace("<body", '<body><joint/><geom type="mesh" mesh="u2"/></body><body', 1)
    twice = twice.replace("<asset>", '<asset><mesh name="u2" file="upper.stl"/>')
    path = written(tmp_path, twice, {"upper.stl": stl()})
    assert read(path).nv == 2
    monkeypatch.setattr(mjcf_meshes, "MAXIMUM_BYTES", len(stl()) + 10)
    with pytest.raises(ModelError, match=r"mesh 'upper', .* file is larger than 10 bytes, the limit"):
        read(path)
