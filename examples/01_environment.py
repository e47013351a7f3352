"""Step a task in this process, with Gymnasium's interface and with PettingZoo's. No service needs to run.

$ .venv/bin/python examples/01_environment.py
"""

from __future__ import annotations

from contextlib import closing

from mart.envs import make_env, make_parallel_env

TASK = "two_arm_multi_cube_lifting"


def one_agent_for_all_arms() -> None:
    with closing(make_env(TASK)) as env:
        env.action_space.seed(0)
        observation, info = env.reset(seed=7)
        for name, value in observation.items():
            print(f"{name}: {value.shape}")
        print(f"actions: {env.action_space.shape}")
        for _ in range(20):
            observation, _reward, terminated, truncated, info = env.step(env.action_space.sample())
            if terminated or truncated:
                observation, info = env.reset()
        print(f"subtasks: {info['subtasks']}")


def one_agent_for_each_arm() -> None:
    with closing(make_parallel_env(TASK, render_mode="rgb_array", viewpoint="arm0")) as env:
        observations, _infos = env.reset(seed=7)
        for arm in env.agents:
            print(f"{arm} sees {', '.join(observations[arm])}")
            env.action_space(arm).seed(0)
        for _ in range(20):
            actions = {arm: env.action_space(arm).sample() for arm in env.agents}
            observations, _rewards, _terminations, _truncations, _infos = env.step(actions)
            if not env.agents:
                observations, _infos = env.reset()
        picture = env.render()
        assert picture is not None
        print(f"picture: {picture.shape}, {picture.dtype}")


if __name__ == "__main__":
    one_agent_for_all_arms()
    one_agent_for_each_arm()
