"""Episode files as tensors: read, selected, partitioned by arm, normalised, cut into windows."""
