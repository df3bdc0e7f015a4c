"""Export: robots' functions and control laws as C that gives the same bits, builds, checks itself, says what it is."""

import re
import shutil
import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from typer.testing import CliRunner

import cutpoint
from c_builds import STRICT, CFunction, assert_same_bits, build, compilers, cpp_compilers, run
from cutpoint import Coulomb, Drive, InputError, LuGre, Rotor, TraceError
from cutpoint.commands import app
from cutpoint.control import PD, PID, AdaptiveVDC, Fault, Feedforward, Guard
from cutpoint.export import export_controller, export_function
from cutpoint.functions.facts import FACTS
from cutpoint.model import Joint, Link
from cutpoint.model.build import build as build_mechanism
from cutpoint.simulation.control_kernel import law_kernel, law_memory
from cutpoint.simulation.loop.parameters import law_parameters
from cutpoint.trajectories import cycloid
from robot_library import mixed

DYNAMICS = {
    "inverse_dynamics": 3, "forward_dynamics": 3, "mass_matrix": 1, "elastic_inverse_dynamics": 5,
    "elastic_forward_dynamics": 5,
}  # fmt: skip
"""Functions by the number of their arguments, each of six numbers."""

PERIOD = 1e-3


@pytest.fixture(scope="module")
def arm() -> cutpoint.Robot:
    return cutpoint.robots.xia2019()


@pytest.mark.parametrize("name", DYNAMICS)
def test_an_exported_function_has_the_bits_of_the_robots_own(arm: cutpoint.Robot, name: str, tmp_path: Path) -> None:
    export_function(arm, name, tmp_path)
    getattr(arm, name)(*np.zeros((DYNAMICS[name], 6)))
    kernel, rng = arm.kernel(name), np.random.default_rng(2)
    added = [arm.drive_parameters] * (len(kernel.graph.inputs) - DYNAMICS[name])
    function = CFunction(tmp_path, name, kernel.graph, flags=("-O1",))
    for scale in [0.0, 1e-300, 1e-9, *[1.0] * 50, 100.0, 1e9, 1e200, np.inf, np.nan]:
        given = [*rng.normal(size=(DYNAMICS[name], 6)) * scale, *added]
        expected = kernel(*given)
        for ours, theirs in zip(function(*given), expected if isinstance(expected, tuple) else [expected], strict=True):
            assert_same_bits(ours, theirs)


@pytest.mark.parametrize("name", FACTS)
def test_every_function_exports_and_checks_itself(arm: cutpoint.Robot, name: str, tmp_path: Path) -> None:
    options = {"frame": "link6"} if name in ("jacobian", "frame_pose", "frame_acceleration") else {}
    paths = export_function(arm, name, tmp_path, name="f", **options)
    assert {p.name for p in paths} == {"f.c", "f.h", "f.hpp", "f_check.c", "CMakeLists.txt", "README.txt"}
    build(tmp_path, "f.c", "f_check.c", "-o", "check", flags=(*STRICT, "-O0"))
    code, said = run(tmp_path)
    assert code == 0 and re.fullmatch(r"f: 0 of [1-9]\d* numbers differ\n", said)


SINGLE = (*STRICT, "-Wdouble-promotion")
"""A microcontroller whose unit has floats alone would compute doubles by software."""


@pytest.mark.parametrize("name", FACTS)
def test_every_function_exports_in_single_precision(arm: cutpoint.Robot, name: str, tmp_path: Path) -> None:
    options = {"frame": "link6"} if name in ("jacobian", "frame_pose", "frame_acceleration") else {}
    export_function(arm, name, tmp_path, name="f", precision="float32", **options)
    assert "double" not in (tmp_path / "f.h").read_text()
    assert ", in single precision" in (tmp_path / "f.c").read_text().splitlines()[0]
    build(tmp_path, "f.c", "f_check.c", "-o", "check", flags=(*SINGLE, "-O0"))
    code, told = run(tmp_path)
    assert code == 0 and re.search(r"f: 0 of \d+ numbers differ", told), told


def test_a_law_exports_in_single_precision(arm: cutpoint.Robot, tmp_path: Path) -> None:
    law = AdaptiveVDC(arm, 20.0, 50.0, 1.0, 1e-3)
    export_controller(arm, law, tmp_path, control_period=PERIOD, precision="float32")
    build(tmp_path, "control_step.c", "control_step_check.c", "-o", "check", flags=(*SINGLE, "-O1"))
    assert run(tmp_path)[0] == 0
    header = (tmp_path / "control_step.h").read_text()
    assert f"static const float control_step_memory[{law_memory(law).size}]" in header and "double" not in header
    assert f"{float(np.float32(PERIOD)).hex()}f, /* control period, s: 0.001 */" in header


