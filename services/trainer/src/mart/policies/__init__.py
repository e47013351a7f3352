"""Train policies, load them, let them act, and see how often they succeed: the trainer for other people's code.

    from pathlib import Path
    from mart.policies import TrainingSpec, evaluate_policy, load_policy, train_policy

    spec = TrainingSpec(model="r-HBC", data=(Path("data/episodes"),), preset="fast")
    (checkpoint,) = train_policy(spec, Path("runs/mine"))

    policy = load_policy(checkpoint)
    policy.begin(worlds=1, seed=0)  # before the first tick of an episode
    actions = policy.act(observations)  # name → float64[1, *shape]; returns float64[1, arms, 7]

    results = evaluate_policy(policy, seeds=range(20))
    print(sum(result.succeeded for result in results), "of 20 episodes succeeded")

`evaluate_policy` takes any object that is a `Policy`, so a policy that was trained elsewhere is evaluated in the same
way. This module imports without PyTorch; loading and training raise Unavailable where it is not installed.
"""

from __future__ import annotations

import contextlib
import threading
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

from mart.protocol.batch_state import ACTION_SIZE
from mart.protocol.errors import Unavailable
from mart.trainer.data.data_spec import Selection
from mart.trainer.evaluate.evaluation import EpisodeResult, RolloutOutcome
from mart.trainer.models.policies.policy import Policy, SeeingPolicy
from mart.trainer.train.progress import TrainingProgress
from mart.trainer.train.run_directory import RunDirectory
from mart.trainer.train.spec import TrainingSpec

__all__ = [
    "ACTION_SIZE",
    "EpisodeResult",
    "Policy",
    "RolloutOutcome",
    "SeeingPolicy",
    "Selection",
    "TrainingProgress",
    "TrainingSpec",
    "evaluate_policy",
    "load_policy",
    "train_policy",
]


def load_policy(checkpoint: Path, device: str = "cpu") -> Policy:
    """Load the policy of one checkpoint folder; it computes on `device`: cpu, cuda, cuda:N or auto.

    A folder of another project is loaded by the installed part that knows it (entry points `mart.policy_loaders`).
    Raises NotFound where there is no checkpoint; Corrupt where it is damaged, of another format, or of a task that this
    version knows otherwise; Unavailable where the device, or PyTorch, is not there.
    """
    with _torch_needed():
        from mart.trainer.models.policies.find import load_any_policy

        return load_any_policy(checkpoint, device)


def train_policy(
    spec: TrainingSpec,
    folder: Path,
    on_progress: Callable[[TrainingProgress], object] | None = None,
    stop: threading.Event | None = None,
) -> tuple[Path, ...]:
    """Train what `spec` asks into the folder of a run, and return the newest checkpoint of each seed.

    A run that was begun there goes on where it was. on_progress: called some hundred times in all, in this thread.
    stop: ends the training soon when it is set; a later call goes on.
    Raises InvalidInput, NotFound or Corrupt for what cannot be learned from; Conflict where the folder holds a run of
    another spec or other data, or is being trained by another process; Unavailable without the device, or PyTorch.
    """
    with _torch_needed():
        from mart.trainer.train.training import train
    train(spec, folder, stop or threading.Event(), on_progress or _ignore)
    run = RunDirectory(folder)
    newest = run.checkpointed()[-1:]
    return tuple(run.checkpoint(updates, seed) for updates in newest for seed in run.seeds(updates))


def evaluate_policy(
    policy: Policy,
    seeds: Sequence[int],
    *,
    replicas: Sequence[str] = (),
    policy_seed: int = 0,
    time_limit_s: float | None = None,
) -> list[EpisodeResult]:
    """Let a policy act for one episode in the world of each seed, and return how each went, in their order.

    replicas: names of running replicas; with none named, one is started for it and ends with it. policy_seed: decides
    what the policy draws. time_limit_s: of an episode, simulated; the length of the task's trials unless told.
    Raises InvalidInput without seeds, or where the policy does not drive all arms of its task; NotFound for an unknown
    task; Unavailable where no replica answers or the sim is not installed.
    """
    from mart.rollouts.replicas import worlds
    from mart.trainer.evaluate.rollouts import common_task, roll_out

    common_task([policy])  # before worlds are started for nothing
    with worlds(replicas) as client:
        (results,) = roll_out([policy], client, seeds, policy_seed, time_limit_s)
    return [rollout.result for rollout in results]


def _ignore(_: TrainingProgress) -> None:
    """Nobody wants to know."""


@contextlib.contextmanager
def _torch_needed() -> Iterator[None]:
    """Raise Unavailable where what is imported inside needs PyTorch and it is not installed."""
    try:
        yield
    except ModuleNotFoundError as error:
        if error.name != "torch":
            raise
        raise Unavailable(
            "PyTorch is not installed here, and policies compute with it; install it: `pip install torch`."
        ) from error
