"""What MART's services agree on: messages, keys, tasks, poses, clocks and the episode-file contract."""
