"""Turn states of a room into encoded pictures of one seat."""
