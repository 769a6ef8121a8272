"""Array types for signatures."""

from typing import Any

import numpy as np
import numpy.typing as npt
from scipy.sparse import csr_matrix

Floats = npt.NDArray[np.float64]
"""An array of numbers."""
Ints = npt.NDArray[np.int64]
"""An array of whole numbers, such as those of elements."""
Bools = npt.NDArray[np.bool_]
"""An array of yes and no."""
Geometries = npt.NDArray[np.object_]  # shapely
Sparse = csr_matrix[Any]