def test_a_guard_needs_a_clock_that_single_precision_has_not(arm: cutpoint.Robot, tmp_path: Path) -> None:
    guarded = Guard(arm, PD([1.0] * 6, [1.0] * 6), torque_limit=200.0)
    with pytest.raises(
        InputError, match=r"a Guard measures its deadlines by time, .* or export the law that it guards"
    ):
        export_controller(arm, guarded, tmp_path, control_period=PERIOD, precision="float32")
    assert not [*tmp_path.iterdir()]


@pytest.mark.parametrize(
    ("gain", "told"), [(1e39, r"kp\[0\] is 1e\+39, but inf in"), (1e-46, r"kp\[0\] is 1e-46, but 0 in")]
)
def test_numbers_that_single_precision_loses_are_refused(
    arm: cutpoint.Robot, gain: float, told: str, tmp_path: Path
) -> None:
    law = PD([gain] * 6, [1.0] * 6)
    with pytest.raises(InputError, match=told):
        export_controller(arm, law, tmp_path, control_period=PERIOD, precision="float32")
    export_controller(arm, law, tmp_path, control_period=PERIOD)


def test_a_laws_memory_has_labels(arm: cutpoint.Robot, tmp_path: Path) -> None:
    law = Guard(arm, Integrating(), torque_limit=200.0)
    export_controller(arm, law, tmp_path, control_period=PERIOD)
    header = (tmp_path / "control_step.h").read_text()
    labels = re.findall(r"/\* (memory [^*:]+): \S+ \*/", header)
    assert len(labels) == len(set(labels)) == law_memory(law).size
    assert {"memory time", "memory fault", "memory torque[5]", "memory inner integral[5]", "memory inner samples"} <= {
        *labels
    }


@pytest.mark.parametrize(
    "flag", ["-ffast-math", "-ffinite-math-only", "-fassociative-math -fno-signed-zeros -fno-trapping-math"]
)
def test_mathematics_without_nan_is_refused(arm: cutpoint.Robot, flag: str, tmp_path: Path) -> None:
    export_function(arm, "gravity_forces", tmp_path)
    with pytest.raises(AssertionError, match="-ffast-math and parts of it change its results"):
        build(tmp_path, "gravity_forces.c", "-c", "-o", "f.o", flags=("-std=c99", "-O2", *flag.split()))


@pytest.mark.parametrize("compiler", compilers(), ids=lambda path: Path(path).name)
def test_sums_keep_their_order_where_the_compiler_says_that_it_disabled_a_flag(
    arm: cutpoint.Robot, compiler: str, tmp_path: Path
) -> None:
    export_function(arm, "mass_matrix", tmp_path)
    flags = ("-std=c99", "-O2", "-w", "-fassociative-math")
    build(tmp_path, "mass_matrix.c", "mass_matrix_check.c", "-o", "check", compiler=compiler, flags=flags)
    assert run(tmp_path) == (0, "mass_matrix: 0 of 612 numbers differ\n")


def test_the_header_holds_the_drives_numbers_and_says_what_arguments_are(arm: cutpoint.Robot, tmp_path: Path) -> None:
    export_function(arm, "elastic_inverse_dynamics", tmp_path, name="feed")
    header = (tmp_path / "feed.h").read_text()
    assert "in   jerk: 6, rad/s3 (m/s3): joint1, joint2, joint3, joint4, joint5, joint6" in header
    assert "out  motor_torque: 6, N m (N): joint1" in header and "/* joint3 compliance stiffness: 10000 */" in header
    numbers = re.findall(r"^  (\S+), /\*", header, re.MULTILINE)
    values = [float.fromhex(x.replace("HUGE_VAL", "inf").strip("()")) for x in numbers]
    assert values == arm.drive_parameters.tolist()


class Integrating:
    """A law with memory, a whole number among it."""

    gain = 30.0

    def start(self) -> dict[str, Any]:
        return {"integral": np.zeros(6), "samples": 0}

    def step(self, memory: Any, m: Any, r: Any) -> Any:
        integral = memory["integral"] + (r.theta - m.theta) * m.period
        return {"integral": integral, "samples": memory["samples"] + 1}, self.gain * integral / m.period


class Summing(Integrating):
    """As many numbers of memory as drives."""

    def start(self) -> Any:
        return np.zeros(6)

    def step(self, memory: Any, m: Any, r: Any) -> Any:
        return memory + r.theta - m.theta, self.gain * memory


