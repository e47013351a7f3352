"""Evaluate a policy: load a checkpoint, let it act in worlds of a replica of its own, print how often it succeeds.

    python examples/05_evaluate_a_policy.py CHECKPOINT [--episodes 10]

A checkpoint is a folder such as `checkpoints/2000/seed-0` in a run; example 04 prints one. Any object that is a
`mart.policies.Policy` is evaluated in the same way.
"""

from __future__ import annotations

import argparse
from pathlib import Path

from mart.policies import evaluate_policy, load_policy


def main() -> None:
    parser = argparse.ArgumentParser(description="Evaluate a policy.")
    parser.add_argument("checkpoint", type=Path, help="The folder of a checkpoint.")
    parser.add_argument("--episodes", type=int, default=10, help="How many, each in a world of its own.")
    parser.add_argument("--time-limit", type=float, help="Simulated seconds; default: the task's.")
    given = parser.parse_args()
    policy = load_policy(given.checkpoint)
    print(f"A policy for {policy.task} that drives {', '.join(policy.arms)} at {policy.control_hz:g} Hz")
    results = evaluate_policy(policy, range(given.episodes), time_limit_s=given.time_limit)
    for result in results:
        reached = ", ".join(result.done) or "nothing"
        print(f"world {result.seed}: {result.outcome} after {result.time_s:.1f} s; done: {reached}")
    successes = sum(result.succeeded for result in results)
    print(f"Success rate: {successes} of {len(results)} ({100 * successes / len(results):.0f} %)")


if __name__ == "__main__":
    main()
