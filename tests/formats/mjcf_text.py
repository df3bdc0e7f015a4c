"""MJCF documents for tests, one for each thing that MuJoCo does its own way."""

ARM = """<mujoco model="arm">
  <compiler autolimits="true"/>
  <option gravity="0.3 -0.2 -9.7"/>
  <default>
    <joint damping="0.4" frictionloss="0.2"/>
    <default class="geared"><joint armature="0.7"/></default>
  </default>
  <worldbody>
    <geom type="plane" size="1 1 1"/>
    <body name="base" pos="0.1 0.2 0.3" euler="10 20 30">
      <inertial pos="0 0 0" mass="4" diaginertia="1 1 1"/>
      <body name="upper" pos="0 0.1 0.4" quat="0.9 0.1 -0.3 0.2">
        <joint name="shoulder" class="geared" axis="1 2 3" ref="35" range="-100 120" actuatorfrcrange="-30 20"/>
        <inertial pos="0.1 0 0.2" mass="2" fullinertia="0.2 0.3 0.25 0.02 -0.03 0.01"/>
        <body name="lower" pos="0.3 0 0.1" axisangle="1 1 0 40">
          <joint name="elbow" axis="0 1 0" pos="0.05 -0.1 0.2" ref="-20"/>
          <inertial pos="0 0.1 0.1" quat="0.5 0.5 0.1 0.2" mass="1" diaginertia="0.02 0.03 0.04"/>
          <body name="carriage" pos="0 0 0.3" xyaxes="1 0.2 0 0 1 0.1">
            <joint name="lift" type="slide" class="geared" axis="0 1 1" ref="0.2" pos="0.3 0.2 0.1" range="-0.1 0.5"/>
            <geom type="capsule" size="0.05 0.2" density="800"/>
            <body name="hand" pos="0.1 0 0"><geom type="box" size="0.1 0.05 0.02" mass="0.3"/></body>
          </body>
        </body>
      </body>
    </body>
  </worldbody>
</mujoco>"""
"""References, offset joints, every way to write an orientation, armature by class, inertias stated and found."""

TAKEN = """<mujoco>
  <worldbody>
    <body name="body_2">
      <joint name="joint_2" axis="0 1 0"/><joint name="joint_2_" axis="1 0 0"/><joint/>
      <geom size=".1" mass="1" pos=".2 0 0"/>
      <body pos="1 0 0">
        <joint axis="0 1 0" pos="0.1 0 0"/><geom size=".1" mass="1" pos=".2 0 0"/>
        <body name="body_2_after_joint_2" pos="1 0 0"><joint name="body_2__fixed" axis="0 1 0"/><geom size=".1"/></body>
      </body>
    </body>
  </worldbody>
</mujoco>"""
"""Names of its own that are those of things without a name."""

BALLS = """<mujoco>
  <compiler angle="radian"/>
  <worldbody>
    <body name="pendulum" pos="0 0 1" quat="0.8 0.2 0.5 -0.3">
      <joint name="socket" type="ball" pos="0.1 0.05 -0.2"/>
      <geom type="ellipsoid" size="0.1 0.2 0.3" pos="0.1 0.1 0"/>
      <body name="tip" pos="0 0.1 0.5" quat="0.7 -0.1 0.3 0.5">
        <joint name="ankle" type="ball"/>
        <geom type="cylinder" size="0.1 0.2" euler="0.3 0.2 0.1" pos="0 0.1 0"/>
      </body>
    </body>
  </worldbody>
</mujoco>"""

FREE = """<mujoco>
  <worldbody>
    <frame pos="0.5 0 0" euler="20 0 0">
      <body name="satellite" pos="1 2 3" euler="0 0 30">
        <freejoint/>
        <geom type="box" size="0.3 0.2 0.1" pos="0.05 0.02 0.01"/>
        <body name="panel" pos=".3 0 0"><joint axis="1 0 1" armature="0.1"/><geom type="box" size=".5 .1 .01"/></body>
      </body>
    </frame>
    <body name="stone"><freejoint align="true"/><geom size="0.1" pos="0.3 0 0"/><geom size="0.05"/></body>
    <body name="pole"><joint name="pole_swing"/><geom type="capsule" size="0.05 0.4" pos="0.3 0 0"/></body>
  </worldbody>
</mujoco>"""

SEVERAL = """<mujoco>
  <worldbody>
    <body name="cart" pos="0 0 0.2" euler="5 -10 15">
      <joint name="x" type="slide" axis="1 0 0" armature="0.3"/>
      <joint name="y" type="slide" axis="0.1 1 0" ref="0.1"/>
      <joint name="yaw" axis="0 0 1" pos="0.2 0.1 0" ref="15"/>
      <geom type="box" size="0.3 0.2 0.1" pos="0 0.05 0.02"/>
      <body name="head" pos="0 0 0.3" quat="0.9 0.3 0.1 0.2">
        <joint name="pan" axis="0 0 1" pos="0.01 0.02 0.03"/>
        <joint name="tilt" axis="0.2 1 0" pos="-0.03 0.01 0.05" armature="0.02"/>
        <joint name="roll" axis="1 0 0.3"/>
        <geom type="cylinder" size="0.1 0.05" pos="0.1 0 0.1"/>
        <body name="eye" pos="0.1 0.05 0.1">
          <joint name="pop" type="slide" axis="1 0 0"/>
          <joint name="look" type="ball" pos="0.02 0.01 0"/>
          <geom size="0.03" pos="0.01 0 0"/>
        </body>
      </body>
      <body name="wheel" pos=".2 .2 -.1"><joint name="spin" axis="0 1 0"/><geom type="cylinder" size="0.1 0.02"/></body>
    </body>
  </worldbody>
</mujoco>"""
"""Several joints in one body, each about its own point, in the order in which MuJoCo applies them."""


def one_body(inside: str, sections: str = "", attributes: str = "") -> str:
    """A body `arm` with a hinge `elbow`; what is inside stands on line 3."""
    inertial = '<inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>'
    body = f'<body name="arm" {attributes}><joint name="elbow"/>{inertial}\n{inside}</body>'
    return f"<mujoco>{sections}\n<worldbody>{body}</worldbody></mujoco>"
