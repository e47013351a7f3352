"""Turn frames of phones and browsers into commands for one arm."""
