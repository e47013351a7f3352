"""robomimic's BC-RNN or HBC, trained on the successful episodes of an HDF5 file, and then asked what to do.

    play.py FILE bc|hbc SEED UPDATES SIZES

SIZES is JSON, as `model.Sizes`. Prints one line of JSON when it has learned. From then on it reads lines of JSON: null
begins new episodes; observations by key, each a list with a row a world, are answered with a row of actions a world.
"""

from __future__ import annotations

import json
import sys

import model  # first: it stands in for what robomimic wants for pictures
import robomimic
import robomimic.utils.train_utils as training
import torch


def main(path: str, algorithm: str, seed: str, updates: str, sizes: str) -> None:
    torch.manual_seed(int(seed))
    learning = model.learner(path, algorithm, model.Sizes(**json.loads(sizes)), filter_key="success")
    training.run_epoch(learning.model, learning.loader, epoch=1, num_steps=int(updates))
    policy = learning.model
    policy.set_eval()
    print(json.dumps({"version": robomimic.__version__}), flush=True)
    for line in sys.stdin:
        seen = json.loads(line)
        if seen is None:
            policy.reset()
            continue
        with torch.no_grad():
            actions = policy.get_action({key: torch.tensor(rows) for key, rows in seen.items()})
        print(json.dumps({"actions": actions.clamp(-1, 1).tolist()}), flush=True)


if __name__ == "__main__":
    main(*sys.argv[1:])
