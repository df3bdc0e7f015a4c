"""The arrays that functions take and give, unless they say otherwise."""

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

ComplexArray = NDArray[np.complex128]
