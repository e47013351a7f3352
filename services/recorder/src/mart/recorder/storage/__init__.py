"""Episodes and exports to and from any store that fsspec knows."""
