"""Make many episodes of few: cut what was recorded, carry it to other worlds, keep what succeeds."""
