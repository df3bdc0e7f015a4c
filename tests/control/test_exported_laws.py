"""Every law as C: it commands, to the last bit, what its compiled self does."""

from pathlib import Path

import numpy as np
import pytest
from law_library import LAWS, elbow, law

from c_builds import CFunction, assert_same_bits
from cutpoint.control import Guard
from cutpoint.export import export_controller
from cutpoint.simulation.control_kernel import law_kernel, law_memory
from cutpoint.simulation.loop.parameters import law_parameters

PERIOD = 1e-3


@pytest.mark.parametrize("name", [*LAWS, "guard"])
def test_an_exported_law_has_the_bits_of_its_compiled_self(name: str, tmp_path: Path) -> None:
    """Sample after sample, each side with its own memory; states from nothing to far too much, and no numbers."""
    made = Guard(elbow(), law("adaptive VDC, natural"), torque_limit=5.0) if name == "guard" else law(name)
    export_controller(elbow(), made, tmp_path, control_period=PERIOD, name="step")
    kernel, rng = law_kernel(elbow(), made), np.random.default_rng(11)
    function, parameters = (
        CFunction(tmp_path, "step", kernel.graph, flags=("-O1",)),
        law_parameters(made, PERIOD),
    )
    for scales in ([0.0, 0.0, 1e-9, *[0.1] * 40, 3.0], [1.0, 1e3, 1e9, 1e200], [np.inf], [np.nan]):
        memory = own = law_memory(made)
        for k, scale in enumerate(scales):
            given = (*(rng.normal(size=(9, 2)) * scale), PERIOD * k)
            *command, own = function(*given, own, parameters) if own.size else (*function(*given, parameters), own)
            *expected, memory = kernel(*given, memory, parameters)
            for ours, theirs in zip([*command, own], [*expected, memory], strict=True):
                assert_same_bits(ours, theirs)
