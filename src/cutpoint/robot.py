"""A robot: what a user loads, asks and simulates."""

from collections.abc import Callable, Hashable, Mapping, Sequence
from functools import cached_property, partial
from typing import TYPE_CHECKING, Any, Literal, NoReturn, get_args

import numpy as np
from numpy.typing import ArrayLike

from cutpoint import definitions, door
from cutpoint.arrays import Array
from cutpoint.errors import InputError
from cutpoint.functions import configurations, variants
from cutpoint.functions.compiled import Functions, RobotKernels
from cutpoint.functions.facts import FACTS
from cutpoint.kernels import Kernel
from cutpoint.mechanics.bodies.rigid_body import parameters_of
from cutpoint.mechanics.bodies.spatial import ZERO, Pose
from cutpoint.mechanics.drive_regressor import DriveRegressor, columns
from cutpoint.mechanics.drives import strains as strains_of
from cutpoint.mechanics.drives.harmonic_drive import DriveState
from cutpoint.mechanics.elastic_forward import ElasticAccelerations
from cutpoint.mechanics.elastic_inverse import ElasticTorques, Options, derivatives_needed
from cutpoint.mechanics.kinematics import ExpressedIn
from cutpoint.model import Drive, Mechanism, changes
from cutpoint.model.decomposition import Cut, Subsystem, cuts_of, subsystems_of
from cutpoint.model.drive_validation import DRIVES, validated_drives
from cutpoint.model.limits import efforts_in_force, limits_in_force
from cutpoint.model.mechanism import Limits, frozen
from cutpoint.model.places import Places
from cutpoint.model.validation import check_gravity

if TYPE_CHECKING:
    from cutpoint.analysis import LinearModel, Modes

Backend = Literal["auto", "llvm", "numpy"]


