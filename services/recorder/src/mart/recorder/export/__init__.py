"""Episodes in the files of other projects, one module a format."""
