"""Make episode files of what crashes have left."""