def test_an_exported_law_commands_what_the_loop_commands(arm: cutpoint.Robot, tmp_path: Path) -> None:
    law = PD([2000.0] * 6, [60.0] * 6) + Feedforward(arm, "elastic") + Integrating()
    move = cycloid(np.array([0.3, 0.9, -0.6, 0.4, 0.8, -0.5]), 0.5)
    log = cutpoint.simulate(arm, law, move, duration=0.05, control_period=PERIOD)
    export_controller(arm, law, tmp_path, control_period=PERIOD)
    step = CFunction(tmp_path, "control_step", law_kernel(arm, law).graph, flags=("-O1",))
    memory, parameters = law_memory(law), law_parameters(law, PERIOD)
    reference = move.derivatives(log.time, 4)
    measured = [log[f"measured_{key}"] for key in ("q", "v", "theta", "theta_dot")]
    for k, time in enumerate(log.time):
        torque, _, theta, _, _, memory = step(*(x[k] for x in (*measured, *reference)), time, memory, parameters)
        assert_same_bits(torque, log["command_torque"][k])
        assert_same_bits(theta, log["motor_reference"][k])
    assert memory[-1] == len(log.time)


def test_an_exported_law_checks_itself_and_holds_its_memory(arm: cutpoint.Robot, tmp_path: Path) -> None:
    export_controller(arm, Integrating(), tmp_path, control_period=PERIOD, name="law")
    build(tmp_path, "law.c", "law_check.c", "-o", "check", flags=(*STRICT, "-O0"))
    assert run(tmp_path)[0] == 0
    header = (tmp_path / "law.h").read_text()
    assert "static const double law_memory[7]" in header and f"{PERIOD.hex()}, /* control period, s: 0.001 */" in header


class Descending:
    """A law whose memory begins with zeros of both signs."""

    def start(self) -> Any:
        return np.array([-0.0, 0.0])

    def step(self, memory: Any, m: Any, r: Any) -> Any:
        return memory - m.period, memory[0] * (r.theta - m.theta)


@pytest.mark.parametrize("precision", ["float64", "float32"])
def test_the_check_passes_for_a_memory_with_zeros_of_both_signs(
    arm: cutpoint.Robot, precision: str, tmp_path: Path
) -> None:
    export_controller(arm, Descending(), tmp_path, control_period=PERIOD, name="law", precision=precision)
    build(tmp_path, "law.c", "law_check.c", "-o", "check", flags=(*STRICT, "-O0"))
    assert run(tmp_path)[0] == 0


def test_the_check_of_a_law_sees_its_memory(arm: cutpoint.Robot, tmp_path: Path) -> None:
    """Memory that begins as zeros goes on from case to case."""
    law = PID([9.0] * 6, [8.0] * 6, [7.0] * 6, [0.5] * 6)
    export_controller(arm, law, tmp_path, control_period=PERIOD, name="law")
    source = (tmp_path / "law.c").read_text()
    for text, expected in ((source, 0), (source.replace("= memory[0];", "= memory[1];"), 1)):
        (tmp_path / "law.c").write_text(text)
        build(tmp_path, "law.c", "law_check.c", "-o", "check", flags=(*STRICT, "-O0"))
        assert run(tmp_path)[0] == expected


FREE = """
<mujoco><worldbody><body name="base"><freejoint/><inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/><body name="arm">
<joint name="driven" type="hinge"/>
<inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/></body></body></worldbody></mujoco>
"""


def test_the_header_of_a_law_says_what_is_read_and_what_torque_holds(tmp_path: Path) -> None:
    """Joints without a drive are not among the law's numbers."""
    (tmp_path / "free.xml").write_text(FREE)
    tree = cutpoint.load(tmp_path / "free.xml")
    export_controller(tree, PD([1.0], [1.0]), tmp_path, control_period=PERIOD, name="law")
    header = (tmp_path / "law.h").read_text()
    assert "in   q: 1, measured, of the links, not read; rad (m): driven\n" in header
    assert "in   theta: 1, measured, of the motors, rad (m): driven\n" in header
    assert "in   reference_a: 1, desired, of the links, not read; rad/s2" in header
    assert "out  fault: a number, 0, unless the law itself reports one" in header
    assert "feedforward_torque: 1, N m (N), already included in torque" in header
    assert f"to be called every {PERIOD:g} s" in header


def test_a_guarded_laws_header_says_what_to_give_without_an_encoder_and_what_faults_do(
    arm: cutpoint.Robot, tmp_path: Path
) -> None:
    """A guard would watch a position of 0, which never leaves its limits."""
    law = Guard(arm, PD([1.0] * 6, [1.0] * 6), {"measurement": "stop"}, torque_limit=200.0, upper=1.0)
    export_controller(arm, law, tmp_path, control_period=PERIOD)
    header = (tmp_path / "control_step.h").read_text()
    assert len(re.findall(r"in   (?:q|v|theta|theta_dot): .*; NaN where there is no encoder\n", header)) == 4
    assert "7 memory; after stale the last safe torque is held; after deadline or speed or" in header
    assert header.count("; after measurement or memory the torque is zero at once\n") == 1
    step = CFunction(tmp_path, "control_step", law_kernel(arm, law).graph)
    tables = law_memory(law), law_parameters(law, PERIOD)
    far, still, absent = np.full(6, 2.0), np.zeros(6), np.full(6, np.nan)
    *_, fault, _ = step(absent, absent, far, still, *[still] * 5, 0.0, *tables)
    assert fault == Fault.POSITION


