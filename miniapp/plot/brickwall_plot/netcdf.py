"""netCDF files, opened for reading; truncated ones are refused.

The netCDF library reads the missing end of a truncated classic file as zeros without an error, so the
header is compared with the size of the file, as in io/exodus/classic_netcdf.cpp.
"""
import struct
from pathlib import Path

import netCDF4

from .errors import PlotError

TYPE_BYTES = (0, 1, 1, 2, 4, 4, 8, 1, 2, 4, 8, 8)  # of the types 1 to 11 of the classic formats


def open_netcdf(path):
    """The netCDF4.Dataset of a file. Raises PlotError if it is missing, no netCDF file or truncated."""
    path = Path(path)
    try:
        with open(path, "rb") as raw:
            needed, found = classic_bytes(raw), path.stat().st_size
        if found < needed:
            raise PlotError(f"{path}: the file is truncated: it has {found} bytes, its header requires {needed}")
        file = netCDF4.Dataset(path)
    except (EOFError, IndexError):
        raise PlotError(f"{path}: the file is truncated: it ends within its header") from None
    except OSError as error:
        raise PlotError(f"{path}: {error.strerror or error}") from None
    except (UnicodeDecodeError, RuntimeError) as error:
        raise PlotError(f"{path}: the header is damaged: {error}") from None
    file.set_auto_mask(False)
    return file


def classic_bytes(raw):
    """The bytes that the header of a classic file requires, from an open binary file; 0 for any other
    format. Raises EOFError or IndexError if the header ends early."""

    def number(size):
        data = raw.read(size)
        if len(data) < size:
            raise EOFError
        return struct.unpack({4: ">I", 8: ">Q"}[size], data)[0]

    magic = raw.read(4)
    if magic[:3] != b"CDF" or magic[3:] not in (b"\1", b"\2", b"\5"):
        return 0
    count_bytes, offset_bytes = 8 if magic[3] == 5 else 4, 4 if magic[3] == 1 else 8

    def count():
        return number(count_bytes)

    def skip(size):
        raw.seek(size + -size % 4, 1)

    def items():
        number(4)  # tag
        return range(count())

    def skip_attributes():
        for _ in items():
            skip(count())
            skip(TYPE_BYTES[number(4)] * count())

    records = count()
    if records == 256**count_bytes - 1:  # not known while a file is streamed
        records = 0
    lengths = []
    for _ in items():
        skip(count())
        lengths.append(count())  # 0: the record dimension
    skip_attributes()
    fixed_end, record_variables = 0, []
    for _ in items():
        skip(count())
        shape = [lengths[count()] for _ in range(count())]
        skip_attributes()
        size = TYPE_BYTES[number(4)]
        count()  # the padded size, too small a field for large variables
        begin = number(offset_bytes)
        for length in shape[1:] if shape and shape[0] == 0 else shape:
            size *= length
        if shape and shape[0] == 0:
            record_variables.append((begin, size))
        elif size:
            fixed_end = max(fixed_end, begin + size)
    if not record_variables or not records:
        return fixed_end
    stride = sum(size + -size % 4 for _, size in record_variables) if len(record_variables) > 1 else record_variables[0][1]
    return max(fixed_end, *(begin + (records - 1) * stride + size for begin, size in record_variables))