class Robot:
    """A tree of bodies with its drives.  Immutable; its functions compile at their first call.

    Every function but `linearize` and `modes` takes batches: leading axes broadcast as in NumPy.  Angles in rad,
    torques in N m, at the joint's (link) side; prismatic joints in m and N.  q has nq entries, v and a have nv, theta
    and motor torques one a drive.
    Quaternions (x, y, z, w) may have any length from 1e-50 on: all but `coordinate_rates` normalise them.
    A wrong shape, an unknown name or option, or a number that is not finite or beyond 1e15, raises InputError that
    names it.  Forward dynamics raise ModelError where a joint moves no inertia.
    """

    mechanism: Mechanism
    drives: Mapping[str, Drive]
    backend: Backend
    _compiled: RobotKernels
    _function: Callable[..., Callable[..., Any]]
    _functions: Functions

    def __init__(
        self,
        mechanism: Mechanism,
        drives: Mapping[str, Drive] | None = None,
        *,
        backend: Backend = "auto",
    ) -> None:
        """drives: by joint name; a joint without one is driven rigidly.  backend: how kernels are compiled.

        Raises InputError for what is no mechanism or backend, ModelError for drives that break a rule.
        """
        door.checked_name("backend", backend, get_args(Backend))
        door.check_kind("Robot", "mechanism", mechanism, Mechanism, "a Mechanism (cutpoint.load reads files)")
        own = frozen(validated_drives(mechanism, {} if drives is None else drives))
        compiled = RobotKernels(mechanism, own, backend)
        parts = {"mechanism": mechanism, "drives": own, "backend": backend, "_compiled": compiled}
        parts |= {"_function": compiled.function, "_functions": compiled.functions}
        for name, part in parts.items():
            object.__setattr__(self, name, part)

    def __setattr__(self, name: str, value: Any) -> NoReturn:
        raise AttributeError(
            f"a Robot is immutable, so its {name} cannot be set: with_drives and the like make new ones"
        )

    def __reduce__(self) -> tuple[Any, ...]:
        """As it was made: machine code stays behind, a copy or what comes out of a pickle compiles anew."""
        return partial(type(self), backend=self.backend), (self.mechanism, dict(self.drives))

    # what it is

    @property
    def name(self) -> str:
        """The robot's name, as its file states it."""
        return self.mechanism.name

    @property
    def joints(self) -> tuple[str, ...]:
        """Names of the driven joints, in the order of theta.

        q and v have them in this order too, among the entries of a floating base and of joints of several axes.
        """
        return tuple(self.mechanism.driven_joints)

    @property
    def frames(self) -> tuple[str, ...]:
        """Names of all frames: bodies, and what was fixed to them."""
        return tuple(self.mechanism.frames)

    @property
    def nq(self) -> int:
        """Number of coordinates."""
        return self._compiled.machine.system.nq

    @property
    def nv(self) -> int:
        """Number of speeds."""
        return self._compiled.machine.system.nv

    @property
    def gravity(self) -> Array:
        """Acceleration of free fall in the world's frame, (3,), m/s2."""
        return self.mechanism.gravity

    @cached_property
    def subsystems(self) -> tuple[Subsystem, ...]:
        """The joints and links that virtual decomposition makes of the robot.  Xia (2019) section III.A."""
        return subsystems_of(self.mechanism)

    @cached_property
    def cuts(self) -> tuple[Cut, ...]:
        """The cutting points between the subsystems.  Xia (2019) section III.A."""
        return cuts_of(self.mechanism)

    @property
    def limits(self) -> dict[str, Limits]:
        """The tighter of each driven joint's limits and its drive's, by joint; inf where there is none.

        lower, upper: rad (m); velocity: rad/s (m/s); effort: N m (N), without what the motor's current allows.
        """
        return limits_in_force(self.mechanism, self.drives)

    @cached_property
    def effort_limits(self) -> Array:
        """The most that each motor may exert at its joint, (drives,), N m (N); inf where there is no limit.

        The tighter of `limits`' effort and of what the motor's current limit allows.
        """
        return frozen(efforts_in_force(self.mechanism, self.drives))

    def neutral(self) -> Array:
        """The configuration with every joint unmoved, (nq,): zeros, and quaternions that turn by nothing.

        It may be outside limits, and an MJCF file's `ref` and keyframes do not change it.
        """
        return configurations.neutral(self.machine.system)

    def random(self, seed: "int | np.random.Generator | None" = None, size: int | tuple[int, ...] = ()) -> Array:
        """Random configurations (*size, nq): within limits where there are any, otherwise within a turn, or 1 m.

        A free turn is spread evenly over all turns.
        """
        shape = door.checked_shape("random", "size", size)
        try:
            rng = np.random.default_rng(seed)
        except (TypeError, ValueError):
            raise door.refused("random", "seed", seed, "a whole number from 0, or a NumPy Generator") from None
        return configurations.at_random(self.mechanism, self.machine.system, rng, shape, self.limits)

    # others like it

    def with_drives(self, drives: Mapping[str, Drive]) -> "Robot":
        """The same robot with these joints' drives replaced, by joint name; the others keep theirs.

        If the drives differ in numbers only, both robots share their compiled functions.
        Raises InputError for an unknown joint, ModelError for a drive that breaks a rule.
        """
        door.check_kind("with_drives", "drives", drives, Mapping, DRIVES)
        other = Robot(self.mechanism, {**self.drives, **drives}, backend=self.backend)
        other._compiled.share_kernels_with(self._compiled)
        return other

    def with_payload(self, mass: float, com: ArrayLike, inertia: ArrayLike, frame: str) -> "Robot":
        """The same robot with a payload fixed to a frame: mass (kg), com (3,) (m), inertia about it (3, 3) (kg m2).

        com and inertia along the frame's axes.
        Raises InputError for an unknown frame, ModelError for one fixed to the world, and for numbers that no body can
        have.
        """
        return Robot(changes.with_payload(self.mechanism, mass, com, inertia, frame), self.drives, backend=self.backend)

    def with_gravity(self, gravity: ArrayLike) -> "Robot":
        """The same robot under another gravity: acceleration of free fall (3,) in the world's frame, m/s2.

        Raises InputError for another shape, ModelError for more than a robot file may state.
        """
        fall = door.checked_array("with_gravity", "gravity", gravity, 3)
        if fall.ndim != 1:
            raise door.refused("with_gravity", "gravity", fall, "one vector (3,)")
        check_gravity(fall, Places())
        return Robot(self.mechanism.with_gravity(fall), self.drives, backend=self.backend)

    def with_base(self, placement: ArrayLike) -> "Robot":
        """The same robot mounted elsewhere: placement (4, 4) of its base in the world.

        Raises ModelError for a matrix that is no placement.
        """
        return Robot(changes.with_base(self.mechanism, placement), self.drives, backend=self.backend)

    # the rigid robot

    def inverse_dynamics(
        self, q: ArrayLike, v: ArrayLike, a: ArrayLike, external: Mapping[str, ArrayLike] | None = None
    ) -> Array:
        """Joint torques (..., nv), N m (N), of a motion: M a + bias.  Xia (2019) eqs. (29)-(31), (44)-(47).

        q (..., nq), rad (m); v and a (..., nv), rad/s and rad/s2 (m/s, m/s2).  external: wrenches [force; moment]
        (..., 6), N and N m, that act on the robot at a frame's origin, along its axes, by the frame's name.  The rotor
        of a rigid drive counts as armature; friction does not count.
        """
        if external is None:
            return self._functions["inverse_dynamics"](q, v, a)
        return self._under_wrenches("inverse_dynamics", (q, v, a), external)

    def forward_dynamics(
        self, q: ArrayLike, v: ArrayLike, tau: ArrayLike, external: Mapping[str, ArrayLike] | None = None
    ) -> Array:
        """Accelerations (..., nv), rad/s2 (m/s2), under joint torques.  Featherstone (2008) section 7.3.

        q (..., nq), rad (m); v (..., nv), rad/s (m/s); tau (..., nv), N m (N); external as in `inverse_dynamics`.
        Raises ModelError if a joint moves no inertia.  If joints can move against each other without moving any inertia
        at q alone, as in the gimbal lock of links without mass, accelerations are huge or NaN.
        """
        if external is None:
            return self._functions["forward_dynamics"](q, v, tau)
        return self._under_wrenches("forward_dynamics", (q, v, tau), external)

    def mass_matrix(self, q: ArrayLike) -> Array:
        """M(q), (..., nv, nv), kg m2 (kg m, kg).  Featherstone (2008) section 6.2."""
        return self._functions["mass_matrix"](q)

    def bias_forces(self, q: ArrayLike, v: ArrayLike) -> Array:
        """Joint torques (..., nv), N m (N), at zero acceleration: Coriolis, centrifugal and gravity."""
        return self._functions["bias_forces"](q, v)

    def gravity_forces(self, q: ArrayLike) -> Array:
        """Joint torques (..., nv), N m (N), that hold the robot at rest against gravity."""
        return self._functions["gravity_forces"](q)

    def coriolis_matrix(self, q: ArrayLike, v: ArrayLike) -> Array:
        """C(q, v), (..., nv, nv): the sum of the bodies' C(omega), Xia (2019) eq. (61); M' - 2 C is skew symmetric.

        N m (N) for each rad/s (m/s).  Of the many C with C v = Coriolis and centrifugal torques this is the one of
        virtual decomposition.
        """
        return self._functions["coriolis_matrix"](q, v)

    def regressor(self, q: ArrayLike, v: ArrayLike, a: ArrayLike) -> Array:
        """Y(q, v, a), (..., nv, 10 n): Y p for p = `inertial_parameters` is the torque of all bodies.

        `inverse_dynamics` has beside it what rigidly geared rotors' own spin costs, which is not in Y p: the armature,
        inertia times ratio^2 times a, and with full coupling what the spin exchanges with its carrier.
        """
        return self._functions["regressor"](q, v, a)

    @cached_property
    def inertial_parameters(self) -> Array:
        """(10 n,): for each body mass, first moment (3), inertia about its frame's origin xx xy xz yy yz zz.

        As the dynamics have them: a rotor that a body carries and its own inertia does not hold
        (`in_link_inertia=False`) counts with its mass and its inertia at rest.
        """
        rows: list[float] = []
        for segment in self.machine.system.segments:
            rows += parameters_of(segment.inertia.seen_from_parent(Pose(segment.to_user_axes, ZERO)))
        return frozen(np.array(rows, dtype=np.float64))

    def jacobian(self, q: ArrayLike, frame: str, expressed_in: ExpressedIn = "local") -> Array:
        """(..., 6, nv): a frame's velocity [linear; angular], m/s and rad/s, for each speed of one rad/s (m/s).

        Xia (2019) eqs. (37)-(38).  frame: the name of one of `frames`; InputError lists them for any other.
        expressed_in: "local", the frame's own axes; "local_world_aligned", the same velocity along the world's axes;
        "world", the velocity, along the world's axes, of the point of the frame's body that passes the world's origin.
        """
        key = "jacobian", frame, expressed_in
        return (self._known(key) or self._of_frame(definitions.jacobian, *key))(q)

    def frame_acceleration(
        self, q: ArrayLike, v: ArrayLike, a: ArrayLike, frame: str, expressed_in: ExpressedIn = "local"
    ) -> Array:
        """(..., 6): J a + J' v, the time derivative of a frame's velocity J v, m/s2 and rad/s2; J' v where a is zero.

        frame and expressed_in: as in `jacobian`; without gravity.  For "local_world_aligned" it is the acceleration of
        the frame's origin, and the angular acceleration, in the world; for "local" and "world" the spatial one,
        Featherstone (2008) section 2.11.
        """
        key = "frame_acceleration", frame, expressed_in
        return (self._known(key) or self._of_frame(definitions.frame_acceleration, *key))(q, v, a)

    def frame_pose(self, q: ArrayLike, frame: str) -> Array:
        """(..., 4, 4): pose of a frame, by its name: maps its coordinates (m) to those of the world."""
        key = "frame_pose", frame
        return (self._known(key) or self._of_frame(definitions.frame_pose, *key))(q)

    def velocity_map(self, q: ArrayLike) -> Array:
        """(..., 6 n, nv): the stacked velocities of all bodies, each in its own joint frame, for each speed.

        The rows below J_q of the paper's J_ba, Xia (2019) eqs. (39)-(43); body frames have their z along the joint.
        """
        return self._functions["velocity_map"](q)

    def kinetic_energy(self, q: ArrayLike, v: ArrayLike) -> Array:
        """(...,) J, of links and of rigidly geared rotors; those of drives that bend are in `elastic_energy`."""
        return self._functions["kinetic_energy"](q, v)

    def potential_energy(self, q: ArrayLike) -> Array:
        """(...,) J, of the weight; zero with all centres of mass at the world's origin."""
        return self._functions["potential_energy"](q)

    def momentum(self, q: ArrayLike, v: ArrayLike, theta_dot: ArrayLike | None = None) -> Array:
        """(..., 6): linear (kg m/s) and angular momentum (kg m2/s) about the world's origin, along its axes.

        theta_dot: of the motors; where rotors with full coupling turn behind drives that bend, their spin counts, and
        it is an InputError to leave it out.  That of a rotor with reduced coupling, or in the world, never counts.
        """
        if theta_dot is None:
            self._check_told("momentum", "theta_dot", "motors")
            return self._functions["momentum"](q, v)
        return self._with("momentum", "theta_dot")(q, v, theta_dot)

    def power_flows(self, q: ArrayLike, v: ArrayLike, a: ArrayLike) -> Array:
        """(..., cuts): power that passes outward through each of `cuts`, W.  Zhu (2010) section 2.9."""
        return self._functions["power_flows"](q, v, a)

    def integrate(self, q: ArrayLike, v: ArrayLike, dt: ArrayLike) -> Array:
        """(..., nq): coordinates after a time dt (...), s, at constant speeds v, each joint in its moving frame."""
        return self._functions["integrate"](q, v, dt)

    def difference(self, q: ArrayLike, q_next: ArrayLike) -> Array:
        """(..., nv): the constant speeds that lead from q to q_next in a unit of time: the inverse of `integrate`."""
        return self._functions["difference"](q, q_next)

    def coordinate_rates(self, q: ArrayLike, v: ArrayLike) -> Array:
        """(..., nq): time derivative of q; v itself but for quaternions and planar joints."""
        return self._functions["coordinate_rates"](q, v)

    # elastic joints

    def elastic_inverse_dynamics(
        self,
        q: ArrayLike,
        v: ArrayLike,
        a: ArrayLike,
        jerk: ArrayLike,
        snap: ArrayLike,
        *higher: ArrayLike,
        friction_rates: bool = False,
        quasi_rigid: bool = False,
        strains: ArrayLike | None = None,
    ) -> ElasticTorques[Array]:
        """Motor torques and motor motion of a motion of the links, exact.  Xia (2019) eqs. (2), (4)-(11), (21)-(28).

        q (..., nq), its derivatives (..., nv) in rad/s, rad/s2, ... (m/s, ...).  Returns motor_torque, theta, theta_dot
        and theta_ddot, (..., drives), and joint_torque, (..., nv), in N m, rad, rad/s, rad/s2 (N, m, ...).
        It takes as many derivatives of the position as `derivatives_needed` says: four, and more where bending joints
        carry rotors with full coupling.  quasi_rigid does with four always: rotors act on what carries them as if their
        drives did not bend.
        Friction enters by value; with friction_rates its derivatives pass through the spring too.  A rigid drive's
        motor moves as its joint does.  strains: what the drives remember, see `strain_names`; without them friction is
        as in steady sliding, and springs have no hysteresis.
        Of a damped spring theta_dot is not d theta/dt to the last bit, but off by damping / stiffness times the second
        derivative of its deflection: at each instant `elastic_forward_dynamics` still gives a and theta_ddot back, but
        along a path theta and theta_dot disagree by as much, and motors that follow them let the arm depart from it.
        Raises InputError for another number of derivatives.
        """
        is_plain = friction_rates is False and quasi_rigid is False and strains is None and not higher
        if is_plain and self.derivatives_needed == 4:
            return self._functions["elastic_inverse_dynamics"](q, v, a, jerk, snap)
        door.check_truths("elastic_inverse_dynamics", friction_rates=friction_rates, quasi_rigid=quasi_rigid)
        key = ("elastic_inverse_dynamics", friction_rates, quasi_rigid, strains is None)
        made = self._functions.get(key)
        given, needed = (q, v, a, jerk, snap, *higher), 4 if quasi_rigid else self.derivatives_needed
        if len(given) != needed + 1:
            raise variants.wrong_motion("elastic_inverse_dynamics", len(given) - 1, needed)
        if strains is not None:
            given = (*given, strains)
        if made is None:
            inputs = variants.motion_names(needed) + ("" if strains is None else " strains")
            definition = partial(definitions.elastic_inverse_dynamics, options=Options(friction_rates, quasi_rigid))
            facts = FACTS["elastic_inverse_dynamics"]._replace(definition=definition, inputs=inputs)
            made = self._function(key, facts)
        return made(*given)

    @cached_property
    def derivatives_needed(self) -> int:
        """Derivatives of the position that an exact `elastic_inverse_dynamics` takes: 4, and 2 more for each bending
        drive's rotor with full coupling that itself rides on a bending joint, along the arm that has most of them.

        A rotor rides on the link before its joint: of an arm that bends throughout, full coupling in the first joint
        alone takes 4, in any other alone 6, in all n joints 2 (n + 1).  Buondonno and De Luca (2015).
        """
        return max(4, derivatives_needed(self.machine.system, self.machine.drives))

    def elastic_forward_dynamics(
        self,
        q: ArrayLike,
        v: ArrayLike,
        theta: ArrayLike,
        theta_dot: ArrayLike,
        motor_torque: ArrayLike,
        strains: ArrayLike | None = None,
    ) -> ElasticAccelerations[Array]:
        """Accelerations of links and motors under motor torques, friction included.  Spong (1987).

        q (..., nq), v (..., nv); theta, theta_dot and motor_torque (..., drives).  Returns a (..., nv) and theta_ddot
        (..., drives), rad/s2 (m/s2); a rigid drive's motor moves as its joint does.
        strains: as in `elastic_inverse_dynamics`.
        """
        if strains is None:
            return self._functions["elastic_forward_dynamics"](q, v, theta, theta_dot, motor_torque)
        function = self._with("elastic_forward_dynamics", "strains")
        return function(q, v, theta, theta_dot, motor_torque, strains)

    @cached_property
    def strain_names(self) -> tuple[str, ...]:
        """What the drives remember, in the order of all arrays of strains: rad (m) by which bristles and elements of
        hysteresis are wound up.  Empty for drives without a past."""
        each = [[f"{name}: {what}" for what in strains_of.names(drive)] for name, drive in self.drives.items()]
        return tuple(strains_of.gathered(each))

    def elastic_energy(
        self,
        q: ArrayLike,
        theta: ArrayLike,
        theta_dot: ArrayLike,
        strains: ArrayLike | None = None,
        *,
        v: ArrayLike | None = None,
    ) -> Array:
        """(...,) J, in springs, in the spin of elastic drives' rotors, and in what is strained, if that is given.

        v: of the links.  Leaving it out raises InputError if an elastic drive's rotor has full coupling and rides on a
        link that turns: its energy depends on v.
        """
        if v is None:
            self._check_told("elastic_energy", "v", "links")
        extra = {key: x for key, x in (("strains", strains), ("v", v)) if x is not None}
        return self._with("elastic_energy", *extra)(q, theta, theta_dot, *extra.values())

    def drive_torque(self, theta: ArrayLike, q: ArrayLike) -> Array:
        """(..., drives) N m: torque read from the deflection between two encoders.  Xia (2019) eqs. (2)-(3).

        theta is the motor's encoder over ratio, q the link's.  The drive's damping, and what lies beyond the spring, is
        not seen; a rigid drive shows 0.
        """
        return self._functions["drive_torque"](theta, q)

    def static_deflection(self, q: ArrayLike) -> Array:
        """(..., drives) rad: how far each motor leads its link at rest under gravity."""
        return self._functions["static_deflection"](q)

    def friction_torques(self, v: ArrayLike) -> Array:
        """(..., nv) N m: link-side friction; motor-side friction is not included.  Xia (2019) eq. (54)."""
        return self._functions["friction_torques"](v)

    def drive_regressor(
        self, q: ArrayLike, v: ArrayLike, theta: ArrayLike, theta_dot: ArrayLike, theta_ddot: ArrayLike
    ) -> DriveRegressor:
        """(..., drives, c) each, N m a unit: torques on the links and of the motors are link @ c and motor @ c.

        c are `drive_coefficients`.  A rigid drive's motor row lacks the torque on its link, its link row is empty.
        Friction is as in steady sliding and without load; hysteresis, and what a rotor with full coupling feels of its
        carrier, is not in it.  Xia (2019) eqs. (2), (54)-(56).
        """
        return self._functions["drive_regressor"](q, v, theta, theta_dot, theta_ddot)

    @property
    def drive_coefficients(self) -> dict[str, float]:
        """Coefficients in which the drives are linear, by name ("stiffness.joint1"), in `drive_regressor`'s order."""
        still = DriveState(0.0, 0.0, 0.0, 0.0)
        each = {name: columns(drive, still, 0.0) for name, drive in self.drives.items()}
        return {f"{column.name}.{name}": float(column.value) for name, own in each.items() for column in own}

    def linearize(
        self,
        q: ArrayLike,
        v: ArrayLike | None = None,
        motor_torque: ArrayLike | None = None,
        *,
        friction: bool = False,
    ) -> "LinearModel":
        """The linear model near a state, at rest by default: see `cutpoint.analysis.linearize`."""
        from cutpoint.analysis import linearize

        return linearize(self, q, v, motor_torque, friction=friction)

    def modes(self, q: ArrayLike, *, friction: bool = False) -> "Modes":
        """Frequencies, dampings and shapes of the drives' modes at rest at q: see `cutpoint.analysis.modes`."""
        from cutpoint.analysis import modes

        return modes(self, q, friction=friction)

    def to_rotor(self, *, angle: ArrayLike | None = None, torque: ArrayLike | None = None) -> Array:
        """Joint-side angles (or speeds) times ratio, or torques over ratio: at the rotor's side, (..., drives).

        Raises InputError unless exactly one of them is given.
        """
        return self._across_gear("to_rotor", angle, torque, self._ratios)

    def from_rotor(self, *, angle: ArrayLike | None = None, torque: ArrayLike | None = None) -> Array:
        """Rotor-side angles (or speeds) over ratio, or torques times ratio: at the joint's side, (..., drives).

        Raises InputError unless exactly one of them is given.
        """
        return self._across_gear("from_rotor", angle, torque, 1 / self._ratios)

    # how

    @property
    def machine(self) -> definitions.Machine:
        """The robot in the form that the equations take, for control laws that are traced with it."""
        return self._compiled.machine

    def machine_with(self, parameters: Sequence[Any], *, lean: bool = False) -> definitions.Machine:
        """The same with other numbers, of any kind, in its drives: see `drive_parameters`.

        Raises InputError for more or fewer of them.
        lean: with frames, inertias and a unit of length that cost least, for functions that tell nothing of single
        bodies or places.
        """
        door.check_kind(
            "machine_with", "parameters", parameters, (Sequence, np.ndarray), "numbers, as drive_parameters"
        )
        return self._compiled.with_parameters(parameters, lean)

    @cached_property
    def trace_key(self) -> Hashable:
        """Equal for robots that one trace serves: the same mechanism, driven through drives of the same structure."""
        return (id(self.mechanism), self.backend, self._compiled.structure)

    @property
    def drive_parameters(self) -> Array:
        """All numbers of the drives, (n,), in the order of the drives and of their fields; not to be written to."""
        return self._compiled.parameters

    def kernel(self, name: str) -> Kernel:
        """The compiled kernel behind a function that has been called: its operations and its graph.

        name: the method's, or a function's of `cutpoint.derivatives` with "_derivatives" behind it.  Where drives
        count, its last input is `parameters`: `drive_parameters`.
        Raises InputError for a function that has not been called.
        """
        door.check_kind("kernel", "name", name, str, "a function's name")
        return self._compiled.made(name)

    def _known(self, key: tuple[str, ...]) -> Callable[..., Any] | None:
        """A function that has been made; None also for a key that can be none, such as a list in place of a name."""
        try:
            return self._functions.get(key)
        except TypeError:
            return None

    def _of_frame(
        self, definition: Callable[..., Any], name: str, frame: str, *expressed_in: ExpressedIn
    ) -> Callable[..., Any]:
        """A definition for one frame, made.  Raises InputError for an unknown frame, or way to express a velocity."""
        asked = {"frame": door.checked_name("frame", frame, self.mechanism.frames)}
        for way in expressed_in:
            asked["expressed_in"] = door.checked_name("way to express a velocity", way, get_args(ExpressedIn))
        return self._function((name, *asked.values()), FACTS[name]._replace(definition=partial(definition, **asked)))

    def _check_told(self, function: str, name: str, whose: str) -> None:
        """Raises InputError if rotors turn with their carriers, and at speeds of their own."""
        if self.machine.system.has_sprung_rotors:
            reason = "rotors with full coupling turn at their own speeds, on links that turn"
            raise InputError(f"{function}: also give {name}=, the {whose}' speeds: {reason}", name=name)

    def _with(self, name: str, *extra: str) -> Callable[..., Any]:
        """A function with further inputs of these names."""
        if not extra:
            return self._functions[name]
        facts = FACTS[name]
        return self._function((name, *extra), facts._replace(inputs=" ".join([facts.inputs, *extra])))

    def _under_wrenches(self, name: str, given: Sequence[ArrayLike], external: Mapping[str, ArrayLike]) -> Array:
        """A function of a motion whose robot bears wrenches, compiled for their frames."""
        wrenches = variants.checked_wrenches(name, external, self.mechanism.frames)
        if not wrenches:
            return self._functions[name](*given)
        facts = FACTS[name]
        inputs = " ".join([facts.inputs, *(f"wrench_{k}" for k in range(len(wrenches)))])
        definition = variants.on_frames(facts.definition, tuple(wrenches))
        made = self._function((name, *wrenches), facts._replace(definition=definition, inputs=inputs))
        return made(*given, *wrenches.values())

    @property
    def _ratios(self) -> Array:
        return np.array([drive.ratio for drive in self.drives.values()], float)

    def _across_gear(self, name: str, angle: ArrayLike | None, torque: ArrayLike | None, gear: Array) -> Array:
        if angle is not None and torque is None:
            return door.checked_array(name, "angle", angle, gear.size) * gear
        if torque is not None and angle is None:
            return door.checked_array(name, "torque", torque, gear.size) / gear
        raise InputError(f"{name}: give one of angle= and torque=, got {'neither' if angle is None else 'both'}")

    def __repr__(self) -> str:
        elastic = sum(drive.is_elastic for drive in self.drives.values())
        return f"<Robot {self.name!r}: {len(self.mechanism.bodies)} bodies, {self.nv} speeds, {elastic} elastic drives>"