def test_the_header_says_which_parameters_change_nothing(arm: cutpoint.Robot, tmp_path: Path) -> None:
    """The guard has limits of its own; the drives' are beside them, and count for nothing."""
    law = Guard(arm, PD([1.0] * 6, [1.0] * 6) + Feedforward(arm, "elastic"), torque_limit=200.0)
    export_controller(arm, law, tmp_path, control_period=PERIOD)
    header, source = ((tmp_path / f"control_step.{kind}").read_text() for kind in "hc")
    table = header[header.index("control_step_parameters[") :].split("};")[0]
    labels = re.findall(r"/\* (.*): \S+ \*/", table)
    unread = {k for k, label in enumerate(labels) if label.startswith("not read; ")}
    assert {*range(len(labels))} - unread == {int(k) for k in re.findall(r"\bparameters\[(\d+)\];", source)}
    assert "not read; Guard law parts[1] joint1 limits effort" in labels and "Guard torque_limit[0]" in labels


def test_the_header_of_a_law_says_what_faults_and_memory_are(arm: cutpoint.Robot, tmp_path: Path) -> None:
    export_controller(arm, Guard(arm, Integrating()), tmp_path, control_period=PERIOD, name="law")
    header = (tmp_path / "law.h").read_text()
    (told,) = re.findall(r"out  fault: a number, .*: (.*)", header)
    assert told.split("; ")[0].split(", ") == [f"{fault.value} {fault.name.lower()}" for fault in Fault]
    assert re.search(r"in   memory: \d+, of the law: initially the table whose name ends in _memory", header)
    export_controller(arm, Summing(), tmp_path, control_period=PERIOD, name="law")
    assert not re.search("memory.*joint1", (tmp_path / "law.h").read_text())


def test_the_header_names_rows_and_columns(arm: cutpoint.Robot, tmp_path: Path) -> None:
    joints, bodies = ", ".join(arm.joints), ", ".join(body.name for body in arm.mechanism.bodies)
    said = {}
    for function, options in {"jacobian": {"frame": "link3"}, "regressor": {}, "momentum": {}}.items():
        export_function(arm, function, tmp_path, name="f", **options)
        (said[function],) = re.findall(r"out  \w+: (.*)", (tmp_path / "f.h").read_text())
    assert (
        "of frame link3, along the frame's own axes" in said["jacobian"] and f"speeds of {joints}" in said["jacobian"]
    )
    assert f"ten for each of {bodies}: mass (kg), " in said["regressor"]
    assert "about the world's origin" in said["momentum"] and "joint1" not in said["momentum"]
    export_function(arm, "jacobian", tmp_path, name="f", frame="link3", expressed_in="local_world_aligned")
    assert "of frame link3, along the world's axes" in (tmp_path / "f.h").read_text()


def test_the_header_names_rows_and_columns_of_matrices(tmp_path: Path) -> None:
    robot, said = mixed(), {}
    speeds, drives, coefficients = map(", ".join, (robot.joints, robot.drives, robot.drive_coefficients))
    for function in ("mass_matrix", "coriolis_matrix", "drive_regressor"):
        export_function(robot, function, tmp_path, name="f")
        said |= dict(re.findall(r"out  (\w+): [^,]*, (.*)", (tmp_path / "f.h").read_text()))
    assert said["M"] == f"kg m2 (kg m, kg); rows and columns: {speeds}"
    assert said["C"].endswith(f"; rows and columns: {speeds}")
    assert said["link"] == said["motor"] == f"SI units; rows: torques of {drives}; columns: per unit of {coefficients}"


def test_the_header_names_rows_and_columns_of_derivatives(tmp_path: Path) -> None:
    robot = mixed(floating=True)
    export_function(robot, "elastic_forward_dynamics_derivatives", tmp_path, name="f")
    said = dict(re.findall(r"out  (\w+): (.*)", (tmp_path / "f.h").read_text()))
    drives = ", ".join(robot.drives)
    speeds = ", ".join([*(f"root_joint({k})" for k in range(6)), *robot.drives])
    assert said["d_a_d_q"].endswith(f", along the directions of the speeds, SI units; rows and columns: {speeds}")
    assert said["d_a_d_theta"].endswith(f", SI units; rows: {speeds}; columns: {drives}")
    assert said["d_theta_ddot_d_theta"].endswith(f", SI units; rows and columns: {drives}")


