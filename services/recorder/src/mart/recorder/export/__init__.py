"""Write episodes as the files of other projects, one module a format."""
