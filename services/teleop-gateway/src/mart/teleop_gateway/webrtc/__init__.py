"""Connect browsers, phones and viewers to one seat."""