def test_the_header_says_what_wrenches_and_strains_are(arm: cutpoint.Robot, tmp_path: Path) -> None:
    wrenches = {"tool": np.zeros(6), "link3": np.zeros(6)}
    export_function(arm, "inverse_dynamics", tmp_path / "pushed", name="pushed", external=wrenches)
    header = (tmp_path / "pushed" / "pushed.h").read_text()
    assert "inverse_dynamics of xia2019, external tool, link3." in header
    assert "in   wrench_1: 6, on the robot: force (N), then moment (N m), at its frame's origin, " in header
    slides = LuGre(Coulomb(1.0, 0.5, 0.1), 1e-4, 0.0)
    sticky = arm.with_drives({j: replace(drive, link_friction=slides) for j, drive in arm.drives.items()})
    strains = np.zeros(len(sticky.strain_names))
    assert strains.size == arm.nv
    export_function(sticky, "elastic_forward_dynamics", tmp_path, name="sticky", strains=strains)
    header = (tmp_path / "sticky.h").read_text()
    assert f"in   strains: 6, rad (m): {', '.join(sticky.strain_names)}" in header
    assert "elastic_forward_dynamics of xia2019." in header


def test_the_header_says_what_an_elastic_plant_leaves_out(arm: cutpoint.Robot, tmp_path: Path) -> None:
    slides = LuGre(Coulomb(1.0, 0.5, 0.1), 1e-4, 0.0)
    first = replace(arm.drives["joint1"], link_friction=slides, motor=cutpoint.Motor(0.1, bandwidth=800.0))
    whole, name = arm.with_drives({"joint1": first}), "elastic_forward_dynamics"
    steady = "friction as in steady sliding and no hysteresis, for want of strains"
    motors = "without the motors' current loops, delays, limits, ripple and cogging"
    for robot, options, told in [
        (arm, {}, f"{name} of xia2019."),
        (whole, {}, f"{name} of xia2019, {steady}, {motors}."),
        (whole, {"strains": np.zeros(1)}, f"{name} of xia2019, {motors}."),
    ]:
        export_function(robot, name, tmp_path, **options)
        assert told in (tmp_path / f"{name}.h").read_text()


def test_the_check_looks_at_the_headers_table(arm: cutpoint.Robot, tmp_path: Path) -> None:
    """A controller that takes the table takes what the check has seen."""
    export_function(arm, "static_deflection", tmp_path, name="lead")
    header = (tmp_path / "lead.h").read_text()
    (first,) = re.findall(r"lead_parameters\[\d+\] = \{\n  ([^,]*),", header)
    for text, expected in ((header, 0), (header.replace(f"  {first},", "  0x1p0,", 1), 1)):
        (tmp_path / "lead.h").write_text(text)
        build(tmp_path, "lead.c", "lead_check.c", "-o", "check", flags=(*STRICT, "-O0"))
        assert run(tmp_path)[0] == expected


each_cpp = pytest.mark.parametrize("compiler", cpp_compilers(), ids=lambda path: Path(path).name)


@each_cpp
def test_cpp_takes_the_headers_table(arm: cutpoint.Robot, compiler: str, tmp_path: Path) -> None:
    export_function(arm, "static_deflection", tmp_path, name="lead")
    body = "double q[6] = {0}, found[6]; cutpoint::lead(q, lead_parameters, found); return 0;"
    wrong = body.replace("found[6]", "found[5]")
    for text, is_taken in ((body, True), (wrong, False)):
        (tmp_path / "use.cpp").write_text(f'#include "lead.hpp"\nint main() {{ {text} }}\n')
        done = compiled_cpp(tmp_path, compiler, "-std=c++17 -c use.cpp -o use.o")
        assert (done.returncode == 0) == is_taken, done.stderr


@each_cpp
@pytest.mark.parametrize("standard", ["c++11", "c++14", "c++17"])
def test_a_header_with_tables_suits_every_cpp(
    arm: cutpoint.Robot, tmp_path: Path, standard: str, compiler: str
) -> None:
    export_controller(arm, Integrating(), tmp_path, control_period=PERIOD, name="law")
    table = f"return law_parameters[0] != {PERIOD};" if standard == "c++17" else "return 0;"
    (tmp_path / "use.cpp").write_text(f'#include "law.h"\nint main() {{ {table} }}\n')
    done = compiled_cpp(tmp_path, compiler, f"-std={standard} -Wno-unused-const-variable use.cpp -o use")
    assert done.returncode == 0, done.stderr
    assert run(tmp_path, "use")[0] == 0


