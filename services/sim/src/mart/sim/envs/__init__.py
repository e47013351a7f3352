"""Make environments of tasks, for `mart.envs`, which is the door to them."""
