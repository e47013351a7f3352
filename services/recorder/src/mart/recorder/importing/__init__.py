"""Make episodes of the files of other projects, one module a format."""