@each_cpp
@pytest.mark.parametrize("precision", ["float64", "float32"])
def test_infinite_limits_in_a_table_are_no_casts_which_cpp_warns_of(
    arm: cutpoint.Robot, tmp_path: Path, precision: str, compiler: str
) -> None:
    export_function(arm, "elastic_inverse_dynamics", tmp_path, name="f", precision=precision)
    (tmp_path / "use.cpp").write_text(
        '#include "f.hpp"\nint main() { int k = 0; for (auto x : f_parameters) k += x - x != 0; return k; }\n'
    )
    casts = "-Wold-style-cast -Wdouble-promotion" + " -Wuseless-cast" * (Path(compiler).name == "g++")
    done = compiled_cpp(tmp_path, compiler, f"-std=c++17 {casts} use.cpp -o use")
    assert done.returncode == 0, done.stderr
    assert run(tmp_path, "use")[0] == np.isinf(arm.drive_parameters).sum() > 0


def test_a_package_within_a_project_has_the_name_of_an_installed_one(arm: cutpoint.Robot, tmp_path: Path) -> None:
    """By CMake where it is installed; otherwise the file says so."""
    export_function(arm, "gravity_forces", tmp_path / "package")
    written = (tmp_path / "package" / "CMakeLists.txt").read_text()
    assert "add_library(cutpoint::gravity_forces ALIAS gravity_forces)" in written
    (tmp_path / "CMakeLists.txt").write_text(
        "cmake_minimum_required(VERSION 3.12)\nproject(ours LANGUAGES C)\nadd_subdirectory(package)\n"
        "add_executable(ours ours.c)\ntarget_link_libraries(ours cutpoint::gravity_forces)\n"
    )
    if shutil.which("cmake"):
        (tmp_path / "ours.c").write_text("int main(void) { return 0; }\n")
        done = subprocess.run(["cmake", "-B", "build"], cwd=tmp_path, capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stderr


def test_the_package_builds_installs_and_is_found(arm: cutpoint.Robot, tmp_path: Path) -> None:
    """By CMake where it is installed, otherwise by hand; also with capitals in its name."""
    export_function(arm, "mass_matrix", tmp_path, name="massMatrix")
    (tmp_path / "ours").mkdir()
    (tmp_path / "ours" / "ours.c").write_text('#include "massMatrix.h"\nint main(void) { return massMatrix == 0; }\n')
    (tmp_path / "ours" / "CMakeLists.txt").write_text(
        "cmake_minimum_required(VERSION 3.12)\nproject(ours LANGUAGES C)\nfind_package(massMatrix REQUIRED)\n"
        "add_executable(ours ours.c)\ntarget_link_libraries(ours cutpoint::massMatrix)\n"
    )
    if shutil.which("cmake"):
        for command in (
            "cmake -B build",
            "cmake --build build",
            "ctest --test-dir build",
            "cmake --install build --prefix there",
            f"cmake -S ours -B ours/build -DCMAKE_PREFIX_PATH={tmp_path / 'there'}",
            "cmake --build ours/build",
        ):
            done = subprocess.run(command.split(), cwd=tmp_path, capture_output=True, text=True, check=False)
            assert done.returncode == 0, done.stdout + done.stderr
        assert (tmp_path / "there/include/massMatrix.hpp").exists()
    else:
        build(tmp_path, "massMatrix.c", "massMatrix_check.c", "-o", "check")
        assert run(tmp_path)[0] == 0


def compiled_cpp(folder: Path, compiler: str, arguments: str) -> subprocess.CompletedProcess[str]:
    command = f"{compiler} -Wall -Wextra -Wpedantic -Werror {arguments}".split()
    return subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)


CPP = """
#include <array>
#include <vector>
#include "mass_matrix.hpp"
struct Matrix {
  enum { IsRowMajor = %d, InnerSizeAtCompileTime = 6, OuterStrideAtCompileTime = %d };
  double x[36];
  double *data() { return x; }
  int size() const { return 36; }
};
int main() {
  std::vector<double> q(6, 0.5);
  std::array<double, 36> by_rows;
  cutpoint::mass_matrix(q, by_rows);
  Matrix M;
  cutpoint::mass_matrix(q, M);
  return M.x[7] == by_rows[7] && M.x[7] > 0 ? 0 : 1;
}
"""


@each_cpp
def test_cpp_takes_any_container_and_refuses_matrices_by_columns_and_blocks(
    arm: cutpoint.Robot, tmp_path: Path, compiler: str
) -> None:
    export_function(arm, "mass_matrix", tmp_path)
    build(tmp_path, "-c", "mass_matrix.c", "-o", "mass_matrix.o")
    for by_rows, apart, told in ((1, 6, ""), (0, 6, "takes row-major matrices"), (1, 12, "copy the block first")):
        (tmp_path / "use.cpp").write_text(CPP % (by_rows, apart))
        done = compiled_cpp(tmp_path, compiler, "-std=c++17 use.cpp mass_matrix.o -lm -o use")
        assert (done.returncode == 0) == (not told) and told in done.stderr
    assert run(tmp_path, "use")[0] == 0


