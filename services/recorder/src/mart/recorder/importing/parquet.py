"""Read Parquet tables that anybody may have written, in pieces, within stated sizes."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
from numpy.typing import NDArray

from mart.protocol.errors import Corrupt
from mart.recorder.importing.foreign_episode import MAX_EPISODE_BYTES

_ROWS_AT_ONCE = 2048
_MAX_GROUP_BYTES = 2 * 1024 * 1024 * 1024  # unpacked, of one group of rows
_MAX_TABLE_ROWS = 50_000_000
_MAX_SCHEMA_BYTES = 16 * 1024 * 1024
_SYMPTOMS = (pa.ArrowException, OSError, ValueError, KeyError, TypeError, OverflowError, MemoryError)

Columns = dict[str, NDArray[Any]]


def groups(path: Path, widths: Mapping[str, int], by: str, most_rows: int) -> Iterator[tuple[int, Columns]]:
    """Iterate over runs of rows with one value in the column `by`: that value, and each column, shape (rows, width).

    widths: of the columns that are wanted. Raises Corrupt where one is missing or is not of numbers, or where a run is
    longer than `most_rows`.
    """
    most = min(most_rows, MAX_EPISODE_BYTES // (8 * max(sum(widths.values()), 1)))
    run: list[Columns] = []
    value, count = None, 0
    for columns in _pieces(path, widths):
        indices = columns[by].ravel().astype(np.int64)
        for part in np.split(np.arange(len(indices)), np.flatnonzero(np.diff(indices)) + 1):
            if not len(part):
                continue
            if run and indices[part[0]] != value:
                yield int(value or 0), _joined(run)
                run, count = [], 0
            value, count = indices[part[0]], count + len(part)
            if count > most:
                raise Corrupt(f"episode {value} has more than {most} frames; no more are taken.")
            run.append({name: values[part] for name, values in columns.items()})
    if run:
        yield int(value or 0), _joined(run)


def records(path: Path, columns: Sequence[str], most_rows: int) -> Iterator[dict[str, Any]]:
    """Iterate over the rows of a small table, as far as it has these columns. Raises Corrupt."""
    with _opened(path) as table:
        there = [name for name in columns if name in table.schema_arrow.names]
        if table.metadata.num_rows > most_rows:
            raise Corrupt(f"{path} has {table.metadata.num_rows} rows; at most {most_rows} are taken.")
        for batch in table.iter_batches(batch_size=_ROWS_AT_ONCE, columns=there):
            yield from batch.to_pylist()


@contextlib.contextmanager
def _opened(path: Path) -> Iterator[pq.ParquetFile]:
    try:
        with pq.ParquetFile(
            path, thrift_container_size_limit=1_000_000, thrift_string_size_limit=_MAX_SCHEMA_BYTES
        ) as table:
            _require_bounded(path, table.metadata)
            yield table
    except _SYMPTOMS as error:
        raise Corrupt(f"{path} is no Parquet file, or it is damaged: {str(error)[:200]}.") from error


def _require_bounded(path: Path, metadata: pq.FileMetaData) -> None:
    if metadata.num_rows > _MAX_TABLE_ROWS:
        raise Corrupt(f"{path} has {metadata.num_rows} rows; at most {_MAX_TABLE_ROWS} are taken.")
    for group in range(metadata.num_row_groups):
        if metadata.row_group(group).total_byte_size > _MAX_GROUP_BYTES:
            raise Corrupt(
                f"{path} unpacks to more than {_MAX_GROUP_BYTES >> 20} MiB at once; write it in smaller groups."
            )


def _pieces(path: Path, widths: Mapping[str, int]) -> Iterator[Columns]:
    with _opened(path) as table:
        missing = sorted(widths.keys() - set(table.schema_arrow.names))
        if missing:
            raise Corrupt(f"{path} lacks the columns {', '.join(missing[:8])}.")
        for batch in table.iter_batches(batch_size=_ROWS_AT_ONCE, columns=list(widths), use_threads=False):
            yield {name: _numbers(path, name, batch[name], width) for name, width in widths.items()}


def _numbers(path: Path, name: str, column: pa.Array, width: int) -> NDArray[Any]:
    """Return a column as numbers, shape (rows, width)."""
    lists = pa.types.is_fixed_size_list(column.type) or pa.types.is_list(column.type)
    inner = column.type.value_type if lists else column.type
    if not (pa.types.is_floating(inner) or pa.types.is_integer(inner) or pa.types.is_boolean(inner)):
        raise Corrupt(f"{path}: {name!r} is of type {column.type}; numbers are wanted there.")
    flat = column.flatten() if lists else column
    if column.null_count or flat.null_count or len(flat) != len(column) * width:
        raise Corrupt(f"{path}: {name!r} has not {width} numbers in every row.")
    return flat.to_numpy(zero_copy_only=False).reshape(len(column), width)


def _joined(run: Sequence[Columns]) -> Columns:
    return {name: np.concatenate([part[name] for part in run]) for name in run[0]}
