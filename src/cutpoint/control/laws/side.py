"""Laws that use one side's encoders: the motors' or the links'."""

from typing import Any, Literal, get_args

from cutpoint.control.interface import Measurement, Reference
from cutpoint.control.law import Law
from cutpoint.door import check_choice

Side = Literal["motor", "link"]


class SidedLaw(Law):
    """A law whose `side` says which encoders it uses."""

    side: Side

    def check_side(self) -> None:
        """Raises InputError for a side that is neither."""
        check_choice(type(self).__name__, "side", self.side, get_args(Side))

    @property
    def needs(self) -> tuple[str, ...]:
        """Measurement fields that the law reads."""
        return ("theta", "theta_dot") if self.side == "motor" else ("q", "v")

    def seen(self, measurement: Measurement, reference: Reference) -> tuple[Any, Any, Any, Any]:
        """Measured and desired positions and speeds of its side; rad, rad/s, (n,) each."""
        m, r = measurement, reference
        if self.side == "motor":
            return m.theta, m.theta_dot, r.theta, r.theta_dot
        return m.q, m.v, r.q, r.v