AS_EIGENS = """
#include "energy.hpp"
struct Block { // of a matrix with 10 rows, by columns
  double x[20] = {2.0, 3.0};
  int rows = 2, columns = 1;
  const double *data() const { return x; }
  int size() const { return rows * columns; }
  int innerStride() const { return 1; }
  int outerStride() const { return 10; }
  int innerSize() const { return rows; }
  int outerSize() const { return columns; }
};
struct Fixed : Block { enum { OuterStrideAtCompileTime = 10, InnerSizeAtCompileTime = 1, IsVectorAtCompileTime = 0 }; };
struct Column : Block {
  enum { IsRowMajor = 0, IsVectorAtCompileTime = 1, OuterStrideAtCompileTime = 10, InnerSizeAtCompileTime = 2 };
  using Block::data;
  double *data() { return x; }
};
struct Expression { int size() const { return 2; } };
int main() {
  Column out;
  %s x;
  %s
  cutpoint::energy(x, out);
  return out.x[0] == 6.0 ? 0 : 1;
}
"""


@each_cpp
def test_cpp_takes_vectors_without_gaps_only(tmp_path: Path, compiler: str) -> None:
    """A row of a matrix by columns, written as a block, would else be read as the column below its first number."""
    cutpoint.compile(lambda q: [[q[0] * q[1]], [0 * q[0]]], name="energy", q=2).to_c(tmp_path)
    build(tmp_path, "-c", "energy.c", "-o", "energy.o")
    for kind, change, told in (
        ("Column", "", ""),
        ("Block", "", ""),
        ("Block", "x.rows = 1, x.columns = 2;", "Assertion"),
        ("Fixed", "", "copy the block first"),
        ("Expression", "", "of an expression of Eigen's pass its .eval()"),
    ):
        (tmp_path / "use.cpp").write_text(AS_EIGENS % (kind, change))
        done = compiled_cpp(tmp_path, compiler, "-std=c++17 use.cpp energy.o -lm -o use")
        assert (done.returncode == 0) == (told in ("", "Assertion")), done.stderr
        assert told == "Assertion" or told in done.stderr
        if not done.returncode:
            assert (run(tmp_path, "use")[0] == 0) == (not told)


def test_full_coupling_takes_all_the_derivatives_that_it_needs(tmp_path: Path) -> None:
    rotor = Rotor(1e-5, coupling="full")
    arm = cutpoint.robots.xia2019()
    soft = cutpoint.LinearSpring(5e3)
    two = arm.with_drives({j: Drive(100.0, rotor, soft) if j in ("joint1", "joint2") else Drive() for j in arm.joints})
    export_function(two, "elastic_inverse_dynamics", tmp_path / "whole")
    assert two.derivatives_needed == 6
    assert "const double derivative_6[6]" in (tmp_path / "whole" / "elastic_inverse_dynamics.h").read_text()
    for robot in (two, arm):
        export_function(robot, "elastic_inverse_dynamics", tmp_path, name="quasi", quasi_rigid=True)
        header = (tmp_path / "quasi.h").read_text()
        assert "const double snap[6]" in header and "derivative_" not in header


def test_a_hostile_joint_name_stays_in_its_comment(arm: cutpoint.Robot, tmp_path: Path) -> None:
    from cutpoint.kernels.targets.c99_texts import comment

    told = comment("a */ x; \\\n ??/ // b")
    assert told == "a U+002A/ x; U+005CU+000A U+003FU+003F/ U+002F/ b"
    assert comment("\u5de6") != comment("\u53f3")


def test_what_cannot_be_exported_is_explained(arm: cutpoint.Robot, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"no function to export is named 'inverse'; did you mean .*dynamics'"):
        export_function(arm, "inverse", tmp_path)
    with pytest.raises(InputError, match=r"jacobian: give frame= \(--frame on the command line\)"):
        export_function(arm, "jacobian", tmp_path)
    with pytest.raises(InputError, match="no option of mass_matrix is named 'frame'"):
        export_function(arm, "mass_matrix", tmp_path, frame="link6")
    with pytest.raises(InputError, match="no frame is named 'hand'"):
        export_function(arm, "jacobian", tmp_path, frame="hand")
    with pytest.raises(InputError, match="no precision is named 'single'; there are: 'float64', 'float32'"):
        export_function(arm, "mass_matrix", tmp_path, precision="single")
    with pytest.raises(InputError, match="no precision is named 'float16'; there are"):
        export_controller(arm, PD([1.0] * 6, [1.0] * 6), tmp_path, control_period=PERIOD, precision="float16")
    with pytest.raises(InputError, match="PD is for 2 drives, but the robot has 6"):
        export_controller(arm, PD([1.0] * 2, [1.0] * 2), tmp_path, control_period=PERIOD)
    with pytest.raises(InputError, match=r"control_period 0\.0 s must be positive"):
        export_controller(arm, PD([1.0] * 6, [1.0] * 6), tmp_path, control_period=0)
    with pytest.raises(InputError, match=r"has no step\(memory, measurement, reference\)"):
        export_controller(arm, None, tmp_path, control_period=PERIOD)

    class Branching(Integrating):
        def step(self, memory: Any, m: Any, r: Any) -> Any:
            return memory, (r.q if m.q[0] > 0 else m.q)

    with pytest.raises(TraceError, match="has no truth value"):
        export_controller(arm, Branching(), tmp_path, control_period=PERIOD)
    assert not [*tmp_path.iterdir()]


