"""The contract between MART's parts: messages, keys, vocabulary, tasks, poses, clocks and the episode-file format."""
