"""Mistakes that are easily made, each planted into one function, and the law that catches it."""

from typing import Any, NamedTuple

import pytest
import test_against_pinocchio as oracle
import test_certificate as certificate
import test_closed_loop as closed_loop
import test_decomposition_laws as decomposition
import test_derivatives_of_dynamics as slopes
import test_drive_laws as drive_laws
import test_drives_that_remember as remember
import test_elastic_against_rotor_bodies as rotor_bodies
import test_elastic_laws as elastic_laws
import test_encoder_torque as bounds
import test_every_joint_kind as joint_kinds
import test_guard as guarding
import test_guard_at_its_edges as edges
import test_large_derivatives as large_derivatives
import test_large_trees as large_trees
import test_laws_against_numpy as against_numpy
import test_laws_of_adaptation as adaptation
import test_laws_of_motion as laws
import test_lean_model as lean_model
import test_looking_ahead as looking_ahead
import test_rotors_as_bodies as rotors_as_bodies
import test_sensors as sensing
import test_sizing as drive_sizing
import test_spring_and_friction_laws as springs
import test_step as step
import test_whole_drives as whole_drives
from mutation import holds, mutated

import test_package_agrees_with_paper as paper
from cutpoint import Drive, Flexspline, Robot, definitions, robots
from cutpoint.analysis import encoder_torque, virtual_power
from cutpoint.control import Fault, Guard
from cutpoint.control.laws import joint_law
from cutpoint.derivatives import definitions as derivative_definitions
from cutpoint.formats.drives import entry as drive_entry
from cutpoint.kernels.lowering import fusion
from cutpoint.kernels.machine.cache import not_kept
from cutpoint.kernels.programs import stage
from cutpoint.mechanics import (
    elastic_forward,
    elastic_inverse,
    energy,
    inverse_dynamics,
    linearly_implicit,
    power_flow,
    torque_derivatives,
)
from cutpoint.mechanics.assembly import assembly, reframing
from cutpoint.mechanics.bodies import rigid_body, rotations
from cutpoint.mechanics.bodies.rotors import Spin
from cutpoint.mechanics.bodies.spatial import Pose
from cutpoint.mechanics.drives import harmonic_drive, motor, motor_motion, strains
from cutpoint.mechanics.drives.friction import Sliding
from cutpoint.mechanics.drives.hysteresis import MaxwellSlip
from cutpoint.mechanics.drives.presliding import ElastoPlastic, LuGre
from cutpoint.mechanics.system import System
from cutpoint.rolled import bodies
from cutpoint.rolled.algorithms import derivatives as looped_derivatives
from cutpoint.simulation.loop.loop import ClosedLoop, passed_on
from cutpoint.studies.sizing import load


class Mutant(NamedTuple):
    """What is written into which function, and the law that then fails."""

    function: Any
    old: str
    new: str
    law: Any
    arguments: dict[str, Any]


ARM = {"name": "xia2019", "backend": "numpy"}
TREE = {"name": "tree", "backend": "numpy"}
MIXED = {"name": "mixed", "backend": "numpy"}

