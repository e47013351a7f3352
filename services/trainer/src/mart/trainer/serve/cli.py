"""The commands that seat policies. Heavy modules are imported inside them: `mart --help` loads this file."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from mart.runtime.cli import json_option, print_result

if TYPE_CHECKING:
    from mart.trainer.serve.policy_seats import LoadPolicy


@click.command()
@click.option("--room", help="Only this room.  [default: every room]")
def policies(room: str | None) -> None:
    """Drive every seat that was given to a promoted policy, each from what its arm's operator sees."""
    from mart.trainer.serve.service import serve_policies
    from mart.trainer.serve.settings import PoliciesSettings

    def loader() -> LoadPolicy:
        from mart.trainer.models.policies.load import load_policy

        return load_policy

    given: dict[str, Any] = {"room": room} if room else {}
    serve_policies(PoliciesSettings(**given), loader)


@click.command()
@click.option(
    "--checkpoint", required=True, type=click.Path(path_type=Path), help="Folder of the checkpoint."
)
@click.option("--room", default="room-1", show_default=True, help="Id of the room.")
@click.option(
    "--arm", "arms", multiple=True, help="Arm to drive; may be repeated.  [default: all of the policy's]"
)
@click.option("--name", default="", help="What others see.  [default: the folder's name]")
@json_option
def operate(*, checkpoint: Path, room: str, arms: tuple[str, ...], name: str, as_json: bool) -> None:
    """Take seats for a policy and drive them until Ctrl-C, beside people who may take over and hand back."""
    from mart.trainer.models.policies.find import load_any_policy
    from mart.trainer.serve.service import operate as drive
    from mart.trainer.serve.settings import OperateSettings

    def seated(called: str, taken: tuple[str, ...]) -> None:
        text = f"{called} drives {', '.join(taken)} in {room}. Ctrl-C leaves."
        print_result({"room": room, "name": called, "arms": list(taken)}, text, as_json)

    settings = OperateSettings(checkpoint=checkpoint, room=room, arms=arms, name=name)
    drive(settings, load_any_policy, seated)
