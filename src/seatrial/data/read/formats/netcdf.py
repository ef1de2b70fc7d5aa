"""NetCDF files, by xarray from the extra `formats`."""

from pathlib import Path

import numpy as np

from seatrial.core.values import InputError
from seatrial.data.read.layout import Layout
from seatrial.data.read.log import Log, RawTable, require_library


def read_netcdf(path: Path, layout: Layout) -> Log:
    """The one-dimensional variables that share the time variable's dimension.

    Raises:
        InputError: xarray is not installed, or not a NetCDF file.
    """
    xr = require_library("xarray", path.name, "a NetCDF file", "formats")
    try:
        dataset = xr.load_dataset(path, decode_times=False)
    except Exception as error:  # xarray and its engines raise a dozen unrelated types on damaged files
        raise InputError(f"{path.name} is not a readable NetCDF file ({str(error).splitlines()[0]})") from None
    vectors = {str(name): array for name, array in dataset.variables.items() if array.ndim == 1}
    wanted = vectors[layout.time.source].dims if layout.time.source in vectors else None
    same = {name: np.asarray(array) for name, array in vectors.items() if wanted is None or array.dims == wanted}
    return Log.of_table(RawTable(path.name, tuple(same), tuple(same.values())))