MUTANTS = {
    "lost (z q') x (U^T V)": Mutant(
        inverse_dynamics.move, " + carried.angular.cross(zv.angular)", "", oracle.test_inverse_dynamics, TREE
    ),
    "axis of the parent accelerating otherwise": Mutant(
        inverse_dynamics.turn, "axis.dot(parent.A.angular) + za", "za", oracle.test_inverse_dynamics, ARM
    ),
    "angular acceleration of a turning body by the other column": Mutant(
        inverse_dynamics.turn,
        "omega.y * omega.z - U.rows[1].z",
        "U.rows[1].z - omega.y * omega.z",
        oracle.test_regressor,
        {"name": "xia2019"},
    ),
    "gradient with the same number on both sides": Mutant(
        rigid_body.gradient_beside, "x * twice_z - U_z.x", "U_z.x", oracle.test_inverse_dynamics, ARM
    ),
    "lost (z q') x (U^T V) of a slide": Mutant(
        inverse_dynamics.move, " + carried.angular.cross(zv.linear)", "", oracle.test_inverse_dynamics, TREE
    ),
    "transposed (61) block": Mutant(
        rigid_body.net_wrench, "U @ h", "U.T @ h", paper.test_equation, {"number": "(61)", "seed": 0}
    ),
    "(61) with required and actual omega exchanged": Mutant(
        rigid_body.acceleration_gradient,
        "= omega, w, alpha",
        "= w, omega, alpha",
        laws.test_rate_of_the_mass_matrix_less_twice_c_is_skew,
        ARM,
    ),
    "gravity sign": Mutant(
        System.base_acceleration.fget, "-self.gravity", "self.gravity", oracle.test_inverse_dynamics, ARM
    ),
    "gravity sign of the potential energy": Mutant(
        energy.potential_energy,
        "total - system.gravity",
        "total + system.gravity",
        laws.test_gravity_forces_are_the_slope_of_potential_energy,
        ARM,
    ),
    "external wrench sign": Mutant(
        definitions._contact,
        "Wrench(-Vec3(*F[:3]), -Vec3(*F[3:]))",
        "Wrench(Vec3(*F[:3]), Vec3(*F[3:]))",
        oracle.test_wrenches_act_on_the_robot_as_pinocchios_external_forces,
        {"name": "tree", "frames": ("link2",)},
    ),
    "U for U^T, outward": Mutant(
        Pose.outward, "self.rotation.T", "self.rotation", paper.test_equation, {"number": "(32)", "seed": 0}
    ),
    "U^T for U, inward": Mutant(
        Pose.inward, "self.rotation @ F.force", "self.rotation.T @ F.force", oracle.test_inverse_dynamics, ARM
    ),
    "c6 sign": Mutant(
        robots.xia2019_mechanism, "if as_printed", "if not as_printed", paper.test_torques_of_the_whole_arm, {"seed": 0}
    ),
    "l for l + 1": Mutant(
        drive_entry.harmonic_ratio, "reduction + 1.0", "reduction", paper.test_equation, {"number": "(1)", "seed": 0}
    ),
    "missing 1/l of a torque": Mutant(
        Robot._across_gear,
        "gear.size) / gear",
        "gear.size) * gear",
        paper.test_equation,
        {"number": "(21)", "seed": 0},
    ),
    "missing 1/l of the rotor": Mutant(
        Drive.reflected_inertia.fget,
        "self.ratio * self.ratio * self",
        "self.ratio * self",
        paper.test_equation,
        {"number": "(56)", "seed": 0},
    ),
    "friction on the wrong side, forward": Mutant(
        elastic_forward.drive_effort,
        "drive.link_friction, at.v",
        "drive.motor_friction, at.v",
        rotor_bodies.test_accelerations_are_those_of_the_reduced_model,
        MIXED,
    ),
    "friction on the wrong side, inverse": Mutant(
        motor_motion.motor_motion,
        "drive.link_friction, v if",
        "drive.motor_friction, v if",
        elastic_laws.test_forward_dynamics_returns_the_motion_that_inverse_dynamics_was_given,
        {"name": "friction", "backend": "numpy", "friction_rates": False},
    ),
    "kappa_r = q_r": Mutant(
        motor_motion.motor_motion,
        "link + wound)",
        "link + 0 * wound)",
        elastic_laws.test_forward_dynamics_returns_the_motion_that_inverse_dynamics_was_given,
        {"name": "flexspline", "backend": "numpy", "friction_rates": False},
    ),
    "jet order minus one": Mutant(
        elastic_inverse.elastic_inverse_dynamics,
        "v = [Jet(*x) for",
        "v = [Jet(*x[:-1], 0) for",
        elastic_laws.test_motor_speed_and_acceleration_are_time_derivatives_of_motor_position,
        {"name": "flexspline", "backend": "numpy", "t": 0.7},
    ),
    "rotor counted twice": Mutant(
        assembly._with_rotors,
        "= drive.reflected_inertia",
        "= 2 * drive.reflected_inertia",
        rotors_as_bodies.test_rigidly_geared_rotors_are_bodies,
        {"seed": 0, "floating": False},
    ),
    "ratio sign of a rotor": Mutant(
        assembly._with_rotors,
        "J * drive.ratio",
        "-J * drive.ratio",
        rotors_as_bodies.test_rigidly_geared_rotors_are_bodies,
        {"seed": 0, "floating": False},
    ),
    "missing gyroscopic term": Mutant(
        Spin.reaction,
        " + omega.cross(momentum)",
        "",
        rotors_as_bodies.test_a_spinning_rotor_on_a_tilting_base_pushes_as_a_gyroscope_does,
        {},
    ),
    "gyroscopic term of an elastic drive's rotor missing": Mutant(
        Spin.reaction,
        " + omega.cross(momentum)",
        "",
        rotors_as_bodies.test_elastically_geared_rotors_are_bodies,
        {"seed": 0, "floating": True},
    ),
    "spherical rate in the wrong frame": Mutant(
        rotations.quaternion_rates,
        "product(quaternion, [*omega, 0])",
        "product([*omega, 0], quaternion)",
        joint_kinds.test_rates_of_coordinates_are_those_of_integration,
        {"seed": 0, "backend": "numpy"},
    ),
    "motor bears all of the spring's torque, kinematic error or not": Mutant(
        harmonic_drive.load_on_motor,
        "transmission(drive, theta) * tau_f",
        "tau_f",
        drive_laws.test_energy_is_conserved_with_kinematic_error,
        {},
    ),
    "no guard of the pole": Mutant(
        Flexspline.torque,
        "clip(x, -POLE_GUARD, POLE_GUARD)",
        "x",
        springs.test_tangent_and_torque_are_derivatives_of_torque_and_energy,
        {"law": Flexspline(16e3, 0.0464), "share": 1.2},
    ),
    "a cut's wrench in the frame of its inner side": Mutant(
        power_flow.power_flows,
        "V_p.power(m.X.inward(F_i))",
        "V_p.power(F_i)",
        decomposition.test_virtual_power_flows_cancel_at_every_cut,
        TREE,
    ),
    "sensor delay zero": Mutant(
        passed_on,
        "return waiting, reading",
        "return reading, waiting",
        sensing.test_a_delay_of_k_periods_shifts_every_measurement_by_k_samples,
        {"periods": 1, "backend": "numpy"},
    ),
    "saturation before feedforward": Mutant(
        ClosedLoop.actuate,
        "clip(within_limits(d.drive, u, own.at.theta_dot), -limit, limit)",
        "clip(u - command[self.layout.n + d.v], -limit, limit) + command[self.layout.n + d.v]",
        closed_loop.test_torque_limits_act_after_all_laws_are_added,
        {},
    ),
    "elements of hysteresis stretched the wrong way": Mutant(
        MaxwellSlip.strains,
        "s + displacement",
        "s - displacement",
        remember.test_a_loop_opens_by_the_loss_of_its_torque,
        {},
    ),
    "an element that never slips": Mutant(
        MaxwellSlip.strains,
        "clip(s + displacement, -r, r)",
        "s + displacement + 0 * r",
        remember.test_a_loop_opens_by_the_loss_of_its_torque,
        {},
    ),
    "bristles that slide at once": Mutant(
        ElastoPlastic.strain,
        "self.elastic",
        "0 * self.elastic",
        remember.test_elasto_plastic_bristles_hold_under_a_vibrating_load_where_lugre_creeps,
        {},
    ),
    "bristles' strain not carried over": Mutant(
        LuGre.strain,
        "forwards * before",
        "0 * before",
        remember.test_the_closed_form_solves_the_cited_differential_equation,
        {"law": remember.BRISTLES[0], "forwards": 1.0},
    ),
    "load that makes friction smaller": Mutant(
        Sliding.dry,
        "size + self.per_load",
        "size - self.per_load",
        remember.test_friction_follows_load_direction_and_temperature,
        {},
    ),
    "asymmetry to the other side": Mutant(
        Sliding.dry,
        "1 + self.asymmetry",
        "1 - self.asymmetry",
        remember.test_friction_follows_load_direction_and_temperature,
        {},
    ),
    "warm grease thicker": Mutant(
        Sliding.viscosity.fget,
        "(STATED_AT - self.grease.temperature)",
        "(self.grease.temperature - STATED_AT)",
        remember.test_friction_follows_load_direction_and_temperature,
        {},
    ),
    "back-EMF that helps": Mutant(
        motor.within_limits,
        "motor.voltage_limit, gain * theta_dot",
        "motor.voltage_limit, -gain * theta_dot",
        whole_drives.test_current_and_voltage_bound_the_torque,
        {},
    ),
    "motor friction's strain from the link's displacement": Mutant(
        strains.moved,
        "end.theta - start.theta, end.theta_dot",
        "end.q - start.q, end.theta_dot",
        whole_drives.test_the_fixed_steps_converge_to_the_adaptive_ones,
        {},
    ),
    "hysteresis lost in the inverse": Mutant(
        motor_motion.motor_motion,
        " - slipping_torque(drive, strains.spring)",
        "",
        elastic_laws.test_strains_are_counted_there_and_back,
        {},
    ),
    "a spring that nothing pulls to where it shall be wound": Mutant(
        joint_law.joint_command,
        " + gain.spring * lag",
        "",
        against_numpy.test_vdc_is_its_equations,
        {"name": "linear", "derivatives": "model", "pulled": False},
    ),
    "a rotor's spin that its carrier does not turn": Mutant(
        Spin.reaction,
        " + omega.cross(momentum)",
        "",
        adaptation.test_rate_of_the_mass_matrix_less_twice_c_is_skew_with_fully_coupled_rotors,
        {"name": "xia2019"},
    ),
    "a slope of torque by position without the turning of the wrench itself": Mutant(
        torque_derivatives.torque_derivatives,
        " + S[i].cross_wrench(F[i])",
        "",
        slopes.test_slopes_of_every_joint_kind_are_those_of_integration,
        {"seed": 6},
    ),
    "a cloud whose points drift the wrong way round": Mutant(
        torque_derivatives.Cloud.seen_from_parent,
        "_outer(momentum, r)",
        "_outer(r, momentum)",
        slopes.test_slopes_of_every_joint_kind_are_those_of_integration,
        {"seed": 6},
    ),
    "a slide that meets no other acceleration further on": Mutant(
        torque_derivatives._by_position,
        " + m.U @ S.linear",
        "",
        slopes.test_slopes_of_every_joint_kind_are_those_of_integration,
        {"seed": 4},
    ),
    "a row just written taken for any other": Mutant(
        stage.StageCode._at_hand_or_loaded,
        "icmp eq ptr",
        "icmp ne ptr",
        large_trees.test_loops_give_what_straight_line_code_gives,
        {"tree": "tree of 20", "backend": "llvm"},
    ),
    "rows looked at ahead taken by the wrong lane": Mutant(
        stage.StageCode.look_ahead,
        "code.at(self._ahead_at, lane)",
        "code.at(self._ahead_at, 0)",
        looking_ahead.test_rows_at_once_are_rows_one_by_one_to_the_last_bit,
        {"ticks": 9, "lanes": 1},
    ),
    "a base's last body taken for another tree's": Mutant(
        looped_derivatives._couples,
        "span[0] <= row[-1]",
        "span[0] < row[-1]",
        large_derivatives.test_loops_find_what_sweeps_find,
        {"tree": "floating", "backend": "llvm"},
    ),
    "a joint's own change felt without what it bears": Mutant(
        looped_derivatives._changes_within,
        "cloud.wrench(by_q) + S.cross_wrench(F)",
        "cloud.wrench(by_q)",
        large_derivatives.test_loops_find_what_sweeps_find,
        {"tree": "tree", "backend": "llvm"},
    ),
    "rates of a product counted once": Mutant(
        torque_derivatives.along_motion,
        "comb(k, lag)",
        "1",
        slopes.test_elastic_inverse_dynamics_are_their_differences,
        {"name": "flexspline", "options": {}},
    ),
    "an acceleration's slope with the wrong sign": Mutant(
        derivative_definitions._negated,
        "0 - x",
        "x",
        slopes.test_forward_dynamics,
        ARM,
    ),
    "an acceleration's slope with the wrong sign on a floating base": Mutant(
        derivative_definitions._negated,
        "0 - x",
        "x",
        slopes.test_forward_dynamics,
        {"name": "floating", "backend": "numpy"},
    ),
    "slopes along coordinates instead of tangents": Mutant(
        derivative_definitions._along_tangents,
        "return [[dot(direction, row) for direction in directions] for row in rows]",
        "return [row[:-1] for row in rows]",
        slopes.test_inverse_dynamics,
        {"name": "floating", "backend": "numpy"},
    ),
    "a drive's slope left out where it moves its own link": Mutant(
        derivative_definitions._through_drives,
        "rows[link][k] + x",
        "rows[link][k]",
        slopes.test_elastic_forward_dynamics_are_what_jets_make_of_them,
        {"name": "xia2019"},
    ),
    "a tree taken about another's first joint": Mutant(
        bodies.rooted,
        "Pose(body.placement.rotation, ZERO)",
        "body.placement",
        large_trees.test_how_far_trees_stand_from_each_other_makes_no_difference,
        {},
    ),
    "a mount far away taken for a long arm": Mutant(
        reframing._Tree.__init__,
        "for k in borne",
        "for k in (*borne, 0)",
        lean_model.test_where_a_robot_is_mounted_makes_no_difference,
        {"seed": 1, "far": 1e6},
    ),
    "a number that comes late taken away": Mutant(
        fusion._Fusion._one_after_another,
        " and rest[0].sign < 0",
        "",
        large_trees.test_loops_feel_rotors,
        {"tree": "chain of 20", "every": 2},
    ),
    "a rigid drive whose motor gain takes no power": Mutant(
        virtual_power.joint_account,
        "gain.motor * lag * lag + ",
        "",
        certificate.test_in_continuous_time_every_subsystem_keeps_its_inequality_as_an_equality,
        {"kind": "rigid", "body_gain": None},
    ),
    "asymmetry of the load's share to the other side": Mutant(
        Sliding.share_of_load,
        "1 + self.asymmetry",
        "1 - self.asymmetry",
        elastic_laws.test_friction_that_load_and_direction_change_is_counted_there_and_back_by_rigid_drives,
        {},
    ),
    "waves that leave an encoder's error as it is": Mutant(
        encoder_torque._parts,
        "1.0 + (drive",
        "1.0 + 0 * (drive",
        bounds.test_what_the_motors_encoder_is_off_by_counts_with_the_steepest_wave,
        {},
    ),
    "a way whose ends are read without an error": Mutant(
        encoder_torque._hysteresis,
        "sticks * (np.abs(way) + 2 * off)",
        "sticks * np.abs(way)",
        bounds.test_elements_may_be_strained_by_twice_the_error_of_a_reading_that_stands_still,
        {},
    ),
    "a stamp that need hardly advance": Mutant(
        Guard._found,
        "late < m.period / 2",
        "late < m.period / 9",
        edges.test_a_stamp_may_come_half_a_period_early_or_late,
        {"periods": 0.49, "fault": Fault.STALE},
    ),
    "a reaction that ends with its fault": Mutant(
        Guard.step,
        "maximum(severity, memory.severity)",
        "severity",
        guarding.test_a_later_fault_only_makes_the_reaction_more_severe,
        {},
    ),
    "a link that does not feel what resists the rotor": Mutant(
        linearly_implicit.resisted,
        " + resists.follows * net",
        "",
        step.test_with_friction_or_damping_the_step_is_of_order_three_or_more,
        {"kind": "spring"},
    ),
    "an encoder's torque without the spring's damping": Mutant(
        harmonic_drive.spring_torque_and_rate,
        "tau_f + drive.damping * wound.derivative(1)",
        "tau_f",
        against_numpy.test_full_state_feedback_is_its_equation,
        {"name": "damped"},
    ),
    "a gear that passes on what moves the rotor": Mutant(
        load._of_rotors,
        "return np.stack(",
        "return -np.stack(",
        drive_sizing.test_a_rigid_drive_is_one_of_endless_stiffness,
        {"coupling": "reduced"},
    ),
}


@pytest.mark.parametrize("name", MUTANTS)
def test_a_law_catches_the_mutant(name):
    mutant = MUTANTS[name]
    with mutated(mutant.function, mutant.old, mutant.new), not_kept():  # code on disk is that of the files
        assert not holds(mutant.law, mutant.arguments)
    assert holds(mutant.law, mutant.arguments)  # so it was the mistake that failed