@pytest.mark.parametrize(
    ("function", "inputs"), [("momentum", "q v theta_dot"), ("elastic_energy", "q theta theta_dot v")]
)
def test_speeds_of_rotors_that_turn_with_links_are_inputs(function: str, inputs: str, tmp_path: Path) -> None:
    coupled = {"compliance": cutpoint.LinearSpring(1e4), "rotor": Rotor(1e-5, coupling="full")}
    base = cutpoint.robots.xia2019()
    arm = base.with_drives({name: Drive(100.0, **coupled) for name in base.joints})
    export_function(arm, function, tmp_path)
    given = dict(zip(inputs.split(), np.random.default_rng(3).normal(size=(4, 6)), strict=False))
    expected = getattr(arm, function)(**given)
    (found,) = CFunction(tmp_path, function, arm.kernel(function).graph)(*given.values(), arm.drive_parameters)
    assert_same_bits(found, expected)


@pytest.mark.parametrize(
    ("links", "kind", "function", "lacking"),
    [
        ("base arm", "revolute", "drive_regressor", r"no drive of it has a rotor, .*; state them in a drive file"),
        ("base arm", "floating", "drive_torque", "it has no joint with a drive$"),
        ("base", "", "mass_matrix", "no joint of it moves$"),
    ],
)
def test_what_a_robot_lacks_is_told_where_a_function_has_no_numbers(
    links: str, kind: Any, function: str, lacking: str, tmp_path: Path
) -> None:
    parent, *moving = (Link(x, 1.0, inertia=np.eye(3)) for x in links.split())
    joints = [Joint(x.name, kind, parent.name, x.name) for x in moving]
    robot = cutpoint.Robot(build_mechanism("it", [parent, *moving], joints))
    with pytest.raises(InputError, match=f"^{function}: it returns no numbers: {lacking}"):
        export_function(robot, function, tmp_path)


def test_the_command_line_exports(tmp_path: Path) -> None:
    command = [sys.executable, "-c", "from cutpoint.cli import main; main()", "export", "xia2019", "--function"]
    done = subprocess.run(
        [*command, "gravity_forces", "--to", "c", tmp_path], capture_output=True, text=True, check=True
    )
    assert f"c: {tmp_path / 'gravity_forces.c'}" in done.stdout
    subprocess.run([*command, "gravity_forces", "--precision", "float32", tmp_path], capture_output=True, check=True)
    assert "gravity_forces(const float q[6]" in (tmp_path / "gravity_forces.h").read_text()
    done = subprocess.run([*command, "gravity", tmp_path], capture_output=True, text=True, check=False)
    assert done.returncode == 1 and "no function to export is named 'gravity'" in done.stderr


@pytest.mark.parametrize("axes", ["local", "world"])
def test_the_command_line_exports_what_floats_along_the_axes_that_are_asked_for(tmp_path: Path, axes: Any) -> None:
    options = ("--function", "jacobian", "--frame", "tool", "--expressed-in", axes, "--floating-base")
    done = CliRunner().invoke(app, ["export", str(cutpoint.robots.XIA2019_URDF), str(tmp_path), *options])
    assert done.exit_code == 0, done.output
    arm = cutpoint.load(cutpoint.robots.XIA2019_URDF, floating_base=True)
    q = arm.random(1)
    expected = arm.jacobian(q, "tool", axes)
    (found,) = CFunction(tmp_path, "jacobian", arm.kernel("jacobian").graph, flags=("-O1",))(q)
    assert_same_bits(found, expected)


def test_the_numbers_of_a_laws_model_have_names(arm: cutpoint.Robot, tmp_path: Path) -> None:
    law = Guard(arm, PD([1.0] * 6, [1.0] * 6) + Feedforward(arm))
    export_controller(arm, law, tmp_path, control_period=PERIOD, name="law")
    text = "".join(path.read_text() for path in tmp_path.rglob("*.h"))
    (found,) = re.findall(r"(\S+), /\* Guard law parts\[1\] joint2 link_friction viscous: [\d.]+ \*/", text)
    assert float.fromhex(found) == arm.drives["joint2"].link_friction.viscous
    assert "A step of Guard(PD + Feedforward) for xia2019, no limits but the guard's" in text
